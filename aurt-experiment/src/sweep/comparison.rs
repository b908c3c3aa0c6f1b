//! Whether two points differ by more than noise explains.

use aurt_calibration::two_sided;

use crate::sweep::result::JointErrors;

const FEWEST_BLOCKS: usize = 8;

/// Probability that one point does better than another, block of time by block of time, as consistently as it does if
/// neither is better; nothing where the blocks are too few or are not the same stretches of time, or where the two do
/// alike.
///
/// Both points are compared on the same motion: each block gives one number, the logarithm of the ratio of their summed
/// squared errors, so that no single stretch of large errors decides. The mean of these numbers is tested against zero
/// by Student's t. Neighbouring blocks are not independent: the variance of the mean takes in their autocovariance up to
/// a lag of 4 (n/100)^(2/9), with triangular weights (Newey and West 1987). Where the blocks speak for the one point and
/// the sum over all of them for the other, the probability is one.
pub fn paired(a: &JointErrors, b: &JointErrors) -> Option<f64> {
    paired_overall(std::slice::from_ref(a), std::slice::from_ref(b))
}

/// [`paired`] over all joints together: each block gives the mean of the joints' logarithms.
pub fn paired_overall(a: &[JointErrors], b: &[JointErrors]) -> Option<f64> {
    if a.len() != b.len() || a.iter().zip(b).any(|(a, b)| a.block_rows != b.block_rows) {
        return None;
    }
    let blocks = a.iter().map(|e| e.block_rows.len()).max()?;
    let logarithm = |a: f64, b: f64| Some((a / b).ln()).filter(|log| log.is_finite());
    let mean = |logs: Vec<f64>| (!logs.is_empty()).then(|| logs.iter().sum::<f64>() / logs.len() as f64);
    let of_block = |block: usize| {
        let joints = a.iter().zip(b).filter_map(|(a, b)| {
            logarithm(*a.block_squared_error.get(block)?, *b.block_squared_error.get(block)?)
        });
        mean(joints.collect())
    };
    let logs: Vec<f64> = (0..blocks).filter_map(of_block).collect();
    let total =
        mean(a.iter().zip(b).filter_map(|(a, b)| logarithm(a.squared_error, b.squared_error)).collect())?;
    let probability = test(&logs)?;
    Some(if total * logs.iter().sum::<f64>() > 0.0 { probability } else { 1.0 })
}

fn test(differences: &[f64]) -> Option<f64> {
    let n = differences.len();
    if n < FEWEST_BLOCKS {
        return None;
    }
    let mean = differences.iter().sum::<f64>() / n as f64;
    let covariance = |lag: usize| -> f64 {
        let pairs = differences.iter().zip(&differences[lag..]);
        pairs.map(|(x, y)| (x - mean) * (y - mean)).sum::<f64>() / n as f64
    };
    let own = covariance(0);
    let longest = (4.0 * (n as f64 / 100.0).powf(2.0 / 9.0)).floor() as usize;
    let between: f64 =
        (1..=longest).map(|lag| 2.0 * (1.0 - lag as f64 / (longest + 1) as f64) * covariance(lag)).sum();
    // Blocks that alternate would make the mean look surer than independent ones; that is not believed.
    let variance = (own + between).max(own) / (n - 1) as f64;
    if variance <= 0.0 {
        return (mean != 0.0).then_some(0.0);
    }
    Some(two_sided(mean / variance.sqrt(), (n - 1) as f64))
}

/// Which of several tests hold at `level` together (Holm 1979); tests without a probability do not.
pub fn holm(probabilities: &[Option<f64>], level: f64) -> Vec<bool> {
    let mut order: Vec<usize> = (0..probabilities.len()).filter(|k| probabilities[*k].is_some()).collect();
    order.sort_by(|a, b| {
        let p = |k: usize| probabilities[k].unwrap_or(1.0);
        p(*a).total_cmp(&p(*b))
    });
    let mut holds = vec![false; probabilities.len()];
    let count = order.len();
    for (rank, k) in order.into_iter().enumerate() {
        if probabilities[k].is_none_or(|p| p > level / (count - rank) as f64) {
            break;
        }
        holds[k] = true;
    }
    holds
}

#[cfg(test)]
mod tests {
    use aurt_simulation::Random;

