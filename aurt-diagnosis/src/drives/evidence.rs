//! Whether one model predicts held-out recordings better than another.
//!
//! # Equation
//! With the losses ρ of a model (that of [`output_error`](aurt_calibration::drives::output_error)) and n samples of joint j in block b of
//! [`Options::block_s`], its log-likelihood is −Σ_j ½ n ln(1 + ρ̄_jb): errors of one motion are large or small together, and a
//! deviation for all blocks would let the few with the largest decide. Where errors are small this is −½ Σ ρ. d_b is the
//! difference of two models. Blocks in which the two predict the same say nothing of either: a limit that is met in a few
//! blocks is judged by these. The blocks that hold [`ACTING`] of the squared difference of the predictions, the largest first,
//! decide; which they are does not depend on what was measured. Errors of neighbouring blocks depend on each other (stick–slip, poses), so the variance of the mean is
//! the long-run one, γ₀ + 2 Σ_l (1 − l/(L + 1)) γ_l with L = n^⅓ blocks, within recordings; mean over deviation has Student's
//! distribution with n − 1 degrees of freedom.
//!
//! # Source
//! Diebold, Mariano (1995), *Comparing predictive accuracy*, J. Business & Economic Statistics 13; Newey, West (1987) for the
//! variance; Benjamini, Hochberg (1995), J. Royal Statistical Society B 57.

use aurt_calibration::drives::{DriveError, DriveRecording, DrivenArm, Options, loss};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Fewer blocks tell no deviation.
pub const FEWEST_BLOCKS: usize = 8;

/// The share of the squared difference of two predictions whose blocks decide between them.
const ACTING: f64 = 0.95;
/// Blocks of fewer do not decide.
pub(super) const FEWEST_ACTING: usize = 4;
/// Samples of a block from which the difference of two predictions is taken, at most.
const SAMPLES: usize = 64;

/// What a model misses of recordings.
#[derive(Debug, Clone)]
pub struct Missed {
    /// Blocks of time, by recording.
    pub(super) blocks: Vec<Vec<Block>>,
    /// Root mean square of q_sim − q by joint, rad.
    pub rms_rad: Vec<f64>,
    /// Mean loss by joint in units of σ²: a mean square in which large errors weigh less.
    pub(super) loss: Vec<f64>,
}

/// What is missed of some seconds.
#[derive(Debug, Clone, Default)]
pub(super) struct Block {
    pub(super) samples: f64,
    /// Losses by joint.
    pub(super) loss: Vec<f64>,
    /// Errors of some of the samples, joint by joint.
    pub(super) errors_rad: Vec<f32>,
}

impl Block {
    /// Negative log-likelihood in nats, if the mean loss of each joint is larger by an `excess`.
    pub(super) fn nats(&self, excess: f64) -> f64 {
        self.loss.iter().map(|l| 0.5 * self.samples * libm::log1p(l / self.samples + excess)).sum()
    }

    /// The squared difference of two predictions, in rad².
    pub(super) fn apart(&self, other: &Self) -> f64 {
        let pairs = self.errors_rad.iter().zip(&other.errors_rad);
        pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum()
    }
}

/// A model against another on the same recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Log-likelihood per second of the blocks that decide, in nats, that the better model predicts more.
    pub gain_per_s: f64,
    /// Its standard deviation.
    pub deviation: f64,
    /// Probability of such a gain where there is none.
    pub probability: f64,
    /// The largest share by which it lowers the error (mean loss) of a joint together with what a model is expected to miss.
    pub reduction: f64,
    /// Blocks of time that decide: those in which the two predict differently.
    pub blocks: usize,
    /// All blocks of time.
    pub all_blocks: usize,
    /// Root mean squares of both over all joints, rad: with the structure, and without.
    pub rms_rad: [f64; 2],
}

impl Missed {
    /// What `arm` misses.
    ///
    /// # Errors
    /// As [`DrivenArm::rollout`].
    pub fn of(arm: &DrivenArm, recordings: &[DriveRecording], options: &Options) -> Result<Self, DriveError> {
        let joints = arm.joints.len();
        let (mut blocks, mut squares, mut losses, mut samples) =
            (Vec::new(), vec![0.0; joints], vec![0.0; joints], 0.0);
        for recording in recordings {
            let begin_s = recording.time_s[recording.first];
            let stride = stride(recording, options);
            let mut own: Vec<Block> = Vec::new();
            for piece in &recording.pieces(options.piece_s)? {
                let simulated = arm.rollout(piece)?;
                for k in piece.first..piece.time_s.len() {
                    let block = ((piece.time_s[k] - begin_s) / options.block_s) as usize;
                    let empty = Block { loss: vec![0.0; joints], ..Block::default() };
                    own.resize(own.len().max(block + 1), empty);
                    own[block].samples += 1.0;
                    samples += 1.0;
                    for j in 0..joints {
                        let error = simulated[j][k - piece.first] - piece.position_rad[j][k];
                        let cost = loss(error / options.deviation_rad).0;
                        own[block].loss[j] += cost;
                        if k % stride == 0 {
                            own[block].errors_rad.push(error as f32);
                        }
                        losses[j] += cost;
                        squares[j] += error * error;
                    }
                }
            }
            blocks.push(own);
        }
        let loss = losses.iter().map(|l| l / samples).collect();
        Ok(Self { blocks, rms_rad: squares.iter().map(|s| (s / samples).sqrt()).collect(), loss })
    }

