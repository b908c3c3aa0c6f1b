use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::claim::{Answer, Claim, ClaimedEffect};
use super::neighbours::neighbours;
use crate::Strength;
use crate::case::{CaseType, TrueEffect, Truth};
use crate::effects::{Family, kind};

/// Alternatives of a claim that count.
const ALTERNATIVES: usize = 2;
/// A joint counts for the held-out improvement if its mean squared error exceeds the floor by this share.
const IMPROVABLE: f64 = 0.2;

/// How one verdict did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CaseScore {
    /// The case.
    pub case: String,
    /// The robot.
    pub robot: String,
    /// What it is about.
    pub case_type: CaseType,
    /// How strong its effects are.
    pub strength: Strength,
    /// The effect that the diagnosis was not allowed to know.
    pub removed: Option<String>,
    /// Identifiers of what is in it.
    pub truth: Vec<String>,
    /// The answer that was given.
    pub answer: Answer,
    /// Identifiers that were named, without repetition.
    pub named: Vec<String>,
    /// Whether the first label, or the answer where no label is due, is right.
    pub right: bool,
    /// Whether it is right counting the declared alternatives.
    pub right_with_alternatives: bool,
    /// Whether the first label's family is right.
    pub right_family: bool,
    /// F1 of the joints of the first label; of singles.
    pub joint_f1: Option<f64>,
    /// Intersection over union of the windows, where the truth has one and it was named.
    pub window_overlap: Option<f64>,
    /// Errors of the parameters that both have.
    pub parameter_errors: Vec<ParameterError>,
    /// Share of the possible held-out improvement that was recovered.
    pub recovered: Option<f64>,
    /// Confidence of the first label.
    pub confidence: Option<f64>,
    /// Score of the first label.
    pub score: Option<f64>,
}

/// How far a claimed parameter is off.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterError {
    /// Effect.
    pub effect: String,
    /// Canonical name.
    pub parameter: String,
    /// |claimed − true| / |true|.
    pub relative: f64,
}

/// Scores a verdict against the truth; `removed` is the effect that the diagnosis was not allowed to know.
#[must_use]
pub fn score(truth: &Truth, claim: &Claim, removed: Option<&str>) -> CaseScore {
    let names = claim.names();
    let first = claim.effects.first();
    let is = |effect: &TrueEffect, name: &str| effect.effect == name;
    let (right, right_with_alternatives) = match (truth.case_type, removed) {
        (CaseType::Null, _) => both(claim.verdict == Answer::NoMismatch),
        (CaseType::Stranger, _) => both(claim.verdict == Answer::Unexplained),
        (_, Some(removed)) => {
            let near = first.is_some_and(|f| neighbours(removed).contains(&f.effect.as_str()));
            both(claim.verdict == Answer::Unexplained || near)
        }
        (CaseType::Single, None) => {
            let Some(only) = truth.effects.first() else { return unscored(truth, claim) };
            let top = first.is_some_and(|f| is(only, &f.effect));
            let declared = first.is_some_and(|f| {
                f.alternatives.iter().take(ALTERNATIVES).any(|other| is(only, &other.effect))
            });
            (top, top || declared)
        }
        (CaseType::Pair, None) => {
            let top = truth.effects.iter().all(|e| names.iter().take(2).any(|n| is(e, n)));
            let declared = truth.effects.iter().all(|e| {
                claim.effects.iter().any(|f| {
                    let alternatives = f.alternatives.iter().take(ALTERNATIVES);
                    is(e, &f.effect) || alternatives.into_iter().any(|a| is(e, &a.effect))
                })
            });
            (top, top || declared)
        }
    };
    let right_family = match (truth.case_type, first) {
        (CaseType::Null | CaseType::Stranger, _) => right,
        (_, Some(first)) => {
            let family = family_of(&first.effect);
            truth.effects.iter().any(|e| Some(e.family) == family)
        }
        (_, None) => false,
    };
    let single =
        (truth.case_type == CaseType::Single && removed.is_none()).then(|| truth.effects.first()).flatten();
    let window_overlap = single.and_then(|only| {
        let claimed = claim.effects.iter().find(|f| is(only, &f.effect))?;
        Some(overlap(only.window_s?, claimed.window_s.unwrap_or([0.0, 0.0])))
    });
    CaseScore {
        right,
        right_with_alternatives,
        right_family,
        removed: removed.map(str::to_owned),
        joint_f1: single.map(|only| first.map_or(0.0, |f| f1(&only.joints, &claim.joints_of(&f.effect)))),
        window_overlap,
        parameter_errors: if removed.is_none() { parameter_errors(truth, claim) } else { Vec::new() },
        recovered: if removed.is_none() { recovered(truth, claim) } else { None },
        ..unscored(truth, claim)
    }
}

