use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::claim::{Answer, Claim, is_change};
use super::claim_set::ClaimDifference;
use super::compared::compare;
use super::neighbours::neighbours;
use super::news::{Background, News, Sameness, distinct, meet};
use super::nulls::{agreement, flagged_by, flagged_by_change, is_of_change_alone};
use super::parameters::{ParameterError, parameter_errors};
use super::share::Share;
use crate::case::{CaseType, Truth, World};
use crate::effects::kind;
use crate::strength::Strength;
use aurt_simulation::effects::Family;

/// A joint counts for the held-out improvement if its mean squared error exceeds the floor by this share.
const IMPROVABLE: f64 = 0.2;

/// How one verdict did. The parts are counted each for itself; `right` is all of them together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaseScore {
    pub case: String,
    pub world: World,
    pub robot: String,
    pub case_type: CaseType,
    pub strength: Strength,
    /// The effect that the diagnosis was not allowed to know.
    pub removed: Option<String>,
    pub truth: Vec<String>,
    /// Whether the same is claimed of the recordings without the effects: nothing can be found that is new.
    pub known_before: bool,
    pub answer: Answer,
    /// Identifiers that were named and are news, without repetition.
    pub named: Vec<String>,
    /// Whether it is right: a verdict that names an effect (in `clean`, where nothing else is missing, not `partly_explained`), the
    /// right effects first, on their joints, in the right recordings, and no other claim. Of nulls: nothing flagged (of real
    /// recordings: no change); of unknown effects: a verdict that leaves something unexplained; where the candidate was removed:
    /// such a verdict, or a neighbour under a verdict that names an effect.
    pub right: bool,
    /// The same, with effects that no recording tells apart counted as one.
    pub right_class: bool,
    /// Whether the first label is right, whatever the verdict.
    pub first_label: bool,
    /// The same, with effects that no recording tells apart counted as one.
    pub first_label_class: bool,
    /// Whether the first label or one of its alternatives is right, whatever the verdict.
    pub with_alternatives: bool,
    pub right_family: bool,
    /// Whether the true labels stand anywhere.
    pub anywhere: bool,
    /// Whether the true effect is claimed where it alone is examined, on its joints and in its kinds of recordings; of
    /// singles that were diagnosed so.
    pub seen: Option<bool>,
    /// Joints on which a black box lowers the held-out error of the improved model by more than a twentieth.
    pub rival_better: Share,
    /// Whether the joints are the true ones exactly; of singles and pairs.
    pub joints_right: Option<bool>,
    /// Whether the kinds of recordings are right; of singles and pairs whose label stands anywhere.
    pub presence_right: Option<bool>,
    /// Claims that are neither true, nor of the background, nor of the reference; a claim on several joints counts
    /// once for each. Of nulls of real recordings: claims of a change.
    pub beside: usize,
    /// The same, with effects that no recording tells apart counted as one.
    pub beside_class: usize,
    /// What a null was flagged by: the claims that are news, or the verdict.
    pub flagged_by: Vec<String>,
    /// Whether the structural claims are those of the reference, other recordings of the same robot; of nulls of real
    /// recordings.
    #[serde(default)]
    pub structure_agrees: Option<bool>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub variants: BTreeMap<String, ClaimDifference>,
    /// Structural claims by which the second half of the reference differs from the first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub halves: Option<ClaimDifference>,
    /// F1 of the joints of the first label; of singles.
    pub joint_f1: Option<f64>,
    /// Intersection over union of the windows, where the truth has one and it was named.
    pub window_overlap: Option<f64>,
    pub parameter_errors: Vec<ParameterError>,
    /// Share of the possible held-out improvement that was recovered.
    pub recovered: Option<f64>,
    pub findings: Vec<ScoredFinding>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ScoredFinding {
    pub effect: String,
    pub confidence: f64,
    pub evidence: BTreeMap<String, f64>,
    pub ambiguous: bool,
    /// Whether the effect is in the truth, in the background or claimed of the reference, on a joint of the finding.
    pub hit: bool,
}

