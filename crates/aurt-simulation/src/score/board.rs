use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::case_score::CaseScore;
use super::claim::Answer;
use crate::Strength;
use crate::case::CaseType;

/// How many of how many.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Share {
    /// Those that are right (or whatever is counted).
    pub count: usize,
    /// All.
    pub of: usize,
}

impl Share {
    fn counted<'a>(scores: impl IntoIterator<Item = &'a CaseScore>, is: impl Fn(&CaseScore) -> bool) -> Self {
        let mut share = Self::default();
        for score in scores {
            share.of += 1;
            share.count += usize::from(is(score));
        }
        share
    }

    /// The share, none of nothing.
    #[must_use]
    pub fn ratio(&self) -> Option<f64> {
        (self.of > 0).then(|| self.count as f64 / self.of as f64)
    }
}

/// What became of the cases of one effect at one strength.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EffectRow {
    /// Identifier.
    pub effect: String,
    /// Strength.
    pub strength: Strength,
    /// First label right.
    pub right: Share,
    /// First label or a declared alternative right.
    pub right_with_alternatives: Share,
    /// Family of the first label right.
    pub right_family: Share,
    /// Anything was said to be missing.
    pub noticed: Share,
    /// Mean F1 of joints.
    pub joint_f1: Option<f64>,
    /// Mean overlap of windows.
    pub window_overlap: Option<f64>,
    /// Median relative error of the parameters.
    pub parameter_error: Option<f64>,
    /// Median share of the possible held-out improvement that was recovered, where the name was right.
    pub recovered: Option<f64>,
}

/// How often an effect was called something else.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Confusion {
    /// What it was.
    pub truth: String,
    /// What it was called: a label, or the answer if there was none.
    pub called: String,
    /// How often.
    pub count: usize,
}

/// How often claims of about one confidence were right.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reliability {
    /// Scores of the claims: from.
    pub from_score: f64,
    /// To.
    pub to_score: f64,
    /// Mean confidence that was claimed.
    pub claimed: f64,
    /// First labels that were right.
    pub right: Share,
}

/// What a set of verdicts came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scoreboard {
    /// Singles at each strength: first label right.
    pub singles: BTreeMap<Strength, Share>,
    /// The same counting declared alternatives.
    pub singles_with_alternatives: BTreeMap<Strength, Share>,
    /// The same counting families.
    pub families: BTreeMap<Strength, Share>,
    /// Mean F1 of the joints of singles, at each strength.
    pub joint_f1: BTreeMap<Strength, f64>,
    /// Pairs of which both were named first.
    pub pairs: Share,
    /// Effects of pairs that were named at all.
    pub effects_of_pairs: Share,
    /// Nulls in which something was said to be missing.
    pub nulls_flagged: Share,
    /// Strangers that were called unexplained.
    pub strangers: Share,
    /// Cases whose candidate was removed that were called unexplained or by a neighbour.
    pub removed: Share,
    /// Cases whose candidate was removed and in which nothing was said to be missing.
    pub removed_unnoticed: Share,
    /// Mean overlap of windows.
    pub window_overlap: Option<f64>,
    /// Median share of the possible held-out improvement that was recovered, of singles of medium strength and
    /// above whose name was right.
    pub recovered: Option<f64>,
    /// Effect by effect.
    pub effects: Vec<EffectRow>,
    /// What was called something else, most frequent first.
    pub confusion: Vec<Confusion>,
    /// Claims by score.
    pub reliability: Vec<Reliability>,
}

/// Edges of the bins of scores.
const SCORE_EDGES: [f64; 7] = [0.0, 20.0, 50.0, 150.0, 500.0, 1500.0, f64::INFINITY];

