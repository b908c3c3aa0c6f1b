use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::effect::{Effect, Factor, Setup, check_joints, check_values};
use super::kind::{self, Draw, EffectKind, Family, Presence};
use crate::error::Complaints;
use crate::error::SimulationError;
use crate::random::Random;
use crate::robots::Robot;

pub(super) const KIND: EffectKind = EffectKind {
    identifier: "drive_efficiency",
    family: Family::L,
    summary: "gear losses that differ between driving and being driven",
    presence: Presence::Structural,
    rotors: None,
    takes: kind::Takes::Few,
    suits: constant_level,
    draw,
    read: kind::read::<DriveEfficiency>,
};

/// Gear losses in proportion to the transmitted torque, of two sizes: while the motor drives the load, and
/// while the load drives the motor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveEfficiency {
    /// The joints.
    pub joints: Vec<usize>,
    /// Loss per load while driving, Nm/Nm.
    pub driving: Vec<f64>,
    /// Loss per load while driven, Nm/Nm.
    pub driven: Vec<f64>,
}

/// Whether a joint's friction does not depend on the load by itself.
fn constant_level(robot: &Robot, joint: usize) -> bool {
    robot.drives[joint].load_coefficient == 0.0
}

fn draw(context: &Draw<'_>, random: &mut Random) -> Box<dyn Effect> {
    let (large, small) = (random.between(0.1, 0.2), random.between(0.01, 0.05));
    let (driving, driven) = if random.chance(0.5) { (large, small) } else { (small, large) };
    let joints = context.joints.len();
    Box::new(DriveEfficiency {
        joints: context.joints.to_vec(),
        driving: vec![driving; joints],
        driven: vec![driven; joints],
    })
}

impl Effect for DriveEfficiency {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        self.joints.clone()
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("driving", self.driving.clone()), ("driven", self.driven.clone())]
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        for (joint, (a, b)) in self.joints.iter().zip(self.driving.iter_mut().zip(&mut self.driven)) {
            let factor = factor.on(*joint).min(0.5 / a.max(*b).max(1e-9));
            (*a, *b) = (*a * factor, *b * factor);
        }
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        check_joints(&mut complaints, KIND.identifier, &self.joints, robot);
        for (name, values) in [("driving", &self.driving), ("driven", &self.driven)] {
            check_values(&mut complaints, KIND.identifier, name, &self.joints, values, (0.0, 0.9));
        }
        complaints.finish()
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for ((joint, driving), driven) in self.joints.iter().zip(&self.driving).zip(&self.driven) {
            setup.machine.joints[*joint].load_coefficient = [*driving, *driven];
        }
        Ok(())
    }

    fn fields(&self) -> Value {
        super::effect::fields(self)
    }
}
