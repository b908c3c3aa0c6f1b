use super::declaring::*;
use crate::sensors::{ClockFaults, CorruptRows};

/// A logger that loses, repeats, holds or corrupts rows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DroppedSamples {
    /// Shares of rows.
    pub faults: ClockFaults,
}

impl Physics for DroppedSamples {
    const KIND: Declaration = Declaration::new("dropped_samples", Family::Q, Presence::Either, Takes::All);

    fn draw(_context: &Draw<'_>, random: &mut Random) -> Self {
        let share = random.between(0.01, 0.03);
        let mut faults = ClockFaults::default();
        // A row that is written twice is one row to every reader: no mismatch.
        match random.index(3) {
            0 => faults.missing_share = share,
            1 => faults.held_share = share,
            _ => faults.corrupt = CorruptRows { share: 0.1 * share },
        }
        Self { faults }
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

    fn check(&self, complaints: &mut Checks<'_>) {
        self.faults.validate(complaints);
    }

    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError> {
        setup.faults = self.faults;
        Ok(())
    }
}
