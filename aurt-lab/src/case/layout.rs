use serde::{Deserialize, Serialize};

use aurt_simulation::robots::Robot;
use aurt_simulation::trajectory::{Motion, Trajectory};
use aurt_simulation::{Random, SimulationError};

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    Calibration,
    Target,
    Validation,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RecordingSettings {
    pub duration_s: f64,
    pub rate_hz: f64,
}

impl Default for RecordingSettings {
    fn default() -> Self {
        Self { duration_s: 30.0, rate_hz: 500.0 }
    }
}

#[derive(Debug, Clone)]
pub(super) struct Slot {
    pub role: Role,
    pub trajectory: Trajectory,
    pub affected: bool,
    pub seed: u64,
}

/// The five recordings of a case: two multi-sines and a slow or a steady motion to calibrate on and two to
/// validate with; or, where something is to have changed, two to calibrate on, two targets, one to validate.
pub(super) fn slots(
    robot: &Robot,
    later: bool,
    settings: &RecordingSettings,
    random: &mut Random,
) -> Result<Vec<Slot>, SimulationError> {
    let duration_s = settings.duration_s;
    let sines = |random: &mut Random| Motion::MultiSine {
        duration_s,
        harmonics: 5 + random.index(8),
        top_hz: random.between(0.7, 1.2),
        share: random.between(0.5, 0.75),
    };
    let slow = |random: &mut Random| {
        if random.chance(0.6) {
            let speed_rad_s = random.between(0.06, 0.2);
            Motion::Triangles { duration_s, speed_rad_s, amplitude_rad: random.between(0.2, 0.5) }
        } else {
            Motion::Sweeps { duration_s, share: random.between(0.4, 0.7) }
        }
    };
    let poses = |random: &mut Random| Motion::PointToPoint {
        duration_s,
        share: random.between(0.4, 0.7),
        rest_s: random.between(0.2, 0.6),
    };
    let motions = if later {
        vec![
            (Role::Calibration, sines(random)),
            (Role::Calibration, slow(random)),
            (Role::Target, sines(random)),
            (Role::Target, slow(random)),
            (Role::Validation, sines(random)),
        ]
    } else {
        vec![
            (Role::Calibration, sines(random)),
            (Role::Calibration, sines(random)),
            (Role::Calibration, slow(random)),
            (Role::Validation, sines(random)),
            (Role::Validation, poses(random)),
        ]
    };
    motions
        .into_iter()
        .map(|(role, motion)| {
            let (seed, trajectory) = planned(&motion, robot, random)?;
            Ok(Slot { role, trajectory, affected: !later || role != Role::Calibration, seed })
        })
        .collect()
}

/// Draws after which a motion is given up.
const MOST_DRAWS: usize = 20;

/// A motion within the robot's limits: a draw that leaves them is drawn again.
pub(crate) fn planned(
    motion: &Motion,
    robot: &Robot,
    random: &mut Random,
) -> Result<(u64, Trajectory), SimulationError> {
    let mut draws = 0;
    loop {
        let seed = random.bits();
        draws += 1;
        match motion.plan(robot, seed) {
            Ok(trajectory) => return Ok((seed, trajectory)),
            Err(error) if draws == MOST_DRAWS => return Err(error),
            Err(_) => {}
        }
    }
}
