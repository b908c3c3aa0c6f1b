use serde::{Deserialize, Serialize};

/// In which recordings of a case the effect is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Presence {
    /// In the targets and what is held out: something has changed.
    Changed,
    /// In all: something is missing.
    All,
}

/// What each recording of a set is for.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Split {
    /// What cases of this split are about.
    pub presence: Presence,
    /// Which of the splits of this presence it is.
    pub turn: usize,
    /// Recordings that calibrate.
    pub calibration: Vec<usize>,
    /// Recordings whose mismatch is to be explained.
    pub target: Vec<usize>,
    /// Recordings that are held out.
    pub validation: Vec<usize>,
}

/// Splits of one presence, at most: each needs a diagnosis of the unaltered recordings.
const MOST_SPLITS: usize = 3;

impl Split {
    /// The splits of so many recordings: each recording in turn is the first to calibrate. Of three or more, one is held
    /// out; one is the target of changes, of five or more two.
    #[must_use]
    pub fn all(recordings: usize, presence: Presence) -> Vec<Self> {
        let targets = match (presence, recordings) {
            (Presence::All, _) => 0,
            (Presence::Changed, 0 | 1) => return Vec::new(),
            (Presence::Changed, 2..=4) => 1,
            (Presence::Changed, _) => 2,
        };
        let held_out = match presence {
            Presence::All => usize::from(recordings >= 2),
            Presence::Changed => usize::from(recordings >= 3),
        };
        (0..recordings.min(MOST_SPLITS))
            .map(|turn| {
                let order: Vec<usize> = (0..recordings).map(|k| (turn + k) % recordings).collect();
                let calibration = recordings - targets - held_out;
                Self {
                    presence,
                    turn,
                    calibration: order[..calibration].to_vec(),
                    target: order[calibration..calibration + targets].to_vec(),
                    validation: order[calibration + targets..].to_vec(),
                }
            })
            .collect()
    }

    /// Name of the unaltered recordings in these roles.
    #[must_use]
    pub fn reference_name(&self, robot: &str) -> String {
        let presence = match self.presence {
            Presence::Changed => "changed",
            Presence::All => "all",
        };
        format!("{robot}_{presence}_{}", self.turn + 1)
    }

    /// The recordings in the order of a case's files, each with whether an effect is in it.
    #[must_use]
    pub fn files(&self) -> Vec<(usize, bool)> {
        let all = self.presence == Presence::All;
        let calibration = self.calibration.iter().map(|k| (*k, all));
        calibration.chain(self.target.iter().chain(&self.validation).map(|k| (*k, true))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_recording_has_one_part_in_every_split() {
        for recordings in 1..7 {
            for presence in [Presence::Changed, Presence::All] {
                for split in Split::all(recordings, presence) {
                    let mut all = [&split.calibration[..], &split.target, &split.validation].concat();
                    all.sort_unstable();
                    assert_eq!(all, (0..recordings).collect::<Vec<_>>());
                    assert!(!split.calibration.is_empty());
                    assert_eq!(split.target.is_empty(), presence == Presence::All);
                }
            }
        }
        assert!(Split::all(1, Presence::Changed).is_empty());
        assert_eq!(Split::all(4, Presence::Changed)[1].calibration, [1, 2]);
    }
}
