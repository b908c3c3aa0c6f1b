use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::case_score::{CaseScore, ScoredFinding};
use super::claim::Answer;
use super::invariance::Invariance;
use super::learnt::confidence;
use super::reliability::Reliability;
use super::share::{Share, mean, median};
use crate::case::CaseType;
use crate::strength::Strength;

/// What became of cases of one effect, at one strength.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Singles {
    /// All of it right: verdict, first label, joints, presence, no other claim.
    pub right: Share,
    /// The true effect is claimed where it alone is examined; of those that were diagnosed so.
    pub seen: Share,
    /// All right, of those.
    pub efficiency: Share,
    /// The same, effects that no recording tells apart counted as one.
    pub right_class: Share,
    /// First label right, whatever the verdict.
    pub first_label: Share,
    /// The same, effects that no recording tells apart counted as one.
    pub first_label_class: Share,
    /// First label or one of its alternatives right, whatever the verdict.
    pub with_alternatives: Share,
    /// Family of the first label right.
    pub family: Share,
    pub anywhere: Share,
    /// A verdict that names an effect, whichever it is.
    pub named: Share,
    /// Anything was said to be missing.
    pub noticed: Share,
    /// The right kinds of recordings, of those whose label stands anywhere.
    pub presence: Share,
    /// Exactly the true joints.
    pub joints: Share,
    /// Mean F1 of the joints of the first label.
    pub joint_f1: Option<f64>,
    /// Claims that are not true, mean of a case.
    pub beside: Option<f64>,
    /// The same, effects that no recording tells apart counted as one.
    pub beside_class: Option<f64>,
    /// Parameters within two claimed standard deviations of the truth.
    pub coverage: Share,
    pub parameter_error: Option<f64>,
    pub window_overlap: Option<f64>,
    /// Mean share of the possible held-out improvement that was recovered, of all cases, right or wrong.
    pub recovered: Option<f64>,
}

impl Singles {
    /// Counts some cases.
    pub fn of(scores: &[&CaseScore]) -> Self {
        let share = |is: fn(&&CaseScore) -> bool| Share::counted(scores.iter().copied(), is);
        let mean_of = |value: fn(&CaseScore) -> Option<f64>| mean(scores.iter().filter_map(|s| value(s)));
        let presence = scores.iter().filter_map(|s| s.presence_right);
        let errors: Vec<_> = scores.iter().flat_map(|s| &s.parameter_errors).collect();
        Self {
            right: share(|s| s.right),
            seen: Share::counted(scores.iter().filter_map(|s| s.seen), |seen| *seen),
            efficiency: Share::counted(scores.iter().filter(|s| s.seen == Some(true)), |s| s.right),
            right_class: share(|s| s.right_class),
            first_label: share(|s| s.first_label),
            first_label_class: share(|s| s.first_label_class),
            with_alternatives: share(|s| s.with_alternatives),
            family: share(|s| s.right_family),
            anywhere: share(|s| s.anywhere),
            named: share(|s| s.answer.names()),
            noticed: share(|s| !matches!(s.answer, Answer::NoMismatch | Answer::Failed)),
            presence: Share::counted(presence, |is| *is),
            joints: share(|s| s.joints_right == Some(true)),
            joint_f1: mean_of(|s| s.joint_f1),
            beside: mean_of(|s| Some(s.beside as f64)),
            beside_class: mean_of(|s| Some(s.beside_class as f64)),
            coverage: Share::counted(errors.iter().filter_map(|e| e.is_covered()), |is| *is),
            parameter_error: median(errors.iter().map(|e| e.relative).collect()),
            window_overlap: mean_of(|s| s.window_overlap),
            recovered: mean_of(|s| s.recovered),
        }
    }
}

/// What became of the cases of one effect at one strength.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectRow {
    pub effect: String,
    pub strength: Strength,
    pub counts: Singles,
}

/// How often an effect was called something else.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Confusion {
    pub truth: String,
    /// What it was called: the answer if it is no naming one, else the first label, with what is wrong if not that.
    pub called: String,
    /// How often.
    pub count: usize,
}

/// What the verdicts on the cases of one world came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorldBoard {
    /// Cases that were diagnosed with the whole vocabulary.
    pub cases: usize,
    /// Cases that were left out, since the same is claimed of the recordings without the effect.
    pub known_before: usize,
    /// Diagnoses that gave no verdict; they count as wrong everywhere.
    pub failed: usize,
    pub singles: BTreeMap<Strength, Singles>,
    pub pairs: Share,
    /// Pairs of which both were named before anything else, whatever the verdict.
    pub pairs_first_labels: Share,
    pub effects_of_pairs: Share,
    /// Nulls in which something was said to be missing.
    pub nulls_flagged: Share,
    /// Nulls of real recordings whose structural claims are those of their reference.
    #[serde(default)]
    pub nulls_agree: Share,
    /// What nulls were flagged by, and in how many.
    pub flagged_by: BTreeMap<String, usize>,
    /// Unknown effects that were called unexplained.
    pub unknown_effects: Share,
    /// Claims in the cases of unknown effects, mean of a case.
    pub beside_unknown_effects: Option<f64>,
    /// Cases whose candidate was removed that were called unexplained or by a neighbour.
    pub removed: Share,
    /// Cases whose candidate was removed and in which nothing was said to be missing.
    pub removed_unnoticed: Share,
    /// Claims that are not true, mean of a case of any kind.
    pub beside: Option<f64>,
    /// Joints on which a black box is better than the improved model by more than a twentieth.
    pub rival_better: Share,
    /// Agreement of variants with their cases, where these were diagnosed.
    #[serde(default)]
    pub invariance: Option<Invariance>,
    pub effects: Vec<EffectRow>,
    /// What was called something else, most frequent first.
    pub confusion: Vec<Confusion>,
    pub reliability: Reliability,
    /// What confidences learnt on the other worlds are worth, where there are others.
    pub reliability_learnt_elsewhere: Option<Reliability>,
}

