//! `aurt next`: the motion to record next, which decides what a diagnosis leaves open.

use std::path::PathBuf;

use aurt_diagnosis::drives::STRUCTURES;
use aurt_diagnosis::{DeviationGoal, effects};
use aurt_experiment::Experiment;
use aurt_experiment::workbench::described_model::{ChainEnds, GivenModel};
use aurt_experiment::workbench::diagnosing::DiagnosisOptions;
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::next::{KeepOut, NextOptions, plan_next};
use aurt_experiment::workbench::planned_output::PlannedOutput;
use clap::Args;
use serde_json::json;

use super::Session;
use super::planned_robot::read_limits;
use crate::rendering::terminal::Report;

/// Plan the motion to record next: the one that decides what a diagnosis leaves open.
///
/// Diagnoses the experiment, and composes a motion in which the explanations that do equally well predict different
/// torques. Printed before anything is recorded: which doubts it settles and with which probability, which no motion
/// settles, and how narrow intervals become. Without `--limits` the arm stays where the recordings show it, not faster
/// and with no larger torques. With `[drive]` the motion is one of commands, and no joint is farther from its command
/// than it was. Collisions are not checked: look at the motion in the robot's own simulator first.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt next experiment.toml --out motion.csv\n  \
    aurt next experiment.toml --until 'mass_kg < 0.02' --out motion.yaml\n\n\
    motion.csv has positions, velocities and accelerations; motion.yaml is a goal for\n\
    `ros2 action send_goal /…/follow_joint_trajectory control_msgs/action/FollowJointTrajectory \"$(cat motion.yaml)\"`;\n\
    motion.script is a URScript program; motion.mcap is a bag with the message trajectory_msgs/msg/JointTrajectory;\n\
    motion.lerobot is a folder, a LeRobot data set of one episode (format 3.0), its actions positions in rad")]
pub struct NextMotion {
    /// Experiment file
    #[arg(value_name = "EXPERIMENT.toml")]
    experiment: PathBuf,
    /// File for the motion: .csv, .yaml (a trajectory of ROS 2), .script (URScript), .mcap (ROS 2) or .lerobot (a folder)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Take a model as given instead of recalibrating the experiment's structure, as `aurt diagnose` does; not with `[drive]`
    #[arg(long, value_name = "RD_CALIBRATED.json|URDF|XML")]
    model: Option<PathBuf>,
    /// Exclude an effect, with `[drive]` a structure, from the diagnosis; may be given several times
    #[arg(long, value_name = "EFFECT")]
    without: Vec<String>,
    /// Standard deviation that a parameter, with `[drive]` a number, shall have at most; may be given several times
    #[arg(long, value_name = "PARAMETER < STD", value_parser = parse_wanted)]
    until: Vec<DeviationGoal>,
    /// Table of joint limits, a row each: lower_rad, upper_rad, velocity_rad_s, acceleration_rad_s2
    #[arg(long, value_name = "LIMITS.csv")]
    limits: Option<PathBuf>,
    /// Box that the arm stays out of: two opposite corners in m in the base frame, `x,y,z,x,y,z`; may be given several times.
    /// Lines between the origins of the links are kept out: add the arm's thickness, the distance of links from these lines, and
    /// what the last link carries. The way to the first pose is not planned
    #[arg(long, value_name = "CORNERS", value_parser = parse_box, allow_hyphen_values = true)]
    keep_out: Vec<KeepOut>,
    /// Longest duration in s
    #[arg(long, value_name = "S", default_value = "30")]
    duration_s: f64,
    /// Rows per second of the motion; by default those of the recordings, for .lerobot the nearest whole number
    #[arg(long, value_name = "HZ")]
    rate_hz: Option<f64>,
    /// Number of motions that are tried as its pieces
    #[arg(long, value_name = "N", default_value = "48")]
    tries: usize,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value = "1")]
    seed: u64,
}

/// Longest motion, s, and most pieces that are tried.
const MOST: (f64, usize) = (600.0, 1000);
/// Shortest motion, s: that of a multi-sine.
const SHORTEST_S: f64 = 3.0;

/// `PARAMETER < STD`.
fn parse_wanted(text: &str) -> Result<DeviationGoal, String> {
    let (parameter, std) =
        text.split_once('<').ok_or("write a parameter and its deviation, such as `mass_kg < 0.02`")?;
    let parameter = parameter.trim().to_owned();
    let std: f64 = std.trim().parse().map_err(|_| format!("`{}` cannot be read as a number", std.trim()))?;
    if !(std.is_finite() && std > 0.0) {
        return Err(format!("a standard deviation of {std} cannot be; give a positive number"));
    }
    Ok(DeviationGoal { parameter, std })
}

/// `x,y,z,x,y,z`.
fn parse_box(text: &str) -> Result<KeepOut, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|number| number.trim().parse::<f64>()).collect();
    let numbers = numbers.map_err(|_| format!("`{text}` has a part that is no number"))?;
    let [x, y, z, u, v, w] = numbers[..] else {
        return Err(format!("{} numbers; give two corners, x,y,z,x,y,z", numbers.len()));
    };
    if !numbers.iter().all(|number| number.is_finite()) {
        return Err("a corner needs finite coordinates; write a large number where the box has no end".into());
    }
    let sides = [[x, u], [y, v], [z, w]];
    Ok(KeepOut { low_m: sides.map(|[a, b]| a.min(b)), high_m: sides.map(|[a, b]| a.max(b)) })
}

