//! What a black box predicts beyond the improved model.
//!
//! For each joint, boosted trees are fitted to the residual of the improved model on the rows that fit, and judged on held-out
//! rows. What they predict there is something that the model lacks, whether it has a name or not; what they do not predict is noise
//! as far as these recordings show. The features by which they split say what the remainder follows.
//!
//! With B, A and R the squared held-out errors of the baseline, of the improved model, and of the improved model with the trees, and N
//! that of the measured noise, (B − A)/(B − min(N, R, A)) is the share of what is not noise that the claims explain, and (A − R)/A the
//! predictable share of the rest.

mod boosting;
mod features;

use aurt_traits::RobotNames;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use self::boosting::{Boosted, Edges, Growth};
use self::features::{names, of_rows};
use crate::recordings::partition::FEWEST_ROWS;
use crate::recordings::rows::RecordingRows;

/// Length of the stretches that stop the growth in turn, and of those between which shares vary, s; of short recordings an
/// eighth of all, so that there are some, and the fewest rows that say something of their own error.
const STRETCH_S: f64 = 2.0;

/// Rows of a joint that are fitted; of more, every k-th is.
const MOST_ROWS: usize = 6000;

/// Fewer stretches of held-out rows tell no deviation.
const FEWEST_STRETCHES: usize = 4;

/// A remainder matters where predicting it lowers the held-out error by a twentieth: 1 − 0.95².
const MATTERS: f64 = 0.0975;

/// Features that are listed, each with at least this share of the gain.
const LISTED_SHARE: f64 = 0.15;

/// A share, with its standard deviation by the jackknife over stretches of time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Share {
    /// The share.
    pub value: f64,
    /// Its standard deviation.
    pub std: f64,
}

/// A feature that the remainder follows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Follows {
    pub feature: String,
    /// Its share of what the trees gain.
    pub share: f64,
}

/// What the remainder of a joint is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rest {
    /// Nothing that the trees predict: noise, as far as these recordings show.
    Noise,
    /// Something that the model lacks.
    Something,
    /// Something that the trees predict, smaller than what the model is expected to miss.
    Expected,
    /// There are too few rows to tell.
    TooLittleData,
}

/// How the held-out error of a joint is made up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Remainder {
    pub joint: usize,
    /// What is left beside the claims.
    pub rest: Rest,
    /// Share of the baseline's squared error beyond noise that the claims explain; absent without claims or where there is
    /// no such error.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub explained: Option<Share>,
    /// Share of the improved model's squared error that the trees predict; not above zero where they predict nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub predictable: Option<Share>,
    /// What the predictable part follows, largest first; empty where nothing is predicted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub follows: Vec<Follows>,
}

impl Remainder {
    /// The same in the light of what the model is expected to miss: of an error of `rms`, a predictable part below `expected` is
    /// [`Rest::Expected`].
    #[must_use]
    pub fn against(mut self, expected: f64, rms: f64) -> Self {
        let part = self.predictable.map_or(0.0, |share| share.value.max(0.0).sqrt() * rms);
        if self.rest == Rest::Something && part < expected {
            self.rest = Rest::Expected;
        }
        self
    }
}

/// A recording's rows with what the models leave of them.
#[derive(Debug, Clone)]
pub(crate) struct Residual<'a> {
    pub(crate) rows: &'a RecordingRows,
    /// Residual of the baseline, `[joint][row]`.
    pub(crate) before: Vec<Vec<f64>>,
    /// Residual of the improved model, `[joint][row]`.
    pub(crate) after: Vec<Vec<f64>>,
    /// The rigid bodies' torque, `[joint][row]`.
    pub(crate) load_torque: Vec<Vec<f64>>,
    /// Mean squared noise of each joint.
    pub(crate) noise: &'a [f64],
}

/// Rows of a joint: what trees split by, and what they are fitted to.
#[derive(Debug, Clone, Default)]
pub struct Rows {
    /// `[feature][row]`.
    pub features: Vec<Vec<f64>>,
    /// Errors of the baseline.
    pub before: Vec<f64>,
    /// Errors of the improved model, which the trees are fitted to.
    pub after: Vec<f64>,
    /// The stretch of time of each row.
    pub stretch: Vec<usize>,
    /// Mean squared noise at each row; empty where it is not known.
    pub noise: Vec<f64>,
}

