//! `aurt excite`: motions that make a robot's parameters visible.

use std::path::{Path, PathBuf};

use aurt::table_file::TableFile;
use aurt_rbd::{MdhRow, MdhRows, MdhTable};
use aurt_simulation::{
    Motion, MotionLimits, Robot, Trajectory,
    trajectory::{ExcitationOptions, MultiSineOptions, excite},
};
use clap::{Args, ValueEnum};
use serde_json::json;

use super::{Session, compile_rbd::Rows};
use crate::{
    arguments::{Gravity, parse_gravity},
    failure::Failure,
    output::OutputFile,
    rendering::terminal::Report,
};

/// Plan motions for a robot, within its limits.
///
/// Optimised excitation is a multi-sine that makes the base inertial parameters as well distinguishable as
/// possible (the condition number of their regressor). The others are for friction: slow triangles are rich in
/// reversals, sweeps have constant velocities, point-to-point motions are what robots mostly do.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt excite --robot ur10e --duration-s 20 --seed 1 --out motion.csv\n  \
    aurt excite --mdh mdh.csv --gravity 0 0 -9.81 --limits limits.csv --seed 1 --out motion.csv")]
#[command(group(clap::ArgGroup::new("which").required(true).args(["robot", "mdh"])))]
pub struct Excite {
    /// One of the included robots
    #[arg(long, value_name = "NAME")]
    robot: Option<String>,
    /// Table of modified Denavit–Hartenberg parameters of yours
    #[arg(long, value_name = "CSV", requires = "limits")]
    mdh: Option<PathBuf>,
    /// Gravitational acceleration in the base frame, m/s²
    #[arg(long, value_name = "X Y Z", value_parser = parse_gravity, allow_hyphen_values = true)]
    gravity: Option<Gravity>,
    /// Which joint a row's alpha and a lead to
    #[arg(long, value_enum, default_value_t)]
    mdh_rows: Rows,
    /// Limits of your joints, a row each: lower_rad, upper_rad, velocity_rad_s, acceleration_rad_s2
    #[arg(long, value_name = "CSV", conflicts_with = "robot")]
    limits: Option<PathBuf>,
    /// What kind of motion
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
    /// Keep the torques of the included robot within its drives' limits too
    #[arg(long, conflicts_with = "mdh")]
    torque_limits: bool,
    /// Seed of everything that is drawn
    #[arg(long, value_name = "N")]
    seed: u64,
    /// File for the motion
    #[arg(long, value_name = "CSV")]
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
    /// Plans.
    pub fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        let inputs: Vec<&Path> =
            [&self.mdh, &self.limits].into_iter().flatten().map(PathBuf::as_path).collect();
        let out = OutputFile::new("--out", &self.out, &inputs)?;
        let robot = self.the_robot()?;
        let (trajectory, condition) = self.trajectory(&robot, session)?;
        if self.torque_limits {
            trajectory.check_torque(&robot)?;
        }
        out.write(&trajectory.csv(self.rate_hz)?)?;
        let kind = self.kind.to_possible_value().map_or_else(String::new, |v| v.get_name().to_owned());
        let mut text =
            format!("{kind} motion of {} joints over {:.1} s\n", robot.joints(), trajectory.duration_s());
        if let Some([first, best]) = condition {
            text.push_str(&format!(
                "condition number of the base regressor: {best:.1}, {first:.1} of the first draw\n"
            ));
        }
        text.push_str(&format!("written: {}\n", out.path().display()));
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
                "outputs": [out.path()],
            }),
            findings: false,
        })
    }

    /// The motion and, of optimised ones, the condition numbers of the first draw and of the result.
    fn trajectory(
        &self,
        robot: &Robot,
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
                let found = excite(robot, &options, self.seed, &mut |_, best| {
                    progress.step(format!("condition number {best:.1}"));
                })?;
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

    fn the_robot(&self) -> Result<Robot, Failure> {
        let (Some(mdh), Some(limits)) = (&self.mdh, &self.limits) else {
            let mut robot = Robot::named(self.robot.as_deref().unwrap_or_default())?;
            if let Some(Gravity(gravity)) = self.gravity {
                robot.gravity_m_s2 = gravity;
            }
            return Ok(robot);
        };
        let table = MdhTable::from_path(mdh, self.mdh_rows.into())?;
        let mut gravity = self.gravity.map_or([0.0, 0.0, -9.81], |g| g.0);
        if let (MdhRows::Previous, Some(first)) = (table.reading, table.rows.first()) {
            // What leads to the first joint only turns gravity.
            let (sin, cos) = first.alpha_rad.sin_cos();
            gravity = [gravity[0], cos * gravity[1] + sin * gravity[2], cos * gravity[2] - sin * gravity[1]];
        }
        let rows = in_next_reading(table);
        let limits = read_limits(limits, rows.len())?;
        Ok(Robot::of_geometry("your robot", rows, gravity, &limits))
    }
}

