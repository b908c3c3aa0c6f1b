//! How far coefficients may be off: memory and misfit of the residual, and not white noise alone.

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::evidence::linear::{Cholesky, solve_signed};
use crate::evidence::problem::Problem;
use crate::hypotheses::group::Switch;

/// Fits of everything but one block of time, block by block.
#[derive(Debug)]
pub(crate) struct Resampled {
    coefficients: Vec<Vec<f64>>,
}

impl Resampled {
    /// Fits switches to all blocks but one, for every block that has rows.
    pub(crate) fn new(problem: &Problem, switches: &[Switch], weights: &[f64]) -> Self {
        let nonnegative: Vec<bool> = switches.iter().map(|s| s.nonnegative).collect();
        let coefficients = (0..problem.blocks())
            .filter_map(|block| {
                let (rest, left_out) = problem.fold(block);
                let rows: f64 = left_out.iter().flatten().map(|m| m.rows).sum();
                (rows > 0.0).then(|| {
                    let matrix = problem.cross(rest, switches, switches, weights);
                    solve_signed(&matrix, &problem.right(rest, switches, weights), &nonnegative)
                })
            })
            .collect();
        Self { coefficients }
    }

    /// Jackknife standard deviation of a function of the coefficients: √((B − 1)/B Σ_b (f_b − f̄)²) over the B fits.
    pub(crate) fn std(&self, of: impl Fn(&[f64]) -> f64) -> f64 {
        let values: Vec<f64> = self.coefficients.iter().map(|c| of(c)).collect();
        let count = values.len() as f64;
        if values.len() < 2 {
            return f64::INFINITY;
        }
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        ((count - 1.0) / count * squares).sqrt()
    }

    /// Coefficients that differ from a fit as each jackknife fit does from the mean of all, and their share (B − 1)/B in a variance.
    pub(crate) fn deviating(&self, fit: &[f64]) -> Vec<(Vec<f64>, f64)> {
        let count = self.coefficients.len() as f64;
        let mean = |k: usize| self.coefficients.iter().map(|c| c[k]).sum::<f64>() / count;
        let means: Vec<f64> = (0..fit.len()).map(mean).collect();
        let around = |c: &Vec<f64>| fit.iter().zip(c).zip(&means).map(|((f, c), m)| f + c - m).collect();
        self.coefficients.iter().map(|c| (around(c), (count - 1.0) / count)).collect()
    }
}

/// √(d F): what the length of d coefficients in units of their deviations, which are known with some degrees of freedom, exceeds with a
/// probability where nothing is.
pub(crate) fn beyond_chance(d: f64, freedom: f64, probability: f64) -> f64 {
    FisherSnedecor::new(d, freedom).map_or(f64::INFINITY, |f| (d * f.inverse_cdf(1.0 - probability)).sqrt())
}

/// By how much variances are larger than those of independent rows if a share of the rows is independent.
pub(crate) fn memory(independent_share: f64) -> f64 {
    independent_share.max(0.01).recip()
}

/// The covariance A P Aᵀ that switches have beside a given model, column-major; `None` where that is exact.
pub(crate) fn beside_given(problem: &Problem, switches: &[Switch], weights: &[f64]) -> Option<Vec<f64>> {
    let given = problem.given.as_ref()?;
    let (n, m) = (given.n, switches.len());
    let own: Vec<Switch> =
        (0..n).map(|column| Switch { column, target_only: false, nonnegative: false }).collect();
    let cholesky = Cholesky::new(&problem.cross(problem.total(), switches, switches, weights), m);
    let products = problem.cross(problem.total(), switches, &own, weights);
    // A, a column of it for each own coefficient.
    let taken: Vec<f64> = products.chunks_exact(m.max(1)).flat_map(|c| cholesky.solve(c)).collect();
    let mut spread = vec![0.0; m * n];
    for (column, covariance) in spread.chunks_exact_mut(m.max(1)).zip(given.matrix.chunks_exact(n)) {
        for (of_own, p) in taken.chunks_exact(m.max(1)).zip(covariance).filter(|(_, p)| **p != 0.0) {
            column.iter_mut().zip(of_own).for_each(|(s, a)| *s += p * a);
        }
    }
    let mut covariance = vec![0.0; m * m];
    for (of_own, spread) in taken.chunks_exact(m.max(1)).zip(spread.chunks_exact(m.max(1))) {
        for (b, value) in spread.iter().enumerate() {
            of_own.iter().zip(&mut covariance[b * m..(b + 1) * m]).for_each(|(a, c)| *c += a * value);
        }
    }
    Some(covariance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_jackknife_of_a_mean_is_its_standard_error() {
        // Means of 1, 2, 3, 6 without one of them.
        let values = [1.0, 2.0, 3.0, 6.0];
        let sum: f64 = values.iter().sum();
        let resampled = Resampled { coefficients: values.iter().map(|v| vec![(sum - v) / 3.0]).collect() };
        let variance = values.iter().map(|v| (v - 3.0_f64).powi(2)).sum::<f64>() / 3.0;
        assert!((resampled.std(|c| c[0]) - (variance / 4.0).sqrt()).abs() < 1e-12);
        let alone = Resampled { coefficients: vec![vec![1.0]] };
        assert!(alone.std(|c| c[0]).is_infinite());
    }
}