impl NextMotion {
    pub fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        let Session { terminal, registry, .. } = session;
        let inputs = [Some(&self.experiment), self.limits.as_ref(), self.model.as_ref()];
        let inputs: Vec<_> = inputs.into_iter().flatten().map(PathBuf::as_path).collect();
        let out = PlannedOutput::new("--out", &self.out, &inputs)?;
        self.check()?;
        self.rate_hz.map_or(Ok(()), |rate_hz| out.check_rate_hz(rate_hz))?;
        let experiment = Experiment::read_with_drives(&self.experiment, registry)?;
        self.check_names(experiment.drive.is_some())?;
        let read = |model| GivenModel::read(model, ChainEnds::default(), None, &experiment, registry);
        let given = self.model.as_deref().map(read);
        let joints = experiment.robot.robot_joints().count;
        let options = NextOptions {
            diagnosis: DiagnosisOptions {
                frozen: given.transpose()?.map(|given| given.calibrated),
                without: self.without.clone(),
                ..DiagnosisOptions::default()
            },
            limits: self.limits.as_deref().map(|file| read_limits(file, joints)).transpose()?,
            keep_out: self.keep_out.clone(),
            wanted: self.until.clone(),
            duration_s: self.duration_s,
            draws: self.tries,
            seed: self.seed,
        };
        let progress = terminal.progress(24 + self.tries);
        let next = plan_next(&experiment, registry, &options, &progress)?;
        drop(progress);
        // Only reading the experiment tells which recordings are inputs; without a motion, nothing would check them.
        let out = PlannedOutput::new("--out", out.path(), &inputs)?;
        let mut text = next.to_text();
        let mut outputs = Vec::new();
        if let Some(plan) = &next.motion {
            let rate_hz = self.rate_hz.unwrap_or_else(|| out.near_rate_hz(next.rate_hz));
            out.write(&plan.trajectory, rate_hz, &next.joint_names)?;
            text.push_str(&format!("written: {}\n", out.path().display()));
            outputs.push(out.path());
        }
        let mut json = next.to_json();
        json["command"] = json!("next");
        json["outputs"] = json!(outputs);
        Ok(Report { text, json, findings: false })
    }

    /// Refuses numbers that no plan has, before anything is read.
    fn check(&self) -> Result<(), Failure> {
        let refuse = |option, reason: String, remedy: &str| Err(Failure::argument(option, reason, remedy));
        if !(SHORTEST_S..=MOST.0).contains(&self.duration_s) {
            let reason = format!("a plan cannot take {} s", self.duration_s);
            return refuse("--duration-s", reason, "give 3 to 600 s");
        }
        if !(1..=MOST.1).contains(&self.tries) {
            return refuse("--tries", format!("{} motions cannot be tried", self.tries), "give 1 to 1000");
        }
        Ok(())
    }

    /// Refuses effects and parameters that nothing has; the numbers of drives are those of the experiment.
    fn check_names(&self, has_drive: bool) -> Result<(), Failure> {
        let refuse = |option, reason, remedy: &str| Err(Failure::argument(option, reason, remedy));
        let effects = effects::ALL.into_iter().map(|effect| effect.id);
        let structures = STRUCTURES.iter().map(|structure| structure.id);
        let known: Vec<&str> = if has_drive { structures.collect() } else { effects.collect() };
        if let Some(name) = self.without.iter().find(|name| !known.contains(&name.as_str())) {
            let reason = format!("`{name}` is not one of the effects");
            return refuse("--without", reason, &format!("name one of {}", known.join(", ")));
        }
        if has_drive && self.model.is_some() {
            let reason = "is of recordings with torques, and this experiment has a [drive]".to_owned();
            return refuse("--model", reason, "leave it out");
        }
        let has = |parameter: &str| effects::ALL.into_iter().any(|e| e.parameter(parameter).is_some());
        if let Some(DeviationGoal { parameter, .. }) =
            self.until.iter().find(|u| !has_drive && !has(&u.parameter))
        {
            let reason = format!("none of the effects has a parameter `{parameter}`");
            return refuse("--until", reason, "`aurt explain EFFECT` lists them");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{KeepOut, parse_box};

    #[test]
    fn corners_of_a_box_come_in_any_order() {
        let table = KeepOut { low_m: [-1.0, -1.0, -0.5], high_m: [1.0, 1.0, 0.0] };
        assert_eq!(parse_box("1,-1, 0, -1,1,-0.5"), Ok(table));
        for (text, said) in
            [("1,2,3", "3 numbers"), ("a,0,0,1,1,1", "no number"), ("0,0,0,1,1,inf", "finite")]
        {
            assert!(parse_box(text).is_err_and(|e| e.contains(said)), "{text}");
        }
    }
}