    /// So many blocks at most, spread over all recordings; not the ends of these, which are shorter.
    pub(super) fn some_blocks(&self, most: usize) -> Vec<&Block> {
        let longest = self.blocks.iter().flatten().map(|b| b.samples).fold(0.0, f64::max);
        let whole: Vec<&Block> = self
            .blocks
            .iter()
            .flatten()
            .filter(|b| 2.0 * b.samples > longest && !b.errors_rad.is_empty())
            .collect();
        whole.iter().step_by(whole.len().div_ceil(most).max(1)).copied().collect()
    }

    /// Root mean square over all joints, rad.
    pub fn rms_all_rad(&self) -> f64 {
        (self.rms_rad.iter().map(|r| r * r).sum::<f64>() / self.rms_rad.len().max(1) as f64).sqrt()
    }
}

impl Comparison {
    /// Against a model whose closed loop is unstable.
    pub(super) fn against_divergence(better: &Missed, blocks: usize) -> Self {
        Self {
            gain_per_s: f64::INFINITY,
            deviation: 0.0,
            probability: 0.0,
            reduction: 1.0,
            blocks,
            all_blocks: blocks,
            rms_rad: [better.rms_all_rad(), f64::INFINITY],
        }
    }
}

/// `better` against `worse`, which may turn out to be the better one.
pub fn compare(better: &Missed, worse: &Missed, options: &Options) -> Comparison {
    let pairs = || better.blocks.iter().zip(&worse.blocks).map(|(b, w)| b.iter().zip(w));
    let all_blocks = pairs().map(Iterator::count).sum::<usize>();
    let least = least_that_decides(pairs().flatten().map(|(b, w)| b.apart(w)).collect());
    // A gain by block of each recording; none where both predict the same.
    let gains: Vec<Vec<Option<f64>>> = pairs()
        .map(|blocks| {
            blocks
                .map(|(b, w)| (b.samples > 0.0 && b.apart(w) >= least).then(|| w.nats(0.0) - b.nats(0.0)))
                .collect()
        })
        .collect();
    let [n, mean, deviation] = mean_of(&gains);
    let blocks = n as usize;
    let probability = StudentsT::new(0.0, 1.0, (n - 1.0).max(1.0))
        .ok()
        .filter(|_| deviation > 0.0 && all_blocks >= FEWEST_BLOCKS && blocks >= FEWEST_ACTING)
        .map_or(1.0, |t| t.sf(mean / deviation));
    // In units of σ², 1 is what a model is expected to miss.
    let reduction = better.loss.iter().zip(&worse.loss).map(|(b, w)| (w - b) / (1.0 + w));
    Comparison {
        gain_per_s: mean / options.block_s,
        deviation: deviation / options.block_s,
        probability,
        reduction: reduction.fold(f64::NEG_INFINITY, f64::max),
        blocks,
        all_blocks,
        rms_rad: [better.rms_all_rad(), worse.rms_all_rad()],
    }
}

/// The count of gains by block of each recording, their mean, and the long-run deviation of that.
pub(super) fn mean_of(gains: &[Vec<Option<f64>>]) -> [f64; 3] {
    let n = gains.iter().flatten().flatten().count() as f64;
    let mean = gains.iter().flatten().flatten().sum::<f64>() / n;
    let lags = libm::cbrt(n) as usize;
    let product = |lag: usize| -> f64 {
        let own = |g: &Vec<Option<f64>>| -> f64 {
            let both = |k: usize| Some((g[k]? - mean) * (g[k - lag]? - mean));
            (lag..g.len()).filter_map(both).sum()
        };
        gains.iter().map(own).sum::<f64>() / (n - 1.0).max(1.0)
    };
    let later: f64 = (1..=lags).map(|l| 2.0 * (1.0 - l as f64 / (lags + 1) as f64) * product(l)).sum();
    // Neighbours that alternate do not make the mean surer than independent ones.
    [n, mean, ((product(0) + later.max(0.0)) / n).sqrt()]
}

