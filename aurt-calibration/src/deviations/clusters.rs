//! Whether scores of clusters are as large as noise makes them.

use nalgebra::{DMatrix, DVector};

const FEWEST: usize = 4;

/// By how much the variance of each group of coefficients, given as ranges of indices, exceeds what the noise explains; at
/// least one.
///
/// `steps[r]` = A⁻¹ g_r is how far cluster r alone pulls the coefficients; they sum up to zero. A group's factor is the
/// mean over its coefficients of C/(C − 1) Σ_r step²_r / variance, the cluster sandwich over the one without clusters. The
/// mean makes it sure with few clusters, of which the sandwich of a single coefficient would say little.
pub(super) fn factors(
    steps: &[DVector<f64>],
    covariance: &DMatrix<f64>,
    groups: &[std::ops::Range<usize>],
) -> Vec<f64> {
    let count = steps.len() as f64;
    groups
        .iter()
        .map(|group| {
            if steps.len() < FEWEST {
                return 1.0;
            }
            let ratios: Vec<f64> = group
                .clone()
                .filter(|k| covariance[(*k, *k)] > 0.0)
                .map(|k| {
                    let sum: f64 = steps.iter().map(|s| s[k] * s[k]).sum();
                    count / (count - 1.0) * sum / covariance[(k, k)]
                })
                .collect();
            if ratios.is_empty() { 1.0 } else { (ratios.iter().sum::<f64>() / ratios.len() as f64).max(1.0) }
        })
        .collect()
}
