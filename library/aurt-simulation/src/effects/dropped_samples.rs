use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::effect::{Effect, Factor, Setup};
use super::kind::{self, Draw, EffectKind, Family, Presence};
use crate::error::SimulationError;
use crate::random::Random;
use crate::robots::Robot;
use crate::sensors::{ClockFaults, CorruptRows};

pub(super) const KIND: EffectKind = EffectKind {
    identifier: "dropped_samples",
    family: Family::Q,
    summary: "missing, repeated, held or corrupt rows",
    presence: Presence::Either,
    rotors: None,
    takes: kind::Takes::All,
    suits: kind::any_joint,
    draw,
    read: kind::read::<DroppedSamples>,
};

/// A logger that loses, repeats, holds or corrupts rows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DroppedSamples {
    /// Shares of rows.
    pub faults: ClockFaults,
}

fn draw(_context: &Draw<'_>, random: &mut Random) -> Box<dyn Effect> {
    let share = random.between(0.01, 0.03);
    let mut faults = ClockFaults::default();
    match random.index(4) {
        0 => faults.missing_share = share,
        1 => faults.repeated_share = share,
        2 => faults.held_share = share,
        _ => faults.corrupt = CorruptRows { share: 0.1 * share },
    }
    Box::new(DroppedSamples { faults })
}

impl Effect for DroppedSamples {
    fn identifier(&self) -> &'static str {
        KIND.identifier
    }

    fn joints(&self) -> Vec<usize> {
        Vec::new()
    }

    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)> {
        let f = &self.faults;
        vec![("share", vec![f.missing_share + f.repeated_share + f.held_share + f.corrupt.share])]
    }

    fn scale(&mut self, factor: Factor<'_>, _robot: &Robot) {
        let f = &mut self.faults;
        for share in [&mut f.missing_share, &mut f.repeated_share, &mut f.held_share] {
            *share = (*share * factor.on(0)).clamp(0.0, 0.2);
        }
        f.corrupt.share = (f.corrupt.share * factor.on(0)).clamp(0.0, 0.008);
    }

    fn validate(&self, _robot: &Robot) -> Result<(), SimulationError> {
        self.faults.check()
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        setup.faults = self.faults;
        Ok(())
    }

    fn fields(&self) -> Value {
        super::effect::fields(self)
    }
}