/// Scores a verdict against the truth. `removed` is the effect that the diagnosis was not allowed to know, `reference`
/// the verdict on the same recordings without the effects.
pub fn score(truth: &Truth, claim: &Claim, removed: Option<&str>, reference: Option<&Claim>) -> CaseScore {
    let of_change_alone = is_of_change_alone(truth);
    let background = Background::new(truth, reference.filter(|_| !of_change_alone));
    let mut news = background.news(truth, claim);
    news.retain(|n| n.change || !of_change_alone);
    let change = truth.effects.first().is_some_and(|e| is_change(&e.present_in));
    let answer = claim.answer(change);
    // With two verdicts, the first label is the first of the question that the truth answers.
    let order: Vec<&News<'_>> =
        distinct(news.iter().filter(|n| claim.structure.is_none() || n.change == change));
    let strict = compare(&truth.effects, &news, &order, answer, Sameness::Strict);
    let class = compare(&truth.effects, &news, &order, answer, Sameness::Class);
    let flagged_by = if of_change_alone {
        flagged_by_change(claim, &news)
    } else {
        flagged_by(truth, claim, &news, reference)
    };
    let is_of_vocabulary = matches!(truth.case_type, CaseType::Single | CaseType::Pair) && removed.is_none();
    let (right, right_class) = match (truth.case_type, removed) {
        (CaseType::Null, _) => both(flagged_by.is_empty()),
        (CaseType::UnknownEffect, _) => both(answer.leaves_something()),
        (_, Some(removed)) => {
            let near = order.first().is_some_and(|n| neighbours(removed).contains(&n.effect));
            both(answer.leaves_something() || near && answer.names())
        }
        // In `clean` nothing is missing but what is concealed.
        _ if truth.world == World::Clean && answer == Answer::PartlyExplained => both(false),
        _ => (strict.right, class.right),
    };
    let single = truth.effects.first().filter(|_| is_of_vocabulary && truth.case_type == CaseType::Single);
    CaseScore {
        case: truth.case.clone(),
        world: truth.world,
        robot: truth.robot.clone(),
        case_type: truth.case_type,
        strength: truth.strength,
        removed: removed.map(str::to_owned),
        truth: truth.effects.iter().map(|e| e.effect.clone()).collect(),
        known_before: truth.effects.iter().any(|e| {
            let claimed = Background::new(&Truth { background: Vec::new(), ..truth.clone() }, reference).has(
                &e.effect,
                is_change(&e.present_in),
                &e.joints,
            );
            claimed && e.in_vocabulary
        }),
        answer,
        named: distinct(news.iter()).iter().map(|n| n.effect.to_owned()).collect(),
        right,
        right_class,
        first_label: if is_of_vocabulary { strict.first_label } else { right },
        first_label_class: if is_of_vocabulary { class.first_label } else { right },
        with_alternatives: if is_of_vocabulary { strict.with_alternatives } else { right },
        right_family: if is_of_vocabulary { family_is_right(truth, &order) } else { right },
        anywhere: if is_of_vocabulary { strict.anywhere } else { right },
        seen: None,
        rival_better: claim.rival_better(),
        joints_right: is_of_vocabulary.then_some(strict.joints),
        presence_right: (is_of_vocabulary && strict.anywhere).then_some(strict.presence),
        beside: strict.beside,
        beside_class: class.beside,
        structure_agrees: agreement(truth, claim, reference),
        variants: BTreeMap::new(),
        halves: None,
        flagged_by: if truth.case_type == CaseType::Null { flagged_by } else { Vec::new() },
        joint_f1: single
            .map(|only| order.first().map_or(0.0, |n| f1(&only.joints, &joints_of(&news, n.effect)))),
        window_overlap: single.and_then(|only| {
            let claimed = claim.effects.iter().find(|f| f.effect == only.effect)?;
            Some(overlap(only.window_s?, claimed.window_s.unwrap_or([0.0, 0.0])))
        }),
        parameter_errors: if removed.is_none() { parameter_errors(truth, claim) } else { Vec::new() },
        recovered: if removed.is_none() { recovered(truth, claim) } else { None },
        findings: if removed.is_none() { findings(truth, claim, &background) } else { Vec::new() },
    }
}

impl CaseScore {
    /// Whether the true effect is claimed, on its joints and in its kinds of recordings, whatever else is.
    pub fn sees(&self) -> bool {
        self.anywhere && self.joints_right != Some(false) && self.presence_right != Some(false)
    }
}

const fn both(right: bool) -> (bool, bool) {
    (right, right)
}

