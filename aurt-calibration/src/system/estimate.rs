use super::factor::JointFactor;
use super::triangles::{Solution, System};
use crate::{CalibrationError, Estimator};

/// Mean squared residual of an unweighted fit.
pub(crate) fn variance(system: &System, solution: &Solution) -> f64 {
    let parameters = solution.excited.iter().filter(|e| **e).count();
    let rows = system.factors().iter().map(JointFactor::rows).sum::<usize>();
    solution.residual_sum.iter().sum::<f64>() / rows.saturating_sub(parameters).max(1) as f64
}

/// By how much the variance of the coefficients, in the mean, exceeds that of independent rows.
pub(crate) fn noise_scale(system: &System, estimate: &Estimate) -> Result<f64, CalibrationError> {
    let plain = system.solve(&weights(&estimate.sigma), |_| true)?.covariance;
    let n = estimate.solution.coefficients.len();
    let ratios: Vec<f64> = (0..n)
        .map(|k| estimate.solution.covariance[k * n + k] / plain[k * n + k])
        .filter(|r| r.is_finite() && *r > 0.0)
        .collect();
    Ok(if ratios.is_empty() { 1.0 } else { ratios.iter().sum::<f64>() / ratios.len() as f64 })
}

/// A solution with the σ_j that weighted it.
#[derive(Debug, Clone)]
pub struct Estimate {
    /// The coefficients and their covariance; for WLS the covariance of equation (13).
    pub solution: Solution,
    /// σ_j of equation (14), from the global OLS.
    pub sigma: Vec<f64>,
}

/// OLS, σ_j, and, if asked for, WLS from accumulated factors.
///
/// # Errors
/// [`CalibrationError::TooFewSamples`] unless every joint has more rows than there are parameters.
pub fn estimate(system: &System, estimator: Estimator) -> Result<Estimate, CalibrationError> {
    let (ols, excited) = system.solve_coefficients(&ones(system))?;
    let parameters = excited.iter().filter(|e| **e).count();
    let sigma = sigma(system, &ols, parameters)?;
    let weights = if estimator.is_weighted() { weights(&sigma) } else { ones(system) };
    let mut solution = system.solve(&weights, |_| true)?;
    if estimator == Estimator::Ols {
        let variance = variance(system, &solution);
        solution.covariance.iter_mut().for_each(|c| *c *= variance);
    }
    Ok(Estimate { solution, sigma })
}

/// The coefficients of [`estimate`] alone.
pub(crate) fn estimate_coefficients(
    system: &System,
    estimator: Estimator,
) -> Result<Vec<f64>, CalibrationError> {
    let (ols, excited) = system.solve_coefficients(&ones(system))?;
    let sigma = sigma(system, &ols, excited.iter().filter(|e| **e).count())?;
    if estimator.is_weighted() { Ok(system.solve_coefficients(&weights(&sigma))?.0) } else { Ok(ols) }
}

pub(crate) fn ones(system: &System) -> Vec<f64> {
    vec![1.0; system.factors().len()]
}

/// σ_j of equation (14) from the global OLS.
fn sigma(system: &System, ols: &[f64], parameters: usize) -> Result<Vec<f64>, CalibrationError> {
    let rows = system.factors().iter().map(JointFactor::rows);
    rows.zip(system.residual_sum(ols))
        .map(|(rows, sum)| {
            if rows <= parameters {
                return Err(CalibrationError::TooFewSamples { rows, parameters });
            }
            Ok((sum / (rows - parameters) as f64).sqrt())
        })
        .collect()
}

/// 1/σ_j. A joint that is met exactly would get an infinite weight; the largest residual sets the scale.
pub(crate) fn weights(sigma: &[f64]) -> Vec<f64> {
    let floor = sigma.iter().fold(0.0_f64, |a, b| a.max(*b)) * 1e-12 + f64::MIN_POSITIVE.sqrt();
    sigma.iter().map(|s| 1.0 / s.max(floor)).collect()
}
