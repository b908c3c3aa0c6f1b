use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::effect::{Effect, Factor, Setup, check_joints, check_values};
use super::kind::{self, Draw, EffectKind, Family, Presence};
use crate::error::Complaints;
use crate::error::SimulationError;
use crate::random::Random;
use crate::robots::Robot;

pub(super) const KIND: EffectKind = EffectKind {
    identifier: "load_dependent_friction",
    family: Family::L,
    summary: "dry friction that grows with the torque that the gear transmits",
    presence: Presence::Structural,
    rotors: None,
    takes: kind::Takes::Few,
    suits: constant_level,
    draw,
    read: kind::read::<LoadDependentFriction>,
};

/// Dry friction in proportion to the transmitted torque, beside the constant level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoadDependentFriction {
    /// The joints.
    pub joints: Vec<usize>,
    /// Friction per load, Nm/Nm.
    pub load_coefficient: Vec<f64>,
}

/// Whether a joint's friction does not depend on the load by itself.
fn constant_level(robot: &Robot, joint: usize) -> bool {
    robot.drives[joint].load_coefficient == 0.0
}

fn draw(context: &Draw<'_>, random: &mut Random) -> Box<dyn Effect> {
    let coefficient = random.between(0.06, 0.15);
    Box::new(LoadDependentFriction {
        joints: context.joints.to_vec(),
        load_coefficient: vec![coefficient; context.joints.len()],
    })
}

impl Effect for LoadDependentFriction {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        self.joints.clone()
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("load_coefficient", self.load_coefficient.clone())]
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        for (joint, coefficient) in self.joints.iter().zip(&mut self.load_coefficient) {
            *coefficient = (*coefficient * factor.on(*joint)).min(0.45);
        }
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        check_joints(&mut complaints, KIND.identifier, &self.joints, robot);
        let (values, bounds) = (&self.load_coefficient, (0.0, 0.9));
        check_values(&mut complaints, KIND.identifier, "load_coefficient", &self.joints, values, bounds);
        complaints.finish()
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, coefficient) in self.joints.iter().zip(&self.load_coefficient) {
            setup.machine.joints[*joint].load_coefficient = [*coefficient; 2];
        }
        Ok(())
    }

    fn fields(&self) -> Value {
        super::effect::fields(self)
    }
}
