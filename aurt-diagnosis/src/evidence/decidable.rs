//! What the baseline absorbs of a candidate, and the hypotheses that are left.

use crate::evidence::problem::Problem;
use crate::hypotheses::candidates::Candidate;
use crate::hypotheses::group::{Group, Switch};
use crate::request::Question;
use crate::vocabulary::Presence;

/// Below this share of its torque a column counts as absorbed by the baseline and is left out of its group.
const ABSORBED: f64 = 1e-3;

/// Hypotheses from candidates: each in all recordings and in targets alone, without what the baseline absorbs.
pub(crate) fn groups(
    candidates: &[Candidate],
    problem: &Problem,
    base: &[Switch],
    weights: &[f64],
    question: &Question<'_>,
) -> (Vec<Group>, Vec<[f64; 2]>) {
    let mut groups = Vec::new();
    let mut free = vec![[0.0; 2]; candidates.len()];
    let target = problem.has_target();
    let reference = problem.has_reference();
    for (index, candidate) in candidates.iter().enumerate() {
        for target_only in [false, true] {
            let wanted = match candidate.proposal.presence {
                Presence::Structure => !target_only && reference,
                Presence::Change => target_only && target,
                Presence::Any if target_only => target,
                Presence::Any => reference,
            };
            if !wanted {
                continue;
            }
            let switches: Vec<Switch> = candidate
                .columns
                .iter()
                .enumerate()
                .map(|(k, column)| Switch {
                    column: *column,
                    target_only,
                    nonnegative: candidate.proposal.nonnegative.get(k).copied().unwrap_or(false),
                })
                .collect();
            let share = problem.free_share(base, &switches, weights);
            free[index][usize::from(target_only)] = share.iter().copied().fold(0.0, f64::max);
            if free[index][usize::from(target_only)] < question.selection.free_share {
                continue;
            }
            let free_ones = switches.into_iter().zip(&share).enumerate().filter(|(_, (_, s))| **s > ABSORBED);
            let (essential, switches): (Vec<bool>, Vec<Switch>) =
                free_ones.map(|(k, (switch, _))| ((candidate.effect.is_essential)(k), switch)).unzip();
            groups.push(Group {
                effect: candidate.effect,
                joints: candidate.proposal.joints.clone(),
                candidate: index,
                accessory: essential.iter().zip(&switches).filter(|(e, _)| !**e).map(|(_, s)| *s).collect(),
                switches,
                shapes: candidate.proposal.shapes.len(),
            });
        }
    }
    (groups, free)
}