impl Rows {
    fn of(recordings: &[Residual<'_>], joint: usize, most: usize) -> Self {
        let counted = |r: &Residual<'_>| r.rows.joints[joint].counts.iter().filter(|c| **c).count();
        let every = recordings.iter().map(counted).sum::<usize>().div_ceil(most).max(1);
        let mut rows = Self::default();
        let rows_of_all: usize = recordings.iter().map(|r| r.rows.rows()).sum();
        let mut first_stretch = 0;
        for recording in recordings.iter().filter(|r| r.rows.rows() > 0) {
            let features = of_rows(recording.rows, joint, recording.load_torque[joint].clone());
            rows.features.resize(features.len(), Vec::new());
            let long = (STRETCH_S * recording.rows.rate_hz) as usize;
            let stretch = (rows_of_all / (2 * FEWEST_STRETCHES)).min(long).max(FEWEST_ROWS);
            let kept = (0..recording.rows.rows()).filter(|k| recording.rows.joints[joint].counts[*k]);
            for row in kept.step_by(every) {
                for (all, own) in rows.features.iter_mut().zip(&features) {
                    all.push(own[row]);
                }
                rows.before.push(recording.before[joint][row]);
                rows.after.push(recording.after[joint][row]);
                let noise = recording.noise[joint];
                rows.noise.push(if noise > 0.0 { noise } else { f64::INFINITY });
                rows.stretch.push(first_stretch + row / stretch);
            }
            first_stretch += recording.rows.rows() / stretch + 1;
        }
        rows
    }

    fn count(&self) -> usize {
        self.after.len()
    }
}

/// Squared errors [B, A, R] of a stretch of a joint's held-out rows, and noise N.
type Squares = [f64; 4];

/// The held-out errors of a joint, stretch by stretch, and the share of the trees' gain by each feature.
#[derive(Debug)]
pub struct Judged {
    stretches: Vec<Squares>,
    gains: Vec<f64>,
}

/// How the held-out error of each joint is made up, and that of all joints together, each in units of its own noise;
/// `has_claims` tells whether the two models differ.
pub(crate) fn remainders(
    fitted: &[Residual<'_>],
    held_out: &[Residual<'_>],
    has_claims: bool,
    robot: RobotNames<'_>,
) -> (Vec<Remainder>, Option<Share>) {
    let joints = fitted.iter().chain(held_out).map(|r| r.rows.joints.len()).max().unwrap_or(0);
    let judge = |joint: usize| {
        Judged::of(&Rows::of(fitted, joint, MOST_ROWS), &Rows::of(held_out, joint, usize::MAX))
    };
    let judged: Vec<Option<Judged>> = (0..joints).into_par_iter().map(judge).collect();
    let remainders = judged
        .iter()
        .enumerate()
        .map(|(joint, judged)| Remainder {
            explained: judged.as_ref().filter(|_| has_claims).and_then(|judged| explained(&judged.stretches)),
            ..Remainder::of(joint, judged.as_ref(), || names(joints, joint, robot))
        })
        .collect();
    let in_noise = |judged: &Judged| -> Vec<Squares> {
        let noise: f64 = judged.stretches.iter().map(noise).sum();
        judged.stretches.iter().map(|squares| squares.map(|s| s / noise.max(f64::MIN_POSITIVE))).collect()
    };
    let all: Vec<Squares> = judged.iter().flatten().flat_map(in_noise).collect();
    (remainders, has_claims.then(|| explained(&all)).flatten())
}

/// The noise of a stretch: what was measured of it, or less where an error is smaller.
fn noise([_, after, rest, noise]: &Squares) -> f64 {
    rest.min(*after).min(*noise)
}

/// The share of the baseline's error beyond noise that the improved model explains; none where there is nothing beyond noise.
fn explained(stretches: &[Squares]) -> Option<Share> {
    jackknife(stretches, |of| 1.0 - noise(&of) / of[0]).filter(|s| matters(*s))?;
    jackknife(stretches, |of| (of[0] - of[1]) / (of[0] - noise(&of)))
}

/// Whether a share of a squared error is more than chance and more than a trifle.
fn matters(share: Share) -> bool {
    share.value > (2.0 * share.std).max(MATTERS)
}

/// A function of sums over stretches; none where it is no number or there are too few stretches.
fn jackknife(stretches: &[Squares], of: impl Fn(Squares) -> f64) -> Option<Share> {
    let sum = stretches.iter().fold([0.0; 4], |all, own| std::array::from_fn(|k| all[k] + own[k]));
    let value = of(sum);
    let without: Vec<f64> =
        stretches.iter().map(|own| of(std::array::from_fn(|k| sum[k] - own[k]))).collect();
    let n = without.len() as f64;
    let mean = without.iter().sum::<f64>() / n;
    let std = ((n - 1.0) / n * without.iter().map(|v| (v - mean).powi(2)).sum::<f64>()).sqrt();
    (value.is_finite() && std.is_finite() && without.len() >= FEWEST_STRETCHES)
        .then_some(Share { value, std })
}

impl Remainder {
    /// What trees say of a joint; `names` are those of the features.
    pub fn of(joint: usize, judged: Option<&Judged>, names: impl FnOnce() -> Vec<String>) -> Self {
        let nothing = Self {
            joint,
            rest: Rest::TooLittleData,
            explained: None,
            predictable: None,
            follows: Vec::new(),
        };
        let Some(judged) = judged else { return nothing };
        let predictable = jackknife(&judged.stretches, |[_, after, rest, _]| 1.0 - rest / after);
        if !predictable.is_some_and(matters) {
            return Self { rest: Rest::Noise, predictable, ..nothing };
        }
        let mut follows: Vec<Follows> = names()
            .into_iter()
            .zip(&judged.gains)
            .map(|(feature, share)| Follows { feature, share: *share })
            .filter(|f| f.share >= LISTED_SHARE)
            .collect();
        follows.sort_by(|a, b| b.share.total_cmp(&a.share));
        Self { rest: Rest::Something, predictable, follows, ..nothing }
    }
}

impl Judged {
    /// Trees fitted to some rows and judged on others; none where there are too few of either.
    pub fn of(own: &Rows, other: &Rows) -> Option<Self> {
        let growth = Growth::default();
        if own.count() < 4 * growth.leaf_rows || other.count() == 0 {
            return None;
        }
        let edges = Edges::of(&own.features);
        let classes = edges.classes(&own.features);
        // How many trees help is found on alternating stretches; then all rows are fitted.
        let (even, odd): (Vec<usize>, Vec<usize>) =
            (0..own.count()).partition(|k| own.stretch[*k].is_multiple_of(2));
        let stopped = |fitted: &[usize], judged: &[usize]| {
            Boosted::fit(&classes, &own.after, fitted, Some(judged), growth).trees()
        };
        let trees = usize::midpoint(stopped(&even, &odd), stopped(&odd, &even));
        let all: Vec<usize> = (0..own.count()).collect();
        let boosted = Boosted::fit(&classes, &own.after, &all, None, Growth { trees, ..growth });

        let classes = edges.classes(&other.features);
        let mut stretches = vec![[0.0; 4]; other.stretch.last().map_or(0, |last| last + 1)];
        for (row, stretch) in other.stretch.iter().enumerate() {
            let (before, after) = (other.before[row], other.after[row]);
            let rest = after - boosted.predict(&classes, row);
            let noise = other.noise.get(row).copied().unwrap_or(f64::INFINITY);
            let squares = [before * before, after * after, rest * rest, noise];
            stretches[*stretch].iter_mut().zip(squares).for_each(|(sum, square)| *sum += square);
        }
        stretches.retain(|squares| squares[1] > 0.0);
        if stretches.len() < FEWEST_STRETCHES {
            return None;
        }
        let gain: f64 = boosted.gains.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        Some(Self { stretches, gains: boosted.gains.iter().map(|own| own / gain).collect() })
    }
}

#[cfg(test)]
mod tests {
    use super::{Remainder, Rest, Share, explained};

    #[test]
    fn what_is_smaller_than_expected_is_no_lack() {
        let rest = |rest| Remainder {
            joint: 0,
            rest,
            explained: None,
            predictable: Some(Share { value: 0.25, std: 0.01 }),
            follows: Vec::new(),
        };
        // A quarter of the square is half of the error.
        let left = |of, expected| rest(of).against(expected, 3e-3).rest;
        assert_eq!(left(Rest::Something, 1.6e-3), Rest::Expected);
        assert_eq!(left(Rest::Something, 1.4e-3), Rest::Something);
        assert_eq!(left(Rest::Noise, 1.6e-3), Rest::Noise);
    }

    #[test]
    fn shares_are_of_what_is_beyond_noise() {
        // Of 9 above the noise of 1 the claims explain 6, whether the trees predict 3 of the 4 that are left or nothing.
        let equal = [[10.0, 4.0, 1.0, f64::INFINITY]; 8];
        assert_eq!(explained(&[[10.0, 4.0, 4.5, 1.0]; 8]), explained(&equal));
        let share = explained(&equal).unwrap();
        assert!((share.value - 2.0 / 3.0).abs() < 1e-12 && share.std < 1e-9, "{share:?}");
        // Noise that was not measured is what trees do not predict.
        assert!((explained(&[[10.0, 4.0, 4.5, f64::INFINITY]; 8]).unwrap().value - 1.0).abs() < 1e-12);
        assert_eq!(explained(&equal[..3]), None, "too few stretches");
        assert_eq!(explained(&[[1.0, 0.99, 0.99, 1.0]; 8]), None, "all is noise");
    }
}
