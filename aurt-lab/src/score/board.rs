use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::case_score::CaseScore;
use super::learnt::learnt;
use super::world_board::WorldBoard;
use crate::case::World;

/// What a set of verdicts came to, world by world. Nothing is summed over worlds: a total would be a statement on how
/// many cases of each were made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scoreboard {
    pub worlds: BTreeMap<World, WorldBoard>,
    /// Worlds that could not be made here, and why.
    pub skipped: BTreeMap<World, String>,
}

impl Scoreboard {
    /// The board of a set of scores. Where there are several worlds, the confidences of each are also those of the curve
    /// that is learnt on the others.
    pub fn of(scores: &[CaseScore]) -> Self {
        let mut by_world: BTreeMap<World, Vec<CaseScore>> = BTreeMap::new();
        for score in scores {
            by_world.entry(score.world).or_default().push(score.clone());
        }
        let worlds = by_world
            .iter()
            .map(|(world, scores)| {
                let others: Vec<(World, u64, &[CaseScore])> = by_world
                    .iter()
                    .filter(|(other, _)| *other != world)
                    .map(|(other, scores)| (*other, 0, scores.as_slice()))
                    .collect();
                let known =
                    |(.., scores): &(World, u64, &[CaseScore])| scores.iter().any(|s| !s.findings.is_empty());
                let learnt = others.iter().any(known).then(|| learnt(&others));
                (*world, WorldBoard::of(scores, learnt.as_ref()))
            })
            .collect();
        Self { worlds, skipped: BTreeMap::new() }
    }
}
