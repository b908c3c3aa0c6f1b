//! What the test of two predictions would say with a motion recorded that is not recorded yet.
//!
//! # Equation
//! Of a block of the motion the difference Δ of the predictions is known. The errors e of the true model are not; they are taken
//! to be those of blocks of the held-out recordings. The gain of log-likelihood of the block,
//! d_b = Σ_j ½ n ln((1 + ρ̄(e + Δ))/(1 + ρ̄(e))), has a mean and a variance v_b over these. The test of
//! [`compare`](super::compare) is one of all held-out blocks together, those of the motion with their means: of those that
//! decide, the mean gain m has in the test the deviation s, s² = s₀² + V, with the long-run variance s₀² of these gains and
//! V = Σ v_b/n². m itself is normal with variance V, so that m > t s has the probability Φ((m − t s)/√V), with t of Student's
//! distribution at the level of the test. That gains differ between blocks is in s₀ alone: a motion in which few blocks tell
//! two models apart decides less than one in which all do.

use aurt_calibration::drives::{Options, loss};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use super::evidence::{Block, FEWEST_ACTING, FEWEST_BLOCKS, Missed, least_that_decides, mean_of};

/// Blocks of held-out recordings of which the errors are taken: the mean of so many gains is off by a fifth of their deviation.
const ERRORS: usize = 24;

/// The difference of two predictions in a block of a motion.
#[derive(Debug, Clone)]
pub(crate) struct BlockApart {
    pub(crate) samples: f64,
    /// The rival's position less the true model's, at some of the samples, joint by joint, rad.
    pub(crate) apart_rad: Vec<f64>,
}

/// The outcome of a test that is foreseen.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Foresight {
    /// The probability that the true model is preferred.
    pub(crate) rightly: f64,
    /// The probability that the other is.
    pub(crate) wrongly: f64,
    /// The expected mean gain in its deviations.
    pub(crate) deviations: f64,
    /// The share by which the true model is expected to lower the error of some joint.
    pub(crate) reduction: f64,
}

/// The gain of a block that is expected.
struct ExpectedGain {
    mean: f64,
    variance: f64,
    /// Losses of the true model and of the rival, by joint.
    loss: [Vec<f64>; 2],
}

impl Foresight {
    /// The test of a true model against a rival at a level, with a motion beside the held-out recordings of both. The rival, the
    /// numbers of which follow the motion, misses each joint of the present ones by so much more mean loss.
    pub(crate) fn of(
        [truth, rival]: [&Missed; 2],
        motion: &[BlockApart],
        excess: f64,
        level: f64,
        options: &Options,
    ) -> Self {
        let errors = truth.some_blocks(ERRORS);
        let expected: Vec<ExpectedGain> =
            motion.iter().map(|block| ExpectedGain::of(block, &errors, options)).collect();
        let kept: usize = errors.iter().map(|b| b.errors_rad.len()).sum();
        let of_samples = kept as f64 / errors.iter().map(|b| b.samples).sum::<f64>();
        let apart = |block: &BlockApart| {
            let square = block.apart_rad.iter().map(|a| a * a).sum::<f64>();
            square / block.apart_rad.len().max(1) as f64 * block.samples * of_samples
        };
        let present = || truth.blocks.iter().zip(&rival.blocks).map(|(t, r)| t.iter().zip(r));
        let all = present().flatten().map(|(t, r)| t.apart(r)).chain(motion.iter().map(apart));
        let all: Vec<f64> = all.collect();
        let (all_blocks, least) = (all.len(), least_that_decides(all));
        let of_block = |t: &Block, r: &Block| (t.apart(r) >= least).then(|| r.nats(excess) - t.nats(0.0));
        let mut gains: Vec<Vec<Option<f64>>> = present()
            .map(|blocks| blocks.map(|(t, r)| of_block(t, r).filter(|_| t.samples > 0.0)).collect())
            .collect();
        let acts: Vec<bool> = motion.iter().map(|block| apart(block) >= least).collect();
        gains.push(expected.iter().zip(&acts).map(|(e, acts)| acts.then_some(e.mean)).collect());
        let [n, mean, long_run] = mean_of(&gains);
        let acting = expected.iter().zip(&acts).filter(|(_, acts)| **acts);
        let own = (acting.map(|(e, _)| e.variance).sum::<f64>() / (n * n)).max(f64::MIN_POSITIVE);
        let deviation = (long_run * long_run + own).sqrt();
        let student = StudentsT::new(0.0, 1.0, (n - 1.0).max(1.0));
        let enough = all_blocks >= FEWEST_BLOCKS && n >= FEWEST_ACTING as f64;
        let least = student.ok().filter(|_| enough).map_or(f64::INFINITY, |t| t.inverse_cdf(1.0 - level));
        let beyond = |mean: f64| Normal::standard().cdf((mean - least * deviation) / own.sqrt());
        Self {
            rightly: beyond(mean),
            wrongly: beyond(-mean),
            deviations: mean / deviation,
            reduction: reduction([truth, rival], motion, excess, &expected),
        }
    }
}

impl ExpectedGain {
    /// The gain of a block, beside the errors of other blocks.
    fn of(block: &BlockApart, errors: &[&Block], options: &Options) -> Self {
        let joints = errors.first().map_or(0, |b| b.loss.len());
        let (rows, n) = (block.apart_rad.len() / joints.max(1), block.samples);
        let (mut gains, mut loss_of) = (Vec::new(), [vec![0.0; joints], vec![0.0; joints]]);
        for own in errors {
            let mut gain = 0.0;
            let own_rows = own.errors_rad.len() / joints;
            for j in 0..joints {
                let mut means = [0.0; 2];
                for k in 0..rows {
                    let error = f64::from(own.errors_rad[k * own_rows / rows * joints + j]);
                    for (mean, apart) in means.iter_mut().zip([0.0, block.apart_rad[k * joints + j]]) {
                        *mean += loss((error + apart) / options.deviation_rad).0 / rows as f64;
                    }
                }
                gain += 0.5 * n * (libm::log1p(means[1]) - libm::log1p(means[0]));
                loss_of.iter_mut().zip(means).for_each(|(l, m)| l[j] += n * m / errors.len() as f64);
            }
            gains.push(gain);
        }
        let count = gains.len().max(1) as f64;
        let mean = gains.iter().sum::<f64>() / count;
        let squares = gains.iter().map(|g| (g - mean).powi(2)).sum::<f64>();
        Self { mean, variance: squares / (count - 1.0).max(1.0), loss: loss_of }
    }
}

/// The largest share of a joint's error, with what a model is expected to miss, that the true model is expected to lower.
fn reduction(
    [truth, rival]: [&Missed; 2],
    motion: &[BlockApart],
    excess: f64,
    expected: &[ExpectedGain],
) -> f64 {
    let present: f64 = truth.blocks.iter().flatten().map(|b| b.samples).sum();
    let samples = present + motion.iter().map(|b| b.samples).sum::<f64>();
    let of = |missed: &Missed, which: usize, excess: f64, j: usize| {
        let new: f64 = expected.iter().map(|e| e.loss[which][j]).sum();
        ((missed.loss[j] + excess) * present + new) / samples
    };
    let share = |j: usize| {
        let lost = of(rival, 1, excess, j);
        (lost - of(truth, 0, 0.0, j)) / (1.0 + lost)
    };
    (0..truth.loss.len()).map(share).fold(f64::NEG_INFINITY, f64::max)
}