/// Everything that needs no comparison, and nothing right.
fn unscored(truth: &Truth, claim: &Claim) -> CaseScore {
    let first = claim.effects.first();
    CaseScore {
        case: truth.case.clone(),
        robot: truth.robot.clone(),
        case_type: truth.case_type,
        strength: truth.strength,
        removed: None,
        truth: truth.effects.iter().map(|e| e.effect.clone()).collect(),
        answer: claim.verdict,
        named: claim.names().into_iter().map(str::to_owned).collect(),
        right: false,
        right_with_alternatives: false,
        right_family: false,
        joint_f1: None,
        window_overlap: None,
        parameter_errors: Vec::new(),
        recovered: None,
        confidence: first.and_then(|f| f.confidence),
        score: first.and_then(|f| f.evidence).map(|e| e.score),
    }
}

const fn both(right: bool) -> (bool, bool) {
    (right, right)
}

fn family_of(effect: &str) -> Option<Family> {
    kind(effect).ok().map(|kind| kind.family)
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

fn parameter_errors(truth: &Truth, claim: &Claim) -> Vec<ParameterError> {
    let mut errors = Vec::new();
    for effect in &truth.effects {
        let claims: Vec<&ClaimedEffect> =
            claim.effects.iter().filter(|f| f.effect == effect.effect).collect();
        for (name, values) in &effect.parameters {
            for (place, value) in values.iter().enumerate() {
                // Values run along the effect's joints unless there is but one for all of them.
                let joint = (values.len() == effect.joints.len()).then(|| effect.joints[place]);
                let claimed = claims.iter().find_map(|c| claimed_value(c, name, joint));
                if let Some(claimed) = claimed.filter(|_| *value != 0.0 && value.is_finite()) {
                    errors.push(ParameterError {
                        effect: effect.effect.clone(),
                        parameter: name.clone(),
                        relative: (claimed - value).abs() / value.abs(),
                    });
                }
            }
        }
    }
    errors
}

/// The claimed value of a parameter, at a joint where the claim has one for each.
fn claimed_value(claim: &ClaimedEffect, name: &str, joint: Option<usize>) -> Option<f64> {
    match &claim.parameters.get(name)?.value {
        Value::Number(number) if joint.is_none_or(|j| claim.joints.contains(&j)) => number.as_f64(),
        Value::Array(list) => {
            let place = claim.joints.iter().position(|j| Some(*j) == joint)?;
            list.get(place)?.as_f64()
        }
        _ => None,
    }
}

/// Σ_j (before² − after²)/σ_j² over Σ_j (before² − floor²)/σ_j², over the joints that can improve; `before` and
/// `after` are the verdict's, the floor is the truth's.
fn recovered(truth: &Truth, claim: &Claim) -> Option<f64> {
    if truth.effects.is_empty() || truth.validation.is_empty() {
        return None;
    }
    let recordings = truth.validation.len() as f64;
    let (mut gained, mut possible) = (0.0, 0.0);
    for (j, noise) in truth.noise_nm.iter().enumerate() {
        let mean = |of: fn(&crate::case::ValidationFloor) -> &Vec<f64>| {
            truth.validation.iter().map(|v| of(v)[j].powi(2)).sum::<f64>() / recordings
        };
        let (due, floor) = (mean(|v| &v.before_nm), mean(|v| &v.floor_nm));
        let (Some(before), Some(after)) = (claim.held_out.rms_before.get(j), claim.held_out.rms_after.get(j))
        else {
            return None;
        };
        if due > (1.0 + IMPROVABLE) * floor {
            gained += (before.powi(2) - after.powi(2)) / noise.powi(2);
            possible += (before.powi(2) - floor).max(0.0) / noise.powi(2);
        }
    }
    (possible > 0.0).then(|| (gained / possible).clamp(-1.0, 1.0))
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
