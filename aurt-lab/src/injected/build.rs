//! An effect of a wanted strength, on a joint that suits it.

use aurt_simulation::inject::{Added, Built, Injection, Kind, Split};
use aurt_simulation::{Random, SimulationError};

use crate::strength::Strength;

/// Joints and shapes that are tried.
const ATTEMPTS: usize = 6;
/// Share of the wanted strength with which an attempt is good enough.
const GOOD_ENOUGH: f64 = 0.8;
/// Shares of rows that are lost, for weak, medium and strong: such a fault has no torque to be measured by.
const LOST: [f64; 3] = [0.005, 0.02, 0.06];

fn lost(added: &Added, strength: Strength) -> Option<Added> {
    let share = Strength::ALL.iter().zip(LOST).find(|(s, _)| **s == strength).map(|l| l.1);
    share.filter(|_| added.is_loss_of_rows()).map(|share| added.of_size(share))
}

/// An effect of a kind and strength for a split; `taken` are joints that another effect is on.
pub(super) fn build(
    injection: &Injection,
    kind: Kind,
    split: &Split,
    strength: Strength,
    taken: &[usize],
    random: &mut Random,
) -> Result<Option<Built>, SimulationError> {
    let joints = injection.joints();
    let mut suited: Vec<usize> =
        (0..joints).filter(|j| injection.suits(&kind, *j) && !taken.contains(j)).collect();
    random.shuffle(&mut suited);
    let mut best: Option<Built> = None;
    for attempt in 0..ATTEMPTS.min(suited.len() * 2) {
        let joint = suited[attempt % suited.len()];
        let Some(added) = injection.shaped(&kind, joint, random) else { continue };
        let built = match lost(&added, strength) {
            Some(added) => Built { kind, added, achieved: vec![0.0; joints], reached: 1.0 },
            None => injection.sized(kind, added, split, strength.over_left())?,
        };
        if best.as_ref().is_none_or(|b| built.reached > b.reached) {
            best = Some(built);
        }
        if best.as_ref().is_some_and(|b| b.reached >= GOOD_ENOUGH) {
            break;
        }
    }
    Ok(best)
}
