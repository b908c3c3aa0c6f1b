//! Deviations of estimated numbers whose errors last.
//!
//! # Equation
//! Errors of a closed loop last for seconds (stick–slip, poses, what the model lacks), so that samples are no independent
//! witnesses; stretches of time are. How long is not known: stretches are joined two by two as long as there are enough of
//! them, and of each number the largest deviation is kept. Without stretch c the estimate moves by δ_c = (H − H_c)⁻¹ g_c, with
//! its part g_c of the gradient and H_c of the curvature H, what is known beforehand included in H. The covariance is that of
//! the jackknife,
//!
//! (G − 1)/G Σ_c (δ_c − δ̄)(δ_c − δ̄)ᵀ + H⁻¹ P H⁻¹,
//!
//! with P what is known beforehand. Unlike H⁻¹ Σ g_c g_cᵀ H⁻¹ it is not too small where few stretches determine many numbers:
//! each stretch is judged by an estimate that it had no part in.
//!
//! # Source
//! Bell, McCaffrey (2002), *Bias reduction in standard errors for linear regression with multi-stage samples*, Survey
//! Methodology 28 (CR3); Cameron, Miller (2015), *A practitioner's guide to cluster-robust inference*, J. Human Resources 50.

use nalgebra::{DMatrix, DVector};

/// Stretches of all recordings together: of fewer, each is shorter; of more, longer.
const STRETCHES: [f64; 2] = [12.0, 200.0];

/// What a stretch of time contributes to an estimate.
#[derive(Debug, Clone)]
pub(crate) struct Stretch {
    /// Σ w Jᵀ r/σ².
    pub gradient: DVector<f64>,
    /// Σ w JᵀJ/σ².
    pub information: DMatrix<f64>,
}

/// The length of stretches in s, of recordings that last so long together: `block_s`, as far as there are enough of them.
pub(crate) fn stretch_s(lasts_s: f64, block_s: f64) -> f64 {
    block_s.min(lasts_s / STRETCHES[0]).max(lasts_s / STRETCHES[1])
}

/// The covariance in units of the numbers' deviations, without those that are `fixed`; `curvature` has unit rows for these.
/// A number's deviation is the largest that stretches of the given length, twice that and so on give.
pub(crate) fn covariance(
    curvature: &DMatrix<f64>,
    stretches: &[Stretch],
    fixed: &[bool],
) -> Option<DMatrix<f64>> {
    let mut covariance = jackknife(curvature, stretches, fixed)?;
    let shortest = covariance.diagonal();
    let mut largest = shortest.clone();
    let mut longer = stretches.to_vec();
    while (longer.len() / 2) as f64 >= STRETCHES[0] {
        longer = longer.chunks(2).map(together).collect();
        let diagonal = jackknife(curvature, &longer, fixed)?.diagonal();
        largest.zip_apply(&diagonal, |most, variance| *most = most.max(variance));
    }
    let factor = largest.zip_map(&shortest, |most, own| if own > 0.0 { (most / own).sqrt() } else { 1.0 });
    covariance.component_mul_assign(&(&factor * factor.transpose()));
    Some(covariance)
}

fn together(stretches: &[Stretch]) -> Stretch {
    let (first, others) = (stretches[0].clone(), &stretches[1..]);
    others.iter().fold(first, |sum, other| Stretch {
        gradient: sum.gradient + &other.gradient,
        information: sum.information + &other.information,
    })
}

fn jackknife(curvature: &DMatrix<f64>, stretches: &[Stretch], fixed: &[bool]) -> Option<DMatrix<f64>> {
    let n = fixed.len();
    let is_free = |k: usize| !fixed[k];
    let inverse = curvature.clone().cholesky()?.inverse();
    let mut moves = Vec::with_capacity(stretches.len());
    for stretch in stretches {
        let own = |r: usize, c: usize| {
            if is_free(r) && is_free(c) { stretch.information[(r, c)] } else { 0.0 }
        };
        let gradient = DVector::from_fn(n, |k, _| if is_free(k) { stretch.gradient[k] } else { 0.0 });
        let others = curvature - DMatrix::from_fn(n, n, own);
        moves.push(others.cholesky()?.solve(&gradient));
    }
    let count = moves.len() as f64;
    let mean = moves.iter().fold(DVector::zeros(n), |sum, m| sum + m) / count.max(1.0);
    let known = DMatrix::from_diagonal(&DVector::from_fn(n, |k, _| if is_free(k) { 1.0 } else { 0.0 }));
    let mut covariance = &inverse * known * &inverse;
    for moved in moves {
        let from_mean = moved - &mean;
        covariance += &from_mean * from_mean.transpose() * ((count - 1.0) / count);
    }
    Some(covariance)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors that keep their sign over four stretches: the variance is four times that of independent ones.
    #[test]
    fn errors_that_last_longer_than_stretches_count_once() {
        let errors: Vec<f64> = (0..48).map(|k| if k / 4 % 2 == 0 { 1.0 } else { -1.0 }).collect();
        let stretch = |error: &f64| Stretch {
            gradient: DVector::from_element(1, 1e6 * error),
            information: DMatrix::from_element(1, 1, 1e6),
        };
        let stretches: Vec<Stretch> = errors.iter().map(stretch).collect();
        let curvature = DMatrix::from_element(1, 1, 48e6);
        let short = jackknife(&curvature, &stretches, &[false]).unwrap()[(0, 0)];
        let found = covariance(&curvature, &stretches, &[false]).unwrap()[(0, 0)];
        assert!((found / short / 4.0 - 1.0).abs() < 0.1, "{found} {short}");
    }

    /// A mean of 6 stretches with errors that last as long as they do: the deviation is that of 6 samples, not of 600.
    #[test]
    fn errors_that_last_count_once_a_stretch() {
        let errors = [0.9, -1.2, 0.4, 1.1, -0.6, -0.6];
        let stretch = |error: f64| Stretch {
            gradient: DVector::from_element(1, 100.0 * error),
            information: DMatrix::from_element(1, 1, 100.0),
        };
        let stretches = errors.map(stretch);
        let curvature = DMatrix::from_element(1, 1, 600.0 + 1e-9);
        let mean = errors.iter().sum::<f64>() / 6.0;
        let expected = errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / (6.0 * 5.0);
        let found = covariance(&curvature, &stretches, &[false]).unwrap()[(0, 0)];
        assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
        assert_eq!(covariance(&DMatrix::identity(1, 1), &[], &[true]).unwrap()[(0, 0)], 0.0);
        assert_eq!([stretch_s(6.0, 2.0), stretch_s(60.0, 2.0), stretch_s(600.0, 2.0)], [0.5, 2.0, 3.0]);
    }
}
