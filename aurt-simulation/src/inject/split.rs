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
/// Assignments of roles to many recordings that are listed, at most.
const MOST_ASSIGNMENTS: usize = 1000;

impl Split {
    /// The splits of so many recordings: each recording in turn is the first to calibrate. Of three or more, one is held
    /// out; one is the target of changes, of five or more two.
    pub fn all(recordings: usize, presence: Presence) -> Vec<Self> {
        let Some((targets, held_out)) = role_counts(recordings, presence) else { return Vec::new() };
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

    /// The assignments of so many recordings to the roles of a change, each once; of many recordings the first thousand.
    /// Recordings keep their order within a role.
    pub fn assignments(recordings: usize) -> Vec<Self> {
        let Some((targets, held_out)) = role_counts(recordings, Presence::Changed) else { return Vec::new() };
        let without = |all: &[usize], taken: &[usize]| -> Vec<usize> {
            all.iter().copied().filter(|k| !taken.contains(k)).collect()
        };
        let all: Vec<usize> = (0..recordings).collect();
        let mut assignments = Vec::new();
        for target in subsets(&all, targets) {
            let rest = without(&all, &target);
            for validation in subsets(&rest, held_out) {
                if assignments.len() == MOST_ASSIGNMENTS {
                    return assignments;
                }
                assignments.push(Self {
                    presence: Presence::Changed,
                    turn: assignments.len(),
                    calibration: without(&rest, &validation),
                    target: target.clone(),
                    validation,
                });
            }
        }
        assignments
    }

    /// Whether each recording has the same role in both.
    pub fn has_roles_of(&self, other: &Self) -> bool {
        let sorted = |list: &[usize]| {
            let mut list = list.to_vec();
            list.sort_unstable();
            list
        };
        [(&self.calibration, &other.calibration), (&self.target, &other.target)]
            .into_iter()
            .chain([(&self.validation, &other.validation)])
            .all(|(a, b)| sorted(a) == sorted(b))
    }

    /// Name of the unaltered recordings in these roles.
    pub fn reference_name(&self, robot: &str) -> String {
        let presence = match self.presence {
            Presence::Changed => "changed",
            Presence::All => "all",
        };
        format!("{robot}_{presence}_{}", self.turn + 1)
    }

    /// The recordings in the order of a case's files, each with whether an effect is in it.
    pub fn files(&self) -> Vec<(usize, bool)> {
        let all = self.presence == Presence::All;
        let calibration = self.calibration.iter().map(|k| (*k, all));
        calibration.chain(self.target.iter().chain(&self.validation).map(|k| (*k, true))).collect()
    }
}

/// Numbers of targets and of held-out recordings; none where there are too few recordings for a change.
const fn role_counts(recordings: usize, presence: Presence) -> Option<(usize, usize)> {
    match (presence, recordings) {
        (Presence::All, 0 | 1) => Some((0, 0)),
        (Presence::All, _) => Some((0, 1)),
        (Presence::Changed, 0 | 1) => None,
        (Presence::Changed, 2) => Some((1, 0)),
        (Presence::Changed, 3 | 4) => Some((1, 1)),
        (Presence::Changed, _) => Some((2, 1)),
    }
}

fn subsets(of: &[usize], size: usize) -> Vec<Vec<usize>> {
    if size == 0 {
        return vec![Vec::new()];
    }
    let with_first = |k: usize| {
        subsets(&of[k + 1..], size - 1).into_iter().map(move |rest| [&[of[k]], &rest[..]].concat())
    };
    (0..of.len()).flat_map(with_first).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn assignments_differ_and_contain_the_splits() {
        for (recordings, count) in [(0, 0), (1, 0), (2, 2), (3, 6), (4, 12), (5, 30), (40, 1000)] {
            let assignments = Split::assignments(recordings);
            assert_eq!(assignments.len(), count, "{recordings}");
            for (k, one) in assignments.iter().enumerate().take(30) {
                assert!(!assignments[..k].iter().any(|other| other.has_roles_of(one)));
                assert_eq!(one.calibration.len() + one.target.len() + one.validation.len(), recordings);
            }
            let among = |split: &Split| assignments.iter().any(|a| a.has_roles_of(split));
            assert!(recordings > 5 || Split::all(recordings, Presence::Changed).iter().all(among));
        }
    }

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
