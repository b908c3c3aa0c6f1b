//! The robot that `aurt excite` plans motions for: geometry and limits, each from where it is stated.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::table_file::TableFile;
use aurt_rbd::robots::{DescribedRobot, KNOWN_ROBOTS, known_robot};
use aurt_rbd::{Coupling, JointKind, MdhRow, MdhRows, MdhTable, Parent, RobotDescription};
use aurt_simulation::{MotionLimits, Robot, SimulationError};
use aurt_traits::RigidBodyRegressor;
use clap::Args;

use super::compile_rbd::ROWS;
use crate::values::{Gravity, choice, parse_gravity};

/// Which robot, and what its limits are.
#[derive(Debug, Args)]
#[command(group(clap::ArgGroup::new("which").required(true).args(["robot", "mdh"])))]
pub struct PlannedRobotOptions {
    /// A robot by its name, or its URDF or MJCF file
    #[arg(long, value_name = "NAME|FILE")]
    robot: Option<String>,
    /// Link of the file that the chain starts from
    #[arg(long, value_name = "LINK", requires = "robot")]
    base: Option<String>,
    /// Link of the file that the chain ends at
    #[arg(long, value_name = "LINK", requires = "robot")]
    tip: Option<String>,
    /// Table of modified Denavit–Hartenberg parameters of yours
    #[arg(long, value_name = "MDH.csv", requires = "limits")]
    mdh: Option<PathBuf>,
    /// Gravitational acceleration in the base frame, m/s²
    #[arg(long, value_name = "X Y Z", value_parser = parse_gravity, allow_hyphen_values = true)]
    gravity: Option<Gravity>,
    /// Which joint a row's alpha and a lead to
    #[arg(long, value_parser = choice(ROWS), default_value = "next")]
    mdh_rows: MdhRows,
    /// Table of joint limits, a row each: lower_rad, upper_rad, velocity_rad_s, acceleration_rad_s2; by
    /// default those of the description
    #[arg(long, value_name = "LIMITS.csv")]
    limits: Option<PathBuf>,
    /// Velocity limit of joints whose description states none; m/s for prismatic joints
    #[arg(long, value_name = "RAD/S", conflicts_with_all = ["mdh", "limits"])]
    velocity_rad_s: Option<f64>,
    /// Acceleration limit of all joints; by default full speed is reached in 0.5 s
    #[arg(long, value_name = "RAD/S2", conflicts_with_all = ["mdh", "limits"])]
    acceleration_rad_s2: Option<f64>,
}

pub struct PlannedRobot {
    /// Geometry and limits.
    pub robot: Robot,
    /// The rigid bodies, where they are not the robot's chain: joints follow others.
    pub bodies: Option<Arc<dyn RigidBodyRegressor>>,
    /// Names of the joints that move on their own; none of a table and of simulated robots.
    pub joint_names: Vec<String>,
    /// Where the limits are from, and what was supplied to them.
    pub notes: Vec<String>,
    pub knows_torques: bool,
}

/// Time in which a joint reaches full speed if nothing is said of its acceleration, s.
const TIME_TO_FULL_SPEED_S: f64 = 0.5;
/// Range of a joint that turns without end, to either side, rad.
const HALF_TURN_RAD: f64 = std::f64::consts::PI;
const UPRIGHT_M_S2: [f64; 3] = [0.0, 0.0, -9.81];

impl PlannedRobotOptions {
    pub fn inputs(&self) -> Vec<&Path> {
        let file = self.robot.as_deref().map(Path::new).filter(|file| file.is_file());
        [self.mdh.as_deref(), self.limits.as_deref(), file].into_iter().flatten().collect()
    }

