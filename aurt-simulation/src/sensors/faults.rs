use serde::{Deserialize, Serialize};

use crate::error::Complaints;
use crate::random::Random;

/// What a logger's clock and transport do to its rows; shares of all rows.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ClockFaults {
    /// Rows that are missing, in short bursts.
    pub missing_share: f64,
    /// Rows that are written twice.
    pub repeated_share: f64,
    /// Rows whose stamp is right but whose values are those of the row before, in short bursts.
    pub held_share: f64,
    /// Rows with an absurd value.
    pub corrupt: CorruptRows,
}

/// Rows with an absurd value.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CorruptRows {
    /// Share of all rows.
    pub share: f64,
}

/// Mean length of a burst of missing or held rows.
const BURST_ROWS: f64 = 5.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fate {
    Written,
    Missing,
    Repeated,
    Held,
    /// An absurd value in the channel of the given index, counted over positions and measurements.
    Corrupt(usize),
}

impl ClockFaults {
    /// Whether there are none.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    pub(crate) fn validate(&self, complaints: &mut Complaints) {
        complaints.within("share of missing rows", self.missing_share, 0.0, 0.5);
        complaints.within("share of repeated rows", self.repeated_share, 0.0, 0.5);
        complaints.within("share of held rows", self.held_share, 0.0, 0.5);
        complaints.within("share of corrupt rows", self.corrupt.share, 0.0, 0.1);
    }

    /// What happens to each of `rows` rows; the first and the last are written.
    pub(super) fn fates(&self, rows: usize, channels: usize, random: &mut Random) -> Vec<Fate> {
        let mut fates = vec![Fate::Written; rows];
        let single =
            |share: f64, random: &mut Random, fates: &mut [Fate], fate: &dyn Fn(&mut Random) -> Fate| {
                for slot in fates.iter_mut() {
                    if random.chance(share) {
                        *slot = fate(random);
                    }
                }
            };
        single(self.repeated_share, random, &mut fates, &|_| Fate::Repeated);
        single(self.corrupt.share, random, &mut fates, &|r| Fate::Corrupt(r.index(channels)));
        for (share, fate) in [(self.missing_share, Fate::Missing), (self.held_share, Fate::Held)] {
            let mut left = 0;
            for slot in &mut fates {
                if left == 0 && random.chance(share / BURST_ROWS) {
                    left = 1 + random.index(2 * BURST_ROWS as usize - 1);
                }
                if left > 0 {
                    *slot = fate;
                    left -= 1;
                }
            }
        }
        if let [first, .., last] = fates.as_mut_slice() {
            (*first, *last) = (Fate::Written, Fate::Written);
        }
        fates
    }
}
