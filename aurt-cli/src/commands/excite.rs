//! `aurt excite`: motions that make a robot's parameters visible.

use std::path::PathBuf;

use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::planned_output::PlannedOutput;
use aurt_simulation::trajectory::{ExcitationOptions, MultiSineOptions, excite};
use aurt_simulation::{Motion, Robot, Trajectory};
use aurt_traits::RigidBodyRegressor;
use clap::{Args, ValueEnum};
use serde_json::json;

use super::Session;
use super::planned_robot::{PlannedRobot, PlannedRobotOptions};
use crate::rendering::terminal::Report;

/// Plan motions for a robot, within its limits.
///
/// Optimised excitation is a multi-sine that minimises the condition number of the base parameters'
/// regressor. The others are for friction: slow triangles have many reversals, sweeps constant velocities,
/// point-to-point motions are typical work.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt excite --robot ur10e --duration-s 20 --seed 1 --out motion.csv\n  \
    aurt excite --robot robot.urdf --seed 1 --out motion.csv\n  \
    aurt excite --mdh mdh.csv --gravity 0 0 -9.81 --limits limits.csv --seed 1 --out motion.csv")]
pub struct Excite {
    #[command(flatten)]
    which: PlannedRobotOptions,
    /// Kind of motion
    #[arg(long, value_enum, default_value_t)]
    kind: Kind,
    /// Duration in s
    #[arg(long, value_name = "S", default_value = "20")]
    duration_s: f64,
    /// Rows per second
    #[arg(long, value_name = "HZ", default_value = "100")]
    rate_hz: f64,
    /// Share of the limits that may be used
    #[arg(long, value_name = "SHARE", default_value = "0.8")]
    share: f64,
    /// Number of harmonics of a multi-sine
    #[arg(long, value_name = "N", default_value = "6")]
    harmonics: usize,
    /// Frequency of the highest harmonic
    #[arg(long, value_name = "HZ", default_value = "0.6")]
    top_hz: f64,
    /// Speed of triangles
    #[arg(long, value_name = "RAD/S", default_value = "0.1")]
    speed_rad_s: f64,
    /// Amplitude of triangles
    #[arg(long, value_name = "RAD", default_value = "0.4")]
    amplitude_rad: f64,
    /// Rest at each pose of point-to-point motions
    #[arg(long, value_name = "S", default_value = "0.5")]
    rest_s: f64,
    /// Number of multi-sines that the optimisation tries
    #[arg(long, value_name = "N", default_value = "600")]
    tries: usize,
    /// Keep the torques of a simulated robot within its drives' limits too
    #[arg(long, conflicts_with = "mdh")]
    torque_limits: bool,
    /// Seed of all random numbers
    #[arg(long, value_name = "N")]
    seed: u64,
    /// File for the motion: .csv, .yaml (a trajectory of ROS 2), .script (URScript), .mcap (ROS 2) or .lerobot (a folder)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// A kind of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Kind {
    /// Multi-sine with the smallest condition number that was found
    #[default]
    Optimised,
    /// Multi-sine drawn at random
    MultiSine,
    /// Moves between random poses
    PointToPoint,
    /// Slow triangles of nested amplitudes
    Triangles,
    /// Strokes at constant velocities
    Sweeps,
}

impl Excite {
    pub fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        let out = PlannedOutput::new("--out", &self.out, &self.which.inputs())?;
        out.check_rate_hz(self.rate_hz)?;
        let PlannedRobot { robot, bodies, joint_names, notes, knows_torques } = self.which.planned()?;
        if self.torque_limits && !knows_torques {
            return Err(Failure::argument(
                "--torque-limits",
                "needs the masses of the links, and these are known of simulated robots alone",
                "leave it out; check the planned motion in the robot's own simulator",
            ));
        }
        let (trajectory, condition) = self.trajectory(&robot, bodies.as_deref(), session)?;
        if self.torque_limits {
            trajectory.check_torque(&robot)?;
        }
        out.write(&trajectory, self.rate_hz, &joint_names)?;
        let kind = self.kind.to_possible_value().map_or_else(String::new, |v| v.get_name().to_owned());
        let mut text =
            format!("{kind} motion of {} joints over {:.1} s\n", robot.joints(), trajectory.duration_s());
        if let Some([first, best]) = condition {
            text.push_str(&format!(
                "condition number of the base regressor: {best:.1}, {first:.1} of the first draw\n"
            ));
        }
        for note in &notes {
            text.push_str(note);
            text.push('\n');
        }
        text.push_str(&format!("written: {}\n", out.path().display()));
        let limits: Vec<_> = robot
            .drives
            .iter()
            .map(|drive| {
                json!({
                    "lower_rad": drive.position_limit_rad[0],
                    "upper_rad": drive.position_limit_rad[1],
                    "velocity_rad_s": drive.velocity_limit_rad_s,
                    "acceleration_rad_s2": drive.acceleration_limit_rad_s2,
                })
            })
            .collect();
        Ok(Report {
            text,
            json: json!({
                "command": "excite",
                "kind": kind,
                "joints": robot.joints(),
                "duration_s": trajectory.duration_s(),
                "condition_number": condition.map(|[_, best]| best),
                "first_condition_number": condition.map(|[first, _]| first),
                "seed": self.seed,
                "notes": notes,
                "limits": limits,
                "outputs": [out.path()],
            }),
            findings: false,
        })
    }

    /// The motion and, of optimised ones, the condition numbers of the first draw and of the result.
    fn trajectory(
        &self,
        robot: &Robot,
        bodies: Option<&dyn RigidBodyRegressor>,
        session: &Session<'_>,
    ) -> Result<(Trajectory, Option<[f64; 2]>), Failure> {
        let Self { duration_s, share, harmonics, top_hz, .. } = *self;
        let motion = match self.kind {
            Kind::Optimised => {
                let options = ExcitationOptions {
                    sines: MultiSineOptions { duration_s, harmonics, top_hz, share },
                    tries: self.tries,
                    torque_limits: self.torque_limits,
                };
                let progress = session.terminal.progress(self.tries);
                let heard = &mut |_, best: f64| progress.step(format!("condition number {best:.1}"));
                let found = excite(robot, bodies, &options, self.seed, heard)?;
                drop(progress);
                let condition = [found.first_condition_number, found.condition_number];
                return Ok((found.trajectory, Some(condition)));
            }
            Kind::MultiSine => Motion::MultiSine { duration_s, harmonics, top_hz, share },
            Kind::PointToPoint => Motion::PointToPoint { duration_s, share, rest_s: self.rest_s },
            Kind::Triangles => Motion::Triangles {
                duration_s,
                speed_rad_s: self.speed_rad_s,
                amplitude_rad: self.amplitude_rad,
            },
            Kind::Sweeps => Motion::Sweeps { duration_s, share },
        };
        Ok((motion.plan(robot, self.seed)?, None))
    }
}