    pub fn planned(&self) -> Result<PlannedRobot, Failure> {
        if let Some(mdh) = &self.mdh {
            return self.of_table(mdh);
        }
        let asked = self.robot.as_deref().unwrap_or_default();
        let file = Path::new(asked);
        if file.is_file() {
            return self.of_description(
                &aurt_rbd::robots::read(file, self.base.as_deref(), &self.tip.as_deref().into(), None)?,
                asked,
            );
        }
        if self.base.is_some() || self.tip.is_some() {
            return Err(Failure::argument(
                "--tip",
                format!("`{asked}` is no file"),
                "give the robot's URDF or MJCF file",
            ));
        }
        match (Robot::named(asked), known_robot(asked)) {
            (Ok(mut robot), _) if self.limits.is_none() => {
                if let Some(Gravity(gravity)) = self.gravity {
                    robot.gravity_m_s2 = gravity;
                }
                let notes = vec![format!("limits: those of {asked}, as it is simulated")];
                Ok(PlannedRobot { robot, bodies: None, joint_names: Vec::new(), notes, knows_torques: true })
            }
            (_, Some(known)) => self.of_description(&known.description(), &known.name),
            (Ok(_), None) => Err(Failure::argument(
                "--limits",
                format!("{asked} is simulated with limits of its own"),
                "leave `--limits` out, or give the geometry with `--mdh`",
            )),
            (Err(SimulationError::UnknownRobot { name, mut known }), None) => {
                known.extend(KNOWN_ROBOTS.iter().map(|robot| robot.name.clone()));
                known.sort();
                known.dedup();
                Err(SimulationError::UnknownRobot { name, known }.into())
            }
            (Err(error), None) => Err(error.into()),
        }
    }

    fn of_table(&self, mdh: &Path) -> Result<PlannedRobot, Failure> {
        let table = MdhTable::from_path(mdh, self.mdh_rows)?;
        let mut gravity = self.gravity.map_or(UPRIGHT_M_S2, |g| g.0);
        if let (MdhRows::Previous, Some(first)) = (table.reading, table.rows.first()) {
            // What leads to the first joint only turns gravity.
            let (sin, cos) = first.alpha_rad.sin_cos();
            gravity = [gravity[0], cos * gravity[1] + sin * gravity[2], cos * gravity[2] - sin * gravity[1]];
        }
        let rows = in_next_reading(table);
        let (limits, note) = self.limits_of_file(rows.len())?.unwrap_or_default();
        let robot = Robot::of_geometry("your robot", rows, gravity, &limits);
        Ok(PlannedRobot {
            robot,
            bodies: None,
            joint_names: Vec::new(),
            notes: vec![note],
            knows_torques: false,
        })
    }

    /// The limits of the table that was given, and a note that says so.
    fn limits_of_file(&self, joints: usize) -> Result<Option<(Vec<MotionLimits>, String)>, Failure> {
        let Some(path) = &self.limits else { return Ok(None) };
        Ok(Some((read_limits(path, joints)?, format!("limits: those of {}", path.display()))))
    }

    fn of_description(&self, described: &DescribedRobot, from: &str) -> Result<PlannedRobot, Failure> {
        let gravity_m_s2 = self.gravity.map_or(UPRIGHT_M_S2, |g| g.0);
        let (limits, mut notes) = match self.limits_of_file(described.joint_names.len())? {
            Some((limits, note)) => (limits, vec![note]),
            None => self.limits_of(described, from)?,
        };
        let joint_names = described.joint_names.clone();
        let followers = described.joints.len() - joint_names.len();
        if followers > 0 {
            notes.push(format!("{followers} joints follow others (mimic) and are no columns of the motion"));
        }
        let is_tree = described.joints.iter().any(|joint| joint.parent != Parent::Previous);
        if is_tree {
            notes.push(
                "the robot is a tree, planned as a whole: whether its parts meet each other is not checked"
                    .into(),
            );
        }
        if followers > 0 || is_tree {
            let bodies = Some(described.rigid_body(gravity_m_s2)?);
            let robot = Robot::of_limits(&described.name, &limits);
            return Ok(PlannedRobot { robot, bodies, joint_names, notes, knows_torques: false });
        }
        let as_mdh = described.as_mdh(gravity_m_s2)?;
        let robot = Robot::of_geometry(&described.name, as_mdh.rows, as_mdh.gravity_m_s2, &limits);
        Ok(PlannedRobot { robot, bodies: None, joint_names, notes, knows_torques: false })
    }

