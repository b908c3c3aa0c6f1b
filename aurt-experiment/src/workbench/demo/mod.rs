//! The recordings of `aurt demo`: a simulated UR10e whose friction is known, and the same robot after something
//! has changed.

use aurt_simulation::effects::{Effect, Payload};
use aurt_simulation::{Logger, Motion, Robot, Scenario, SimulationError, robots, simulate};

/// The experiment, as it is written into the demo's folder.
pub const EXPERIMENT: &str = include_str!("experiment.toml");

pub type File = (String, Vec<u8>);

/// Joints whose friction grows with the load, as in the experiment.
const LOADED_JOINTS: [usize; 2] = [1, 2];
/// Their dry friction per transmitted torque.
const LOAD_COEFFICIENT: f64 = 0.08;

pub fn robot() -> Robot {
    let mut robot = robots::ur10e();
    for joint in LOADED_JOINTS {
        robot.drives[joint].load_coefficient = LOAD_COEFFICIENT;
    }
    robot
}

/// Geometry, recordings and experiment.
pub fn files() -> Result<Vec<File>, SimulationError> {
    let robot = robot();
    let exciting = Motion::MultiSine { duration_s: 20.0, harmonics: 8, top_hz: 1.0, share: 0.6 };
    let other = Motion::MultiSine { duration_s: 10.0, harmonics: 6, top_hz: 0.8, share: 0.5 };
    let poses = Motion::PointToPoint { duration_s: 10.0, share: 0.4, rest_s: 0.5 };
    let motions = [
        ("exciting_motion.csv", exciting.clone(), 11, false),
        ("other_motion.csv", other.clone(), 12, false),
        ("point_to_point.csv", poses, 13, false),
        ("later_motion.csv", exciting, 14, true),
        ("later_other_motion.csv", other, 15, true),
    ];
    let mut files = vec![
        ("mdh.csv".to_owned(), robot.mdh_csv().into_bytes()),
        ("experiment.toml".to_owned(), EXPERIMENT.into()),
        (QUESTION_FILE.to_owned(), question().into_bytes()),
    ];
    for (name, motion, seed, later) in motions {
        let mut scenario = Scenario::new(robot.clone(), motion.plan(&robot, seed)?, seed);
        scenario.logger = Logger { rate_hz: 125.0, ..Logger::default() };
        if later {
            scenario.effects.push(concealed());
        }
        files.push((name.to_owned(), simulate(&scenario)?.csv()));
    }
    Ok(files)
}

/// Name of the experiment that asks what has changed.
pub const QUESTION_FILE: &str = "later.toml";

/// The experiment with the later recordings: what do they show that the model does not have?
fn question() -> String {
    let lines = EXPERIMENT.lines().skip(2).map(|line| {
        if line.starts_with("validation = ") {
            "target = [\"later_motion.csv\"]\nvalidation = [\"later_other_motion.csv\"]"
        } else {
            line
        }
    });
    let title = "# What has changed? Ask with\n#   aurt diagnose later.toml --out diagnosis\n";
    title.to_owned() + &lines.map(|line| format!("{line}\n")).collect::<String>()
}

/// What the later recordings have and the diagnosis is not told.
fn concealed() -> Box<dyn Effect> {
    Box::new(Payload { link: 5, mass_kg: 2.0, com_m: [0.02, -0.03, 0.08], edges_m: [0.1, 0.08, 0.12] })
}

pub const CONCEALED: &str = "a load of 2 kg, fixed to link 5";

/// The true values of those parameters of the experiment's model that are no inertial ones, by name.
pub fn truth() -> Vec<(String, f64)> {
    let robot = robot();
    let mut truth = Vec::new();
    for (joint, drive) in robot.drives.iter().enumerate() {
        truth.push((format!("F_C0_{joint}"), drive.coulomb_nm));
        if LOADED_JOINTS.contains(&joint) {
            truth.push((format!("F_C1_{joint}"), drive.load_coefficient));
        }
        truth.push((format!("F_v1_{joint}"), drive.viscous_nm_s));
    }
    let rotors = robot.drives.iter().enumerate().skip(2);
    truth.extend(
        rotors.map(|(joint, drive)| (format!("rotor_inertia.I_a_{joint}"), drive.rotor_inertia_kg_m2)),
    );
    truth
}
