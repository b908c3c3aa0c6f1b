use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::effect::{Effect, Factor, Setup, check_joints};
use super::kind::{self, Draw, EffectKind, Family, Presence};
use crate::error::Complaints;
use crate::error::SimulationError;
use crate::random::Random;
use crate::robots::Robot;

pub(super) const KIND: EffectKind = EffectKind {
    identifier: "saturation",
    family: Family::D,
    summary: "a current sensor that cannot show large values",
    presence: Presence::Either,
    rotors: None,
    takes: kind::Takes::One,
    suits: kind::any_joint,
    draw,
    read: kind::read::<Saturation>,
};

/// The measured torque stops at ± the limit; the drive's does not.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Saturation {
    /// The joint.
    pub joint: usize,
    /// The limit, Nm.
    pub limit_nm: f64,
    /// The largest torque that the motion needs, Nm.
    pub peak_nm: f64,
}

fn draw(context: &Draw<'_>, random: &mut Random) -> Box<dyn Effect> {
    let joint = context.joint();
    let peak_nm = context.peak_torque_nm.get(joint).copied().unwrap_or(1.0).max(1e-3);
    Box::new(Saturation { joint, limit_nm: peak_nm * random.between(0.65, 0.8), peak_nm })
}

impl Effect for Saturation {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        vec![self.joint]
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("limit", vec![self.limit_nm])]
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        // What is cut off grows faster than the share of the range that is missing.
        let missing = (1.0 - self.limit_nm / self.peak_nm) * factor.on(self.joint).max(0.0).sqrt();
        self.limit_nm = self.peak_nm * (1.0 - missing).clamp(0.25, 0.98);
    }

    fn validate(&self, robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        check_joints(&mut complaints, KIND.identifier, &[self.joint], robot);
        complaints.positive("limit of the measured torque in Nm", self.limit_nm);
        complaints.positive("largest torque of the motion in Nm", self.peak_nm);
        complaints.finish()
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        let channel = &mut setup.instrument.channels[self.joint];
        channel.saturation_nm = channel.saturation_nm.min(self.limit_nm);
        Ok(())
    }

    fn fields(&self) -> Value {
        super::effect::fields(self)
    }
}