/// The rows as simulations read them, with the alpha and a that lead on to the next joint.
fn in_next_reading(table: MdhTable) -> Vec<MdhRow> {
    let mut rows = table.rows;
    if table.reading == MdhRows::Previous {
        for j in 0..rows.len() {
            let (alpha_rad, a_m) = rows.get(j + 1).map_or((0.0, 0.0), |next| (next.alpha_rad, next.a_m));
            (rows[j].alpha_rad, rows[j].a_m) = (alpha_rad, a_m);
        }
    }
    rows
}

/// The columns of a table of limits.
const COLUMNS: [&str; 4] = ["lower_rad", "upper_rad", "velocity_rad_s", "acceleration_rad_s2"];

/// Largest angle of a joint's limits, rad: two turns. Half a turn in degrees is beyond it.
const LARGEST_ANGLE_RAD: f64 = aurt_rbd::LARGEST_ANGLE_RAD;
/// Highest velocity of a joint, rad/s.
const HIGHEST_VELOCITY_RAD_S: f64 = 100.0;
/// Highest acceleration of a joint, rad/s².
const HIGHEST_ACCELERATION_RAD_S2: f64 = 1e4;

/// Reads limits: a header with [`COLUMNS`] in any order, and a row for each joint.
fn read_limits(path: &Path, joints: usize) -> Result<Vec<MotionLimits>, Failure> {
    let table = TableFile::read(
        path,
        "write the columns lower_rad, upper_rad, velocity_rad_s, acceleration_rad_s2 and a row for each joint",
    )?;
    let mut places = [0; 4];
    for (place, column) in places.iter_mut().zip(COLUMNS) {
        *place = table
            .column(column)
            .ok_or_else(|| table.refuse(None, None, format!("has no column `{column}`")))?;
    }
    let mut limits = Vec::new();
    for row in table.rows() {
        let row = row?;
        let mut values = [0.0; 4];
        for (value, place) in values.iter_mut().zip(places) {
            *value = row.number(place)?;
        }
        let [lower, upper, velocity_rad_s, acceleration_rad_s2] = values;
        let highest =
            [LARGEST_ANGLE_RAD, LARGEST_ANGLE_RAD, HIGHEST_VELOCITY_RAD_S, HIGHEST_ACCELERATION_RAD_S2];
        if let Some(k) = (0..values.len()).find(|k| values[*k].abs() > highest[*k]) {
            let reason = format!(
                "column `{}`: {} is beyond what a joint has ({:.4}); angles are in radians, half a turn is 3.1416",
                COLUMNS[k], values[k], highest[k]
            );
            return Err(table.refuse(Some(row.line), Some(places[k]), reason));
        }
        if lower >= upper || velocity_rad_s <= 0.0 || acceleration_rad_s2 <= 0.0 {
            let reason = "there is no room between these limits; lower_rad must be below upper_rad, velocity and \
                          acceleration above 0";
            return Err(table.refuse(Some(row.line), None, reason.to_owned()));
        }
        limits.push(MotionLimits { position_rad: [lower, upper], velocity_rad_s, acceleration_rad_s2 });
    }
    if limits.len() == joints {
        Ok(limits)
    } else {
        let reason = format!("has limits of {} joints, the geometry has {joints}", limits.len());
        Err(table.refuse(None, None, reason))
    }
}
