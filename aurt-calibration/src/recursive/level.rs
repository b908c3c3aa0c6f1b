use crate::system::weights;
use crate::{CalibrationError, JointFactor, Solution, System};

/// Coefficients that a joint's rows of a window determine, about.
const FITTED: usize = 3;

/// What some rows say of the drift, where their noise is not that of the calibration.
///
/// On some motions, as those near standstill, the model fails by several times its residual in calibration, and a window's formal
/// deviation says nothing. Its own residual tells: with r_j² the residual variance of joint j's rows over σ_j², the level of a window is the
/// median of r_j² over the joints, at least 1. The median, since a change of one joint may raise this joint's residual, too.
#[derive(Debug, Clone)]
pub struct DriftEstimate {
    /// Weighted least squares with weights 1/σ_j; the covariance is that of independent rows, times the level.
    pub solution: Solution,
    /// The rows divided by the root of the level, to be merged with those of other windows.
    pub rows: System,
}

impl DriftEstimate {
    /// The drift that some rows show.
    ///
    /// # Errors
    /// [`CalibrationError::NotFinite`].
    pub fn of(rows: &System, sigma: &[f64]) -> Result<Self, CalibrationError> {
        let mut solution = rows.solve(&weights(sigma), |_| true)?;
        let mut ratios = row_variance_ratios(rows, &solution.coefficients, sigma);
        ratios.sort_unstable_by(f64::total_cmp);
        let level = ratios.get(ratios.len().saturating_sub(1) / 2).copied().unwrap_or(1.0);
        solution.covariance.iter_mut().for_each(|c| *c *= level);
        Ok(Self { solution, rows: scaled(rows, &vec![level; ratios.len()]) })
    }
}

/// By how much each parameter's variance exceeds that of rows with the deviations σ_j, where joints have residuals of their own: the
/// diagonal of A⁻¹ (Σ_j r_j² A_j) A⁻¹ over that of A⁻¹, with A_j the information of joint j's rows.
///
/// A change that the drift parameters do not describe in full raises the residual of its joint: it is no less a change, but how large, is
/// less sure.
pub fn own_residuals(rows: &System, solution: &Solution, sigma: &[f64]) -> Vec<f64> {
    let n = solution.coefficients.len();
    let ratios = row_variance_ratios(rows, &solution.coefficients, sigma);
    let mut variances = vec![0.0; n];
    for ((factor, ratio), sigma) in rows.factors().iter().zip(ratios).zip(sigma) {
        let (triangle, columns) = (factor.triangle(), factor.columns());
        let size = columns.len() + 1;
        for (k, variance) in variances.iter_mut().enumerate() {
            for row in 0..columns.len() {
                let moved: f64 = columns
                    .iter()
                    .enumerate()
                    .map(|(c, column)| triangle[c * size + row] * solution.covariance[*column * n + k])
                    .sum();
                *variance += ratio * (moved / sigma).powi(2);
            }
        }
    }
    let plain = |k: usize| solution.covariance[k * n + k];
    (0..n).map(|k| if plain(k) > 0.0 { (variances[k] / plain(k)).max(1.0) } else { 1.0 }).collect()
}

/// Residual variances of rows over σ_j² of each joint, at least 1.
pub(super) fn row_variance_ratios(rows: &System, coefficients: &[f64], sigma: &[f64]) -> Vec<f64> {
    let residuals = rows.residual_sum(coefficients).into_iter().zip(rows.factors()).zip(sigma);
    let ratio = |((sum, factor), sigma): ((f64, &JointFactor), &f64)| {
        let free = factor.rows().saturating_sub(FITTED).max(1) as f64;
        let ratio = sum / (free * sigma * sigma);
        if ratio.is_finite() { ratio.max(1.0) } else { 1.0 }
    };
    residuals.map(ratio).collect()
}

/// Rows divided by the roots of some factors, one for each joint.
pub(super) fn scaled(rows: &System, ratios: &[f64]) -> System {
    let factors = rows.factors().iter().zip(ratios).map(|(factor, ratio)| {
        let triangle = factor.triangle().iter().map(|r| r / ratio.sqrt()).collect();
        JointFactor::from_triangle(factor.columns().to_vec(), triangle, factor.rows())
    });
    System::new(rows.coefficients(), factors.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joint(slope: f64, scatter: f64) -> JointFactor {
        let x: Vec<f64> = (1..=403).map(|i| f64::from(i) / 403.0).collect();
        let y: Vec<f64> =
            x.iter().enumerate().map(|(i, x)| slope * x + scatter * (i % 2 * 2) as f64 - scatter).collect();
        let mut factor = JointFactor::new(vec![0]);
        factor.push(|_| &x, &y, |_| true);
        factor
    }

    #[test]
    fn the_residual_of_most_joints_widens_and_that_of_one_does_not() {
        let of = |scatters: [f64; 3]| {
            let rows = System::new(1, scatters.map(|s| joint(2.0, s)).to_vec());
            DriftEstimate::of(&rows, &[0.1; 3]).unwrap()
        };
        let (quiet, one, all) = (of([0.1; 3]), of([0.1, 0.5, 0.1]), of([0.5; 3]));
        let ratio = |a: &DriftEstimate| a.solution.covariance[0] / quiet.solution.covariance[0];
        assert!((ratio(&one) - 1.0).abs() < 0.02, "{}", ratio(&one));
        assert!((ratio(&all) / 25.0 - 1.0).abs() < 0.02, "{}", ratio(&all));
        // What is merged says as little.
        let again = all.rows.solve(&[10.0; 3], |_| true).unwrap();
        assert!((again.covariance[0] / all.solution.covariance[0] - 1.0).abs() < 1e-9);
        assert!((again.coefficients[0] - all.solution.coefficients[0]).abs() < 1e-12);
    }

    /// Where each joint determines a coefficient of its own, its variance is that of its own residual.
    #[test]
    fn intervals_count_with_the_residual_of_each_joint() {
        let mut factors: Vec<JointFactor> = Vec::new();
        for (j, scatter) in [0.1, 0.5, 0.1].into_iter().enumerate() {
            let one = joint(1.0, scatter);
            factors.push(JointFactor::from_triangle(vec![j], one.triangle(), one.rows()));
        }
        let rows = System::new(3, factors);
        let estimate = DriftEstimate::of(&rows, &[0.1; 3]).unwrap();
        let wider = own_residuals(&rows, &estimate.solution, &[0.1; 3]);
        for (found, expected) in wider.iter().zip([1.0, 25.0, 1.0]) {
            assert!((found / expected - 1.0).abs() < 0.02, "{wider:?}");
        }
    }
}
