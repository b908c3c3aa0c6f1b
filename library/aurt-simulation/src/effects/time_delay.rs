use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::effect::{Effect, Factor, Setup};
use super::kind::{self, Draw, EffectKind, Family, Presence};
use crate::error::Complaints;
use crate::error::SimulationError;
use crate::random::Random;
use crate::robots::Robot;

pub(super) const KIND: EffectKind = EffectKind {
    identifier: "time_delay",
    family: Family::D,
    summary: "measured torques that lag behind the positions",
    presence: Presence::Either,
    rotors: None,
    takes: kind::Takes::All,
    suits: kind::any_joint,
    draw,
    read: kind::read::<TimeDelay>,
};

/// The torque in a row is older than its position.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimeDelay {
    /// By how much, s.
    pub delay_s: f64,
}

fn draw(_context: &Draw<'_>, random: &mut Random) -> Box<dyn Effect> {
    Box::new(TimeDelay { delay_s: random.between(0.004, 0.008) })
}

impl Effect for TimeDelay {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        Vec::new()
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        vec![("delay_s", vec![self.delay_s])]
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        self.delay_s = (self.delay_s * factor.on(0)).clamp(2e-4, 0.08);
    }

    fn validate(&self, _robot: &Robot) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        complaints.within("delay of the torque in s", self.delay_s, -0.5, 0.5);
        complaints.finish()
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        setup.instrument.torque_delay_s += self.delay_s;
        Ok(())
    }

    fn fields(&self) -> Value {
        super::effect::fields(self)
    }
}