impl Scoreboard {
    /// The board of a set of scores.
    #[must_use]
    pub fn of(scores: &[CaseScore]) -> Self {
        let all = |case_type: CaseType| {
            scores.iter().filter(move |s| s.case_type == case_type && s.removed.is_none())
        };
        let singles: Vec<&CaseScore> = all(CaseType::Single).collect();
        let strengths: Vec<Strength> =
            Strength::ALL.into_iter().filter(|k| singles.iter().any(|s| s.strength == *k)).collect();
        let by_strength = |is: fn(&CaseScore) -> bool| -> BTreeMap<Strength, Share> {
            strengths
                .iter()
                .map(|k| (*k, Share::counted(singles.iter().copied().filter(|s| s.strength == *k), is)))
                .collect()
        };
        let joint_f1 = strengths
            .iter()
            .filter_map(|k| {
                let values = singles.iter().filter(|s| s.strength == *k).filter_map(|s| s.joint_f1);
                Some((*k, mean(values)?))
            })
            .collect();
        let removed: Vec<&CaseScore> = scores.iter().filter(|s| s.removed.is_some()).collect();
        let mut effects_of_pairs = Share::default();
        for pair in all(CaseType::Pair) {
            effects_of_pairs.of += pair.truth.len();
            effects_of_pairs.count += pair.truth.iter().filter(|t| pair.named.contains(t)).count();
        }
        Self {
            singles: by_strength(|s| s.right),
            singles_with_alternatives: by_strength(|s| s.right_with_alternatives),
            families: by_strength(|s| s.right_family),
            joint_f1,
            pairs: Share::counted(all(CaseType::Pair), |s| s.right),
            effects_of_pairs,
            nulls_flagged: Share::counted(all(CaseType::Null), |s| s.answer != Answer::NoMismatch),
            strangers: Share::counted(all(CaseType::Stranger), |s| s.right),
            removed: Share::counted(removed.iter().copied(), |s| s.right),
            removed_unnoticed: Share::counted(removed.iter().copied(), |s| s.answer == Answer::NoMismatch),
            window_overlap: mean(singles.iter().filter_map(|s| s.window_overlap)),
            recovered: median(
                singles
                    .iter()
                    .filter(|s| s.right && s.strength >= Strength::Medium)
                    .filter_map(|s| s.recovered)
                    .collect(),
            ),
            effects: effect_rows(&singles),
            confusion: confusion(&singles),
            reliability: reliability(scores),
        }
    }
}

fn effect_rows(singles: &[&CaseScore]) -> Vec<EffectRow> {
    let mut rows: BTreeMap<(&str, Strength), Vec<&CaseScore>> = BTreeMap::new();
    for score in singles {
        if let Some(effect) = score.truth.first() {
            rows.entry((effect, score.strength)).or_default().push(score);
        }
    }
    rows.into_iter()
        .map(|((effect, strength), scores)| {
            let share = |is: fn(&CaseScore) -> bool| Share::counted(scores.iter().copied(), is);
            let errors = scores.iter().flat_map(|s| s.parameter_errors.iter().map(|e| e.relative));
            EffectRow {
                effect: effect.into(),
                strength,
                right: share(|s| s.right),
                right_with_alternatives: share(|s| s.right_with_alternatives),
                right_family: share(|s| s.right_family),
                noticed: share(|s| s.answer != Answer::NoMismatch),
                joint_f1: mean(scores.iter().filter_map(|s| s.joint_f1)),
                window_overlap: mean(scores.iter().filter_map(|s| s.window_overlap)),
                parameter_error: median(errors.collect()),
                recovered: median(scores.iter().filter(|s| s.right).filter_map(|s| s.recovered).collect()),
            }
        })
        .collect()
}

fn confusion(singles: &[&CaseScore]) -> Vec<Confusion> {
    let mut counts: BTreeMap<(&str, String), usize> = BTreeMap::new();
    for score in singles.iter().filter(|s| !s.right) {
        let called = match (score.named.first(), score.answer) {
            (_, Answer::Unexplained) => "unexplained".to_owned(),
            (Some(name), _) => name.clone(),
            (None, _) => "no_mismatch".to_owned(),
        };
        let truth = score.truth.first().map_or("", String::as_str);
        *counts.entry((truth, called)).or_default() += 1;
    }
    let mut list: Vec<Confusion> = counts
        .into_iter()
        .map(|((truth, called), count)| Confusion { truth: truth.into(), called, count })
        .collect();
    list.sort_by(|a, b| b.count.cmp(&a.count).then_with(|| a.truth.cmp(&b.truth)));
    list
}

/// Claims of every kind of case, whether right or not: a claim on a null or a stranger is wrong.
fn reliability(scores: &[CaseScore]) -> Vec<Reliability> {
    SCORE_EDGES
        .windows(2)
        .filter_map(|edge| {
            let inside: Vec<&CaseScore> = scores
                .iter()
                .filter(|s| s.removed.is_none() && s.answer != Answer::Unexplained)
                .filter(|s| s.score.is_some_and(|x| x >= edge[0] && x < edge[1]))
                .collect();
            let claimed = mean(inside.iter().filter_map(|s| s.confidence))?;
            let hit = |s: &CaseScore| s.named.first().is_some_and(|n| s.truth.contains(n));
            Some(Reliability {
                from_score: edge[0],
                to_score: edge[1],
                claimed,
                right: Share::counted(inside.iter().copied(), hit),
            })
        })
        .collect()
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), v| (sum + v, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|v| v.is_finite());
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    let odd = values.len() % 2 == 1;
    (!values.is_empty())
        .then(|| if odd { values[middle] } else { 0.5 * (values[middle - 1] + values[middle]) })
}