/// The least squared difference of two predictions of a block that decides.
pub(super) fn least_that_decides(mut apart: Vec<f64>) -> f64 {
    apart.sort_by(|a, b| b.total_cmp(a));
    let wanted = ACTING * apart.iter().sum::<f64>();
    let mut sum = 0.0;
    let enough = apart.iter().position(|own| {
        sum += own;
        sum >= wanted
    });
    let last = enough.unwrap_or(0).max(FEWEST_ACTING - 1).min(apart.len().saturating_sub(1));
    apart.get(last).copied().unwrap_or_default()
}

/// Every so many samples of a recording are kept of a block.
fn stride(recording: &DriveRecording, options: &Options) -> usize {
    let span_s = recording.time_s[recording.time_s.len() - 1] - recording.time_s[0];
    let of_block = options.block_s / span_s * recording.time_s.len() as f64;
    ((of_block / SAMPLES as f64).ceil() as usize).max(1)
}

/// The largest probability of a claim among `probabilities`, of which chance alone makes at most the share `level` on average.
pub(super) fn largest_of_claims(probabilities: &[f64], level: f64) -> f64 {
    let mut ascending = probabilities.to_vec();
    ascending.sort_by(f64::total_cmp);
    let m = ascending.len() as f64;
    ascending
        .into_iter()
        .zip(1_u32..)
        .filter(|(p, k)| *p <= f64::from(*k) * level / m)
        .map(|(p, _)| p)
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A model whose error of each block is constant, 1e-3 rad for each unit of the loss's root.
    fn missed(losses: Vec<f64>) -> Missed {
        let block = |l: &f64| Block {
            samples: 1e3,
            loss: vec![*l],
            errors_rad: vec![1e-3 * (l.abs().sqrt() as f32)],
        };
        let total = losses.iter().sum();
        Missed { loss: vec![total], blocks: vec![losses.iter().map(block).collect()], rms_rad: vec![1.0] }
    }

    #[test]
    fn a_gain_in_every_block_counts_and_one_that_wanders_does_not() {
        let noise = |k: usize| libm::sin(9.7 * k as f64) * 3.0;
        let options = Options::default();
        let worse = missed((0..40).map(|k| 10.0 + noise(k)).collect());
        let steady = missed((0..40).map(|k| 8.0 + noise(k) + noise(k + 7) * 0.2).collect());
        let found = compare(&steady, &worse, &options);
        assert!(found.probability < 1e-6 && (found.gain_per_s - 0.5).abs() < 0.1, "{found:?}");
        assert!(compare(&worse, &steady, &options).probability > 0.999);
        // A half of the time better by 3, then worse by 2: independent blocks would say p = 0.1.
        let slow = missed((0..40).map(|k| 10.0 + noise(k) + if k < 20 { -3.0 } else { 2.0 }).collect());
        assert!(compare(&slow, &worse, &options).probability > 0.1);
        assert_eq!(compare(&worse, &worse, &options).probability, 1.0);
    }

    /// A limit that is met in 5 of 40 blocks, where it lowers the error to a quarter: over all blocks its gains are those of five
    /// outliers (p = 0.02, of seventeen structures that are tried none), over the blocks that differ they are alike.
    #[test]
    fn a_structure_that_acts_seldom_is_judged_where_it_acts() {
        let noise = |k: usize| 10.0 + libm::sin(9.7 * k as f64);
        let acts = |k: usize| if k % 8 == 3 { 4e3 * libm::exp((k % 3) as f64) } else { 0.0 };
        let options = Options::default();
        let limited = missed((0..40).map(|k| acts(k) + noise(k)).collect());
        let free = missed((0..40).map(|k| acts(k) / 16.0 + noise(k + 5)).collect());
        let found = compare(&free, &limited, &options);
        assert!(found.blocks <= 5 && found.all_blocks == 40 && found.probability < 1e-3, "{found:?}");
        assert!(compare(&limited, &free, &options).probability > 0.999);
        // Better here and worse there is chance, however large.
        let both = missed(
            (0..40).map(|k| if k % 16 == 3 { acts(k) * 16.0 } else { acts(k) / 16.0 } + noise(k)).collect(),
        );
        assert!(compare(&both, &limited, &options).probability > 0.1);
    }

    #[test]
    fn claims_are_within_the_false_discovery_rate() {
        assert_eq!(largest_of_claims(&[0.2, 0.01, 0.03, 0.9], 0.05), 0.01);
        assert_eq!(largest_of_claims(&[0.02, 0.01, 0.03, 0.9], 0.05), 0.03);
        assert_eq!(largest_of_claims(&[0.2, 0.9], 0.05), 0.0);
    }
}