    /// The limits that a description states, with what it leaves open; a note for each thing that was supplied.
    fn limits_of(
        &self,
        described: &DescribedRobot,
        from: &str,
    ) -> Result<(Vec<MotionLimits>, Vec<String>), Failure> {
        for (option, value) in
            [("--velocity-rad-s", self.velocity_rad_s), ("--acceleration-rad-s2", self.acceleration_rad_s2)]
        {
            if let Some(value) = value.filter(|v| !(v.is_finite() && *v > 0.0)) {
                return Err(Failure::argument(
                    option,
                    format!("{value} is no limit"),
                    "give a positive number",
                ));
            }
        }
        let (mut limits, mut endless, mut without_speed, mut without_range, mut without_room) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (coordinate, (name, stated)) in described.joint_names.iter().zip(&described.limits).enumerate() {
            let own = described.couplings.iter().position(|c| *c == Coupling::own(coordinate));
            let kind = described.joints[own.unwrap_or(coordinate)].kind;
            let position_rad = stated.position_rad.unwrap_or_else(|| {
                let list = if kind == JointKind::Revolute { &mut endless } else { &mut without_range };
                list.push(name.as_str());
                [-HALF_TURN_RAD, HALF_TURN_RAD]
            });
            let [lower, upper] = position_rad;
            if lower >= upper {
                without_room.push(format!("{name} (lower {lower}, upper {upper})"));
            }
            let velocity_rad_s = stated.velocity_rad_s.or_else(|| {
                without_speed.push(name.as_str());
                self.velocity_rad_s
            });
            let velocity_rad_s = velocity_rad_s.unwrap_or_default();
            let acceleration_rad_s2 =
                self.acceleration_rad_s2.unwrap_or(velocity_rad_s / TIME_TO_FULL_SPEED_S);
            limits.push(MotionLimits { position_rad, velocity_rad_s, acceleration_rad_s2 });
        }
        if !without_room.is_empty() {
            return Err(Failure::argument(
                "--robot",
                format!(
                    "{from} states position limits without room between them: {}",
                    without_room.join(", ")
                ),
                "correct the file (the lower limit must be below the upper one, those of joints that follow others included), \
                 or give all limits in a table: --limits limits.csv",
            ));
        }
        if !without_range.is_empty() {
            return Err(Failure::argument(
                "--robot",
                format!("{from} states no range of the prismatic joints {}", without_range.join(", ")),
                "give all limits in a table: --limits limits.csv",
            ));
        }
        if self.velocity_rad_s.is_none() && !without_speed.is_empty() {
            return Err(Failure::argument(
                "--robot",
                format!("{from} states no velocity limit of the joints {}", without_speed.join(", ")),
                "give one for them with --velocity-rad-s, or all limits in a table: --limits limits.csv",
            ));
        }
        let mut notes = vec![format!("limits of positions and velocities: those of {from}")];
        if let (Some(velocity), false) = (self.velocity_rad_s, without_speed.is_empty()) {
            notes.push(format!("velocity limit of {}: {velocity}, as given", without_speed.join(", ")));
        }
        if !endless.is_empty() {
            notes.push(format!(
                "no range is stated of {}: planned within half a turn to either side of zero; if they cannot go there, give \
                 --limits",
                endless.join(", ")
            ));
        }
        notes.push(match self.acceleration_rad_s2 {
            Some(acceleration) => format!("acceleration limit: {acceleration} of all joints, as given"),
            None => format!(
                "acceleration limits are not stated: planned so that full speed takes {TIME_TO_FULL_SPEED_S} s or more; \
                 --acceleration-rad-s2 sets another"
            ),
        });
        Ok((limits, notes))
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

const COLUMNS: [&str; 4] = ["lower_rad", "upper_rad", "velocity_rad_s", "acceleration_rad_s2"];

/// Largest angle of a joint's limits, rad: two turns. Half a turn in degrees is beyond it.
const LARGEST_ANGLE_RAD: f64 = aurt_rbd::LARGEST_ANGLE_RAD;
const HIGHEST_VELOCITY_RAD_S: f64 = 100.0;
const HIGHEST_ACCELERATION_RAD_S2: f64 = 1e4;

/// Reads limits: a header with [`COLUMNS`] in any order, and a row for each joint.
pub fn read_limits(path: &Path, joints: usize) -> Result<Vec<MotionLimits>, Failure> {
    let table = TableFile::read(
        path,
        "write the columns lower_rad, upper_rad, velocity_rad_s, acceleration_rad_s2 and a row for each joint",
    )?;
    let mut places = [0; 4];
    for (place, column) in places.iter_mut().zip(COLUMNS) {
        *place = table.column(column).ok_or_else(|| {
            table.refuse(Some(table.header_line), None, format!("has no column `{column}`"))
        })?;
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
