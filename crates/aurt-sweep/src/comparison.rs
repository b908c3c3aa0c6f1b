//! Whether two points differ by more than noise explains.

use crate::{result::JointErrors, student::two_sided};

/// Fewer blocks than this say nothing.
const FEWEST_BLOCKS: usize = 8;

/// Probability that block-by-block differences like these arise where the points do no differently on average; nothing
/// where the blocks are too few, are not the same stretches of time, or do not differ at all.
///
/// The difference of the squared errors, summed over a block of time, is one number a block; the two points are thus
/// compared on the same motion. Its mean over the blocks is tested against zero by Student's t. Neighbouring blocks
/// are not independent: the variance of the mean takes in their autocovariance up to a lag of 4 (n/100)^(2/9), with
/// triangular weights (Newey and West 1987).
#[must_use]
pub fn paired(a: &JointErrors, b: &JointErrors) -> Option<f64> {
    if a.block_rows != b.block_rows {
        return None;
    }
    let used = a.block_rows.iter().zip(a.block_squared_error.iter().zip(&b.block_squared_error));
    let differences: Vec<f64> = used.filter(|(rows, _)| **rows > 0).map(|(_, (a, b))| a - b).collect();
    test(&differences)
}

/// [`paired`] over all joints together, each joint's errors in units of its mean squared error in `unit`.
#[must_use]
pub fn paired_overall(a: &[JointErrors], b: &[JointErrors], unit: &[f64]) -> Option<f64> {
    let blocks = a.first()?.block_rows.len();
    let mut differences = vec![0.0; blocks];
    for ((a, b), unit) in a.iter().zip(b).zip(unit).filter(|(_, unit)| **unit > 0.0) {
        // Trailing blocks without a row of this joint are not written down.
        if a.block_rows != b.block_rows {
            return None;
        }
        differences.resize(differences.len().max(a.block_rows.len()), 0.0);
        for (sum, (a, b)) in
            differences.iter_mut().zip(a.block_squared_error.iter().zip(&b.block_squared_error))
        {
            *sum += (a - b) / unit;
        }
    }
    test(&differences)
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
#[must_use]
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
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        (0..n)
            .map(|_| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 11) as f64 / (1u64 << 53) as f64
            })
            .collect()
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
    fn a_difference_that_repeats_is_found_below_much_larger_common_noise() {
        let common = uniform(3, 60);
        let small = uniform(4, 60);
        let a: Vec<f64> = common.iter().map(|c| 100.0 * c).collect();
        let b: Vec<f64> = a.iter().zip(&small).map(|(a, s)| a + 0.05 + 0.1 * s).collect();
        assert!(paired(&errors(&a), &errors(&b)).unwrap() < 1e-6);
        assert_eq!(paired(&errors(&a), &errors(&a)), None);
    }

    #[test]
    fn drifting_differences_are_not_taken_for_independent() {
        // Runs of ten blocks that differ alike: 60 blocks hold six independent ones.
        let steps = uniform(11, 6);
        let runs: Vec<f64> = (0..60).map(|k| steps[k / 10]).collect();
        let flat = vec![0.5; 60];
        let once: Vec<f64> = uniform(12, 60);
        let wide = paired(&errors(&runs), &errors(&flat)).unwrap();
        let t = |x: &[f64]| {
            let mean = x.iter().map(|v| v - 0.5).sum::<f64>() / 60.0;
            let variance = x.iter().map(|v| (v - 0.5 - mean).powi(2)).sum::<f64>() / 60.0;
            two_sided(mean / (variance / 59.0).sqrt(), 59.0)
        };
        assert!(wide > t(&runs));
        assert!(paired(&errors(&once), &errors(&flat)).unwrap() >= t(&once) - 1e-12);
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
