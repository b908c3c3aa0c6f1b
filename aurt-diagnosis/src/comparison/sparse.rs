//! Sparse regression over all candidate columns at once.

use super::standard::{Standard, Standardised, dot};
use crate::evidence::linear::Cholesky;
use crate::investigation::Investigation;

/// How coefficients are made few.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Penalty {
    /// λ‖β‖₁.
    Absolute,
    /// Coefficients below a threshold are dropped and the rest fitted again.
    Threshold,
}

/// Strengths tried, as shares of the largest that leaves anything, one after the other.
const STEPS: usize = 16;
/// Smallest share.
const LEAST: f64 = 0.01;
/// Sweeps of coordinate descent.
const SWEEPS: usize = 200;
/// Ridge of thresholded least squares, in units of the columns' squared length.
const RIDGE: f64 = 1e-4;
/// Rounds of thresholding.
const ROUNDS: usize = 10;

/// Groups whose columns get coefficients, the largest first; the strength is the largest whose cross-validated error
/// is within one standard error of the least ("one standard error rule").
pub(super) fn select(investigation: &Investigation, penalty: Penalty) -> Vec<usize> {
    let Some(columns) = Standardised::new(investigation) else { return Vec::new() };
    let largest = columns.total.right.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
    let shares: Vec<f64> = (0..STEPS).map(|k| LEAST.powf(k as f64 / (STEPS - 1) as f64)).collect();
    let fit = |part: &Standard, share: f64| {
        // Training parts are shorter than the whole; the penalty goes with their length.
        let strength = share * largest * part.rows / columns.total.rows.max(1.0);
        match penalty {
            Penalty::Absolute => lasso(part, strength),
            Penalty::Threshold => thresholded(part, share * largest),
        }
    };
    let errors: Vec<Vec<f64>> = shares
        .iter()
        .map(|share| columns.folds.iter().map(|(train, test)| test.error(&fit(train, *share))).collect())
        .collect();
    let folds = columns.folds.len() as f64;
    let mean = |e: &[f64]| e.iter().sum::<f64>() / folds;
    let Some(best) = errors.iter().min_by(|a, b| mean(a).total_cmp(&mean(b))) else { return Vec::new() };
    let spread = best.iter().map(|e| (e - mean(best)).powi(2)).sum::<f64>() / (folds - 1.0).max(1.0);
    let most = mean(best) + (spread / folds).sqrt();
    let Some(chosen) = errors.iter().position(|e| mean(e) <= most) else { return Vec::new() };
    let beta = fit(&columns.total, shares[chosen]);
    let mut sizes: Vec<(usize, f64)> = Vec::new();
    for (group, value) in columns.groups.iter().zip(&beta).filter(|(_, b)| **b != 0.0) {
        match sizes.iter_mut().find(|(g, _)| g == group) {
            Some((_, size)) => *size += value * value,
            None => sizes.push((*group, value * value)),
        }
    }
    sizes.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    sizes.into_iter().map(|(group, _)| group).collect()
}

/// Coordinate descent (Friedman, Hastie & Tibshirani 2010).
fn lasso(part: &Standard, strength: f64) -> Vec<f64> {
    let n = part.right.len();
    let mut beta = vec![0.0; n];
    for _ in 0..SWEEPS {
        let mut moved = 0.0_f64;
        for k in 0..n {
            let own = part.gram[k * n + k];
            if own <= 0.0 {
                continue;
            }
            let gradient = part.right[k] - dot(&part.gram[k * n..(k + 1) * n], &beta) + own * beta[k];
            let next = gradient.signum() * (gradient.abs() - strength).max(0.0) / own;
            moved = moved.max((next - beta[k]).abs());
            beta[k] = next;
        }
        if moved < 1e-6 * beta.iter().fold(f64::MIN_POSITIVE, |m, b| m.max(b.abs())) {
            break;
        }
    }
    beta
}

/// Sequentially thresholded ridge regression.
fn thresholded(part: &Standard, threshold: f64) -> Vec<f64> {
    let n = part.right.len();
    let mut active: Vec<usize> = (0..n).collect();
    let mut beta = vec![0.0; n];
    for _ in 0..ROUNDS {
        let m = active.len();
        let mut matrix: Vec<f64> =
            active.iter().flat_map(|b| active.iter().map(move |a| part.gram[b * n + a])).collect();
        for k in 0..m {
            matrix[k * m + k] *= 1.0 + RIDGE;
        }
        let right: Vec<f64> = active.iter().map(|k| part.right[*k]).collect();
        let solution = Cholesky::new(&matrix, m).solve(&right);
        beta.fill(0.0);
        for (k, value) in active.iter().zip(solution) {
            beta[*k] = value;
        }
        let kept: Vec<usize> = active.iter().copied().filter(|k| beta[*k].abs() >= threshold).collect();
        if kept.len() == m {
            break;
        }
        active = kept;
    }
    beta.iter_mut().filter(|b| b.abs() < threshold).for_each(|b| *b = 0.0);
    beta
}
