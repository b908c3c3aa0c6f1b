use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::effect::{Effect, Factor, Setup, check_joints, check_values};
use super::kind::{self, Draw, EffectKind, Family, Presence};
use crate::error::Complaints;
use crate::error::SimulationError;
use crate::random::Random;
use crate::robots::Robot;

pub(super) const KIND: EffectKind = EffectKind {
    identifier: "torque_constant",
    family: Family::D,
    summary: "a torque constant that is not what the experiment says",
    presence: Presence::Either,
    rotors: None,
    takes: kind::Takes::Few,
    suits: kind::any_joint,
    draw,
    read: kind::read::<TorqueConstant>,
};

/// The drive's torque constant is (1 + e) times the stated one: measured torques are too small by 1/(1 + e).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueConstant {
    /// The joints.
    pub joints: Vec<usize>,
    /// e.
    pub gain_error: Vec<f64>,
}

fn draw(context: &Draw<'_>, random: &mut Random) -> Box<dyn Effect> {
    let gain_error = context.joints.iter().map(|_| random.sign() * random.between(0.05, 0.12)).collect();
    Box::new(TorqueConstant { joints: context.joints.to_vec(), gain_error })
}

impl Effect for TorqueConstant {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        self.joints.clone()
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("gain_error", self.gain_error.clone())]
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        for (joint, error) in self.joints.iter().zip(&mut self.gain_error) {
            *error = (*error * factor.on(*joint)).clamp(-0.5, 1.0);
        }
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        check_joints(&mut complaints, KIND.identifier, &self.joints, robot);
        let bounds = (-0.9, 9.0);
        check_values(&mut complaints, KIND.identifier, "gain_error", &self.joints, &self.gain_error, bounds);
        complaints.finish()
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, error) in self.joints.iter().zip(&self.gain_error) {
            setup.instrument.channels[*joint].gain_error = *error;
        }
        Ok(())
    }

    fn fields(&self) -> Value {
        super::effect::fields(self)
    }
}
