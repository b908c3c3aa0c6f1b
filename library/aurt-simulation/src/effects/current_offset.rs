use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::effect::{Effect, Factor, Setup, check_joints, check_values};
use super::kind::{self, Draw, EffectKind, Family, Presence};
use crate::error::Complaints;
use crate::error::SimulationError;
use crate::random::Random;
use crate::robots::Robot;

pub(super) const KIND: EffectKind = EffectKind {
    identifier: "current_offset",
    family: Family::D,
    summary: "a constant in the measured torque",
    presence: Presence::Either,
    rotors: None,
    takes: kind::Takes::Few,
    suits: kind::any_joint,
    draw,
    read: kind::read::<CurrentOffset>,
};

/// A constant that the measured torque has too much.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurrentOffset {
    /// The joints.
    pub joints: Vec<usize>,
    /// The constant, Nm.
    pub offset_nm: Vec<f64>,
}

fn draw(context: &Draw<'_>, random: &mut Random) -> Box<dyn Effect> {
    Box::new(CurrentOffset { joints: context.joints.to_vec(), offset_nm: context.noises(random.sign()) })
}

impl Effect for CurrentOffset {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        self.joints.clone()
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("offset", self.offset_nm.clone())]
    }

    fn scale(&mut self, factor: Factor<'_>, robot: &Robot) {
        for (joint, offset) in self.joints.iter().zip(&mut self.offset_nm) {
            let most = 0.3 * robot.drives[*joint].torque_limit_nm;
            *offset = (*offset * factor.on(*joint)).clamp(-most, most);
        }
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        check_joints(&mut complaints, KIND.identifier, &self.joints, robot);
        let bounds = (-1e4, 1e4);
        check_values(&mut complaints, KIND.identifier, "offset_nm", &self.joints, &self.offset_nm, bounds);
        complaints.finish()
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        for (joint, offset) in self.joints.iter().zip(&self.offset_nm) {
            setup.instrument.channels[*joint].offset_nm += offset;
        }
        Ok(())
    }

    fn fields(&self) -> Value {
        super::effect::fields(self)
    }
}