    use super::*;

    fn errors(squared: &[f64]) -> JointErrors {
        let mut errors = JointErrors::default();
        for (block, value) in squared.iter().enumerate() {
            errors.add(block, value.sqrt(), 0.0);
        }
        errors
    }

    /// Independent numbers between 0 and 1, the same every time.
    fn uniform(seed: u64, n: usize) -> Vec<f64> {
        let mut random = Random::new(seed);
        (0..n).map(|_| random.unit()).collect()
    }

    #[test]
    fn noise_is_called_a_difference_as_rarely_as_the_level_says() {
        let (mut rejected, trials) = (0, 2000);
        for seed in 1..=trials {
            let (a, b) = (uniform(seed, 50), uniform(seed + 100_000, 50));
            rejected += usize::from(paired(&errors(&a), &errors(&b)).unwrap() < 0.05);
        }
        let share = rejected as f64 / trials as f64;
        assert!((0.02..0.08).contains(&share), "{share}");
    }

    #[test]
    fn a_difference_that_repeats_is_found_below_much_larger_common_variation() {
        let a: Vec<f64> = uniform(3, 60).iter().map(|c| 0.1 + 100.0 * c).collect();
        let b: Vec<f64> = a.iter().zip(uniform(4, 60)).map(|(a, s)| a * (1.02 + 0.06 * s)).collect();
        assert!(paired(&errors(&a), &errors(&b)).unwrap() < 1e-6);
        assert_eq!(paired(&errors(&a), &errors(&a)), None);
    }

    #[test]
    fn a_few_blocks_do_not_hide_what_all_the_others_say_and_do_not_decide_alone() {
        let good = vec![1.0; 30];
        let mut bad: Vec<f64> = uniform(5, 30).iter().map(|u| 1.5 + u).collect();
        bad[7] = 1e4;
        assert!(paired(&errors(&bad), &errors(&good)).unwrap() < 0.01);
        // Better in every block but one that outweighs them all: no verdict.
        let mut odd: Vec<f64> = uniform(6, 30).iter().map(|u| 0.5 + 0.2 * u).collect();
        odd[7] = 1e4;
        assert_eq!(paired(&errors(&odd), &errors(&good)), Some(1.0));
    }

    #[test]
    fn joints_are_taken_together() {
        let base = [errors(&uniform(7, 40)), errors(&uniform(8, 40))];
        let worse = [7, 8].map(|seed| {
            let values: Vec<f64> =
                uniform(seed, 40).iter().zip(uniform(seed + 9, 40)).map(|(v, s)| v * (1.0 + s)).collect();
            errors(&values)
        });
        assert!(paired_overall(&worse, &base).unwrap() < 1e-6);
        assert_eq!(paired_overall(&worse[..1], &base), None);
    }

    #[test]
    fn drifting_differences_are_not_taken_for_independent() {
        // Runs of ten blocks that differ alike: 60 blocks hold six independent ones.
        let steps = [0.9_f64, 1.4, 1.6, 0.8, 1.5, 1.3];
        let runs: Vec<f64> = (0..60).map(|k| steps[k / 10]).collect();
        let shuffled: Vec<f64> = (0..60).map(|k| steps[k % 6]).collect();
        let flat = errors(&[1.0; 60]);
        let (drifting, scattered) =
            (paired(&errors(&runs), &flat).unwrap(), paired(&errors(&shuffled), &flat).unwrap());
        assert!(drifting > 10.0 * scattered, "{drifting} {scattered}");
    }

    #[test]
    fn other_stretches_of_time_and_too_few_blocks_are_not_compared() {
        assert_eq!(paired(&errors(&[1.0; 20]), &errors(&[2.0; 21])), None);
        assert_eq!(paired(&errors(&[1.0; 5]), &errors(&[2.0; 5])), None);
        assert_eq!(paired(&errors(&[1.0; 20]), &errors(&[2.0; 20])), Some(0.0));
    }

    #[test]
    fn many_tests_share_the_level() {
        let p = [Some(0.001), Some(0.04), None, Some(0.02), Some(0.9)];
        assert_eq!(holm(&p, 0.05), [true, false, false, false, false]);
        assert_eq!(holm(&[Some(0.02), Some(0.03)], 0.05), [true, true]);
    }
}
