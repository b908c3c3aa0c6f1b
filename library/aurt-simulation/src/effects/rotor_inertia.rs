use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::effect::{Effect, Factor, Setup, check_joints, check_values};
use super::kind::{self, Draw, EffectKind, Family, Presence};
use crate::error::Complaints;
use crate::error::SimulationError;
use crate::random::Random;
use crate::robots::{Robot, Rotors};

pub(super) const KIND: EffectKind = EffectKind {
    identifier: "rotor_inertia",
    family: Family::I,
    summary: "inertia of a geared rotor",
    presence: Presence::Structural,
    rotors: Some(Rotors::InLinks),
    takes: kind::Takes::Few,
    suits: kind::any_joint,
    draw,
    read: kind::read::<RotorInertia>,
};

/// A rotor behind the gear, beside those that the robot has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RotorInertia {
    /// The joints.
    pub joints: Vec<usize>,
    /// Inertia on the joint's side, kg m².
    pub inertia_kg_m2: Vec<f64>,
}

fn draw(context: &Draw<'_>, _random: &mut Random) -> Box<dyn Effect> {
    Box::new(RotorInertia { joints: context.joints.to_vec(), inertia_kg_m2: context.noises(0.7) })
}

impl Effect for RotorInertia {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        self.joints.clone()
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("inertia_kg_m2", self.inertia_kg_m2.clone())]
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        for (joint, inertia) in self.joints.iter().zip(&mut self.inertia_kg_m2) {
            *inertia = (*inertia * factor.on(*joint)).min(6.0);
        }
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        check_joints(&mut complaints, KIND.identifier, &self.joints, robot);
        let (values, bounds) = (&self.inertia_kg_m2, (0.0, 1e3));
        check_values(&mut complaints, KIND.identifier, "inertia_kg_m2", &self.joints, values, bounds);
        complaints.finish()
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, inertia) in self.joints.iter().zip(&self.inertia_kg_m2) {
            setup.machine.robot.drives[*joint].rotor_inertia_kg_m2 += inertia;
            setup.machine.nominal.drives[*joint].rotor_inertia_kg_m2 += inertia;
        }
        Ok(())
    }

    fn fields(&self) -> Value {
        super::effect::fields(self)
    }
}