impl WorldBoard {
    /// The board of the scores of one world; `elsewhere` was learnt on the others.
    pub fn of(scores: &[CaseScore], elsewhere: Option<&aurt_diagnosis::Learnt>) -> Self {
        let own: Vec<&CaseScore> = scores.iter().filter(|s| s.removed.is_none()).collect();
        let known_before = own.iter().filter(|s| s.known_before).count();
        let all = |case_type: CaseType| -> Vec<&CaseScore> {
            own.iter().copied().filter(|s| s.case_type == case_type && !s.known_before).collect()
        };
        let singles = all(CaseType::Single);
        let (pairs, nulls, unknown_effects) =
            (all(CaseType::Pair), all(CaseType::Null), all(CaseType::UnknownEffect));
        let removed: Vec<&CaseScore> = scores.iter().filter(|s| s.removed.is_some()).collect();
        let share = |of: &[&CaseScore], is: fn(&&CaseScore) -> bool| Share::counted(of.iter().copied(), is);
        let mut flagged_by = BTreeMap::new();
        for name in nulls.iter().flat_map(|s| &s.flagged_by) {
            *flagged_by.entry(name.clone()).or_default() += 1;
        }
        let named = |s: &CaseScore| s.truth.iter().filter(|t| s.named.contains(t)).count();
        let findings = findings(scores);
        Self {
            cases: own.len(),
            known_before,
            failed: own.iter().filter(|s| s.answer == Answer::Failed).count(),
            singles: by_strength(&singles),
            pairs: share(&pairs, |s| s.right),
            pairs_first_labels: share(&pairs, |s| s.first_label),
            effects_of_pairs: Share {
                count: pairs.iter().map(|s| named(s)).sum(),
                of: pairs.iter().map(|s| s.truth.len()).sum(),
            },
            nulls_flagged: share(&nulls, |s| !s.right),
            nulls_agree: Share::counted(nulls.iter().filter_map(|s| s.structure_agrees), |is| *is),
            flagged_by,
            unknown_effects: share(&unknown_effects, |s| s.right),
            beside_unknown_effects: mean(unknown_effects.iter().map(|s| s.beside as f64)),
            removed: share(&removed, |s| s.right),
            removed_unnoticed: share(&removed, |s| s.answer == Answer::NoMismatch),
            beside: mean(own.iter().filter(|s| !s.known_before).map(|s| s.beside as f64)),
            rival_better: Share {
                count: own.iter().map(|s| s.rival_better.count).sum(),
                of: own.iter().map(|s| s.rival_better.of).sum(),
            },
            invariance: Invariance::of(&own),
            effects: effect_rows(&singles),
            confusion: confusion(&singles),
            reliability: Reliability::of(&findings, |f| f.confidence),
            reliability_learnt_elsewhere: elsewhere
                .map(|learnt| Reliability::of(&findings, |f| confidence(learnt, f))),
        }
    }
}

fn by_strength(singles: &[&CaseScore]) -> BTreeMap<Strength, Singles> {
    let of =
        |k: Strength| -> Vec<&CaseScore> { singles.iter().copied().filter(|s| s.strength == k).collect() };
    Strength::ALL
        .into_iter()
        .map(|k| (k, of(k)))
        .filter(|(_, of)| !of.is_empty())
        .map(|(k, of)| (k, Singles::of(&of)))
        .collect()
}

fn effect_rows(singles: &[&CaseScore]) -> Vec<EffectRow> {
    let mut rows: BTreeMap<(&str, Strength), Vec<&CaseScore>> = BTreeMap::new();
    for score in singles {
        if let Some(effect) = score.truth.first() {
            rows.entry((effect, score.strength)).or_default().push(score);
        }
    }
    rows.into_iter()
        .map(|((effect, strength), scores)| EffectRow {
            effect: effect.into(),
            strength,
            counts: Singles::of(&scores),
        })
        .collect()
}

fn confusion(singles: &[&CaseScore]) -> Vec<Confusion> {
    let mut counts: BTreeMap<(&str, String), usize> = BTreeMap::new();
    for score in singles.iter().filter(|s| !s.right) {
        let truth = score.truth.first().map_or("", String::as_str);
        *counts.entry((truth, called(score))).or_default() += 1;
    }
    let mut list: Vec<Confusion> = counts
        .into_iter()
        .map(|((truth, called), count)| Confusion { truth: truth.into(), called, count })
        .collect();
    list.sort_by(|a, b| {
        b.count.cmp(&a.count).then_with(|| a.truth.cmp(&b.truth)).then_with(|| a.called.cmp(&b.called))
    });
    list
}

/// What a wrong answer called an effect, or what is wrong besides the right label.
fn called(score: &CaseScore) -> String {
    if !score.answer.names() {
        return score.answer.name().to_owned();
    }
    let label = score.named.first().map_or("no effect", String::as_str).to_owned();
    if !score.first_label {
        return label;
    }
    let mut wrong = Vec::new();
    if score.joints_right == Some(false) {
        wrong.push("other joints");
    }
    if score.presence_right == Some(false) {
        wrong.push("other recordings");
    }
    if score.beside > 0 {
        wrong.push("more than it");
    }
    format!("{label}, {}", wrong.join(", "))
}

fn findings(scores: &[CaseScore]) -> Vec<&ScoredFinding> {
    scores.iter().flat_map(|s| &s.findings).collect()
}