fn family_is_right(truth: &Truth, order: &[&News<'_>]) -> bool {
    let family: Option<Family> = order.first().and_then(|n| kind(n.effect).ok()).map(|k| k.family);
    family.is_some() && truth.effects.iter().any(|e| Some(e.family) == family)
}

fn findings(truth: &Truth, claim: &Claim, background: &Background<'_>) -> Vec<ScoredFinding> {
    claim
        .effects
        .iter()
        .filter(|c| c.is_change() || !is_of_change_alone(truth))
        .filter_map(|c| {
            let is_true =
                truth.effects.iter().any(|e| e.effect == c.effect && meet(&c.effect, &e.joints, &c.joints));
            Some(ScoredFinding {
                effect: c.effect.clone(),
                confidence: c.confidence.filter(|p| p.is_finite())?,
                evidence: c.numbers(),
                ambiguous: !c.alternatives.is_empty(),
                hit: is_true || background.overlaps(c),
            })
        })
        .collect()
}

fn joints_of(news: &[News<'_>], effect: &str) -> Vec<usize> {
    let mut joints: Vec<usize> =
        news.iter().filter(|n| n.effect == effect).flat_map(|n| n.joints.iter().copied()).collect();
    joints.sort_unstable();
    joints.dedup();
    joints
}

/// Harmonic mean of precision and recall of a set of joints.
fn f1(truth: &[usize], claimed: &[usize]) -> f64 {
    let common = truth.iter().filter(|j| claimed.contains(j)).count() as f64;
    let size = (truth.len() + claimed.len()) as f64;
    if size > 0.0 { 2.0 * common / size } else { 1.0 }
}

/// Intersection over union of two windows.
fn overlap(truth: [f64; 2], claimed: [f64; 2]) -> f64 {
    let common = (truth[1].min(claimed[1]) - truth[0].max(claimed[0])).max(0.0);
    let union = (truth[1] - truth[0]) + (claimed[1] - claimed[0]).max(0.0) - common;
    if union > 0.0 { common / union } else { 0.0 }
}

/// Σ_j (before² − after²)/σ_j² over Σ_j (before² − floor²)/σ_j², over the joints that can improve; `before` and
/// `after` are the verdict's, the floor is the truth's. What a verdict without residuals recovers is nothing.
fn recovered(truth: &Truth, claim: &Claim) -> Option<f64> {
    if truth.effects.is_empty() || truth.validation.is_empty() {
        return None;
    }
    let recordings = truth.validation.len() as f64;
    let (mut gained, mut possible) = (0.0, 0.0);
    for (j, noise) in truth.noise_nm.iter().enumerate() {
        let mean = |of: fn(&crate::case::ValidationFloor) -> &Vec<f64>| {
            let squares = truth.validation.iter().map(|v| of(v).get(j).map_or(f64::NAN, |rms| rms.powi(2)));
            squares.sum::<f64>() / recordings
        };
        let (due, floor) = (mean(|v| &v.before_nm), mean(|v| &v.floor_nm));
        if due > (1.0 + IMPROVABLE) * floor {
            let held = |of: &[f64]| of.get(j).copied().filter(|rms| rms.is_finite());
            let (Some(before), Some(after)) =
                (held(&claim.held_out.rms_before), held(&claim.held_out.rms_after))
            else {
                return (claim.verdict == Answer::Failed).then_some(0.0);
            };
            gained += (before.powi(2) - after.powi(2)) / noise.powi(2);
            possible += (before.powi(2) - floor).max(0.0) / noise.powi(2);
        }
    }
    (possible > 0.0 && gained.is_finite()).then(|| (gained / possible).clamp(-1.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_and_windows_are_compared_as_sets() {
        assert!((f1(&[1, 2], &[2]) - 2.0 / 3.0).abs() < 1e-12);
        assert_eq!((f1(&[3], &[3]), f1(&[3], &[4]), f1(&[3], &[])), (1.0, 0.0, 0.0));
        assert!((overlap([1.0, 3.0], [2.0, 4.0]) - 1.0 / 3.0).abs() < 1e-12);
        assert_eq!((overlap([1.0, 3.0], [1.0, 3.0]), overlap([1.0, 3.0], [4.0, 5.0])), (1.0, 0.0));
    }
}
