//! Weights by row: impacts, knocks and other rows that are none of the model's.

use aurt_recording::median;
use aurt_traits::{RobotModel, RobotNames};
use nalgebra::DMatrix;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::deviations::{product, root_of_gram};
use crate::rows::{JointRows, Observed, Piece};
use crate::system::weights;
use crate::{CalibrationError, Estimate, JointFactor, System};

/// Median of |e| over the deviation of a normal e.
const MEDIAN_OF_NORMAL: f64 = 0.674_489_750_196;
/// Where Huber's and Tukey's weights begin to fall: 95 % efficient on normal residuals.
const HUBER: f64 = 1.345;
const TUKEY: f64 = 4.685;
/// Rounds of either loss at the most, and the change of a coefficient, in standard deviations, that ends them.
const ROUNDS: usize = 40;
const SETTLED: f64 = 1e-3;
/// No mean of ψ′ is taken for smaller than this.
const LEAST_SLOPE: f64 = 0.1;
/// Above this share of rows without weight it is rather the model that misfits.
const MANY: f64 = 0.05;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Loss {
    /// Quadratic up to 1.345 σ, linear beyond (Huber 1964); convex.
    Huber,
    /// The bisquare, constant beyond 4.685 σ (Beaton and Tukey 1974).
    Tukey,
}

impl Loss {
    /// w(u) = ψ(u)/u of a residual over σ.
    pub(crate) fn weight(self, u: f64) -> f64 {
        match self {
            Self::Huber => (HUBER / u.abs()).min(1.0),
            Self::Tukey => (1.0 - (u / TUKEY).powi(2)).max(0.0).powi(2),
        }
    }
}

/// What weights by row did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RobustReport {
    /// Share of each joint's rows without weight.
    pub rejected: Vec<f64>,
    /// Mean of ψ′ over each joint's rows, at least 0.1; 0.758 for normal residuals.
    pub slope: Vec<f64>,
    /// Mean of ψ² over each joint's rows, in σ_j²; 0.604 for normal residuals.
    pub power: Vec<f64>,
    /// Weighted least squares that it took.
    pub rounds: usize,
}

impl RobustReport {
    /// Where rejected rows are too many to be impacts.
    pub(crate) fn warnings<'a>(&'a self, names: RobotNames<'a>) -> impl Iterator<Item = String> + 'a {
        let many = self.rejected.iter().enumerate().filter(|(_, share)| **share > MANY);
        many.map(move |(joint, share)| {
            format!(
                "{:.0} % of the rows of {} have no weight in the fit: so many rows indicate a missing effect rather \
                 than impacts; compare with `estimator = \"wls\"`",
                100.0 * share,
                names.joint(joint)
            )
        })
    }
}

/// An estimate with weights by row.
pub(crate) struct Reweighted {
    pub coefficients: Vec<f64>,
    /// Of the rows that count: the normalised median of |e|.
    pub sigma: Vec<f64>,
    /// (Σ_j E ψ′_j σ_j⁻² W_jᵀW_j)⁻¹, column-major.
    pub bread: Vec<f64>,
    /// The covariance where rows are independent, column-major.
    pub covariance: Vec<f64>,
    pub report: RobustReport,
}

/// Iteratively reweighted least squares (Holland and Welsch 1977) from an estimate on: each row's weight is w(e/σ_j)/σ_j², with
/// σ_j the median of |e| over 0.6745. Huber's loss, which has one minimum, leads to the neighbourhood of the rows that belong
/// together, and Tukey's from there to an estimate in which rows beyond 4.685 σ_j do not count at all (Yohai 1987).
pub(crate) fn reweight(
    rows: &Observed<'_>,
    system: &System,
    first: &Estimate,
) -> Result<Reweighted, CalibrationError> {
    let model = rows.model;
    let n = first.solution.coefficients.len();
    let pieces: Vec<Piece<'_>> = rows.listed().collect();
    let rows = rows.rows(&pieces, &first.solution.coefficients)?;
    let joints: Vec<Vec<&JointRows>> =
        (0..model.joints()).map(|j| rows.iter().filter_map(|r| r.get(j)).collect()).collect();

    // Steps from the first estimate, whose residuals the rows have.
    let mut step = vec![0.0; n];
    let mut sigma = first.sigma.clone();
    let mut rounds = 0;
    let deviation: Vec<f64> = (0..n).map(|k| first.solution.covariance[k * n + k].sqrt()).collect();
    for loss in [Loss::Huber, Loss::Tukey] {
        for _ in 0..ROUNDS {
            let residuals = residuals(model, &joints, &step);
            sigma = residuals.iter().zip(&sigma).map(|(e, before)| spread(e).unwrap_or(*before)).collect();
            let factors: Vec<JointFactor> = joints
                .par_iter()
                .enumerate()
                .map(|(j, pieces)| weighted(model.row_columns(j), pieces, &residuals[j], sigma[j], loss))
                .collect();
            let next = System::new(n, factors).solve_coefficients(&weights(&sigma))?.0;
            let moved =
                next.iter().zip(&step).zip(&deviation).fold(0.0_f64, |most, ((a, b), d)| {
                    if *d > 0.0 { most.max((a - b).abs() / d) } else { most }
                });
            step = next;
            rounds += 1;
            if moved < SETTLED {
                break;
            }
        }
    }
    let residuals = residuals(model, &joints, &step);
    let counted: Vec<f64> = system.factors().iter().map(|f| f.rows().max(1) as f64).collect();
    let share = |j: usize, of: &dyn Fn(f64) -> f64| {
        residuals[j].iter().filter(|e| **e != 0.0).map(|e| of(e / sigma[j])).sum::<f64>() / counted[j]
    };
    let rejected = |u: f64| if u.abs() > TUKEY { 1.0 } else { 0.0 };
    let slope = |u: f64| {
        let part = (u / TUKEY).powi(2);
        if part < 1.0 { (1.0 - part) * (1.0 - 5.0 * part) } else { 0.0 }
    };
    let power = |u: f64| (u * Loss::Tukey.weight(u)).powi(2);
    let report = RobustReport {
        rejected: (0..joints.len()).map(|j| share(j, &rejected)).collect(),
        slope: (0..joints.len()).map(|j| share(j, &slope).max(LEAST_SLOPE)).collect(),
        power: (0..joints.len()).map(|j| share(j, &power)).collect(),
        rounds,
    };
    let coefficients = first.solution.coefficients.iter().zip(&step).map(|(a, b)| a + b).collect();
    let (bread, covariance) = independent(system, first, &report, &sigma)?;
    Ok(Reweighted { coefficients, sigma, bread, covariance, report })
}

/// The bread B = (Σ_j E ψ′_j σ_j⁻² W_jᵀW_j)⁻¹ and the covariance B (Σ_j E ψ²_j σ_j⁻² W_jᵀW_j) B of independent rows, with
/// Huber's corrections for the p_j of the M_j rows that the fit took up: M/(M − p) and (1 + p/M (1 − E ψ′)/E ψ′)² (1981, section
/// 7.6). Both are column-major. What a search for shapes added to the variances of `first` is kept.
fn independent(
    system: &System,
    first: &Estimate,
    report: &RobustReport,
    sigma: &[f64],
) -> Result<(Vec<f64>, Vec<f64>), CalibrationError> {
    let n = system.coefficients();
    let weight = weights(sigma);
    let slopes: Vec<f64> = weight.iter().zip(&report.slope).map(|(w, s)| w * s.sqrt()).collect();
    let bread = system.solve(&slopes, |_| true)?.covariance;
    let inverse = DMatrix::from_column_slice(n, n, &bread);
    let mut covariance = DMatrix::zeros(n, n);
    for (j, factor) in system.factors().iter().enumerate() {
        let root = root_of_gram(factor, n);
        let pulled = product(&inverse, &root);
        let taken: f64 = root.iter().zip(pulled.iter()).map(|(r, p)| r * p).sum();
        let share = (taken * slopes[j].powi(2) / factor.rows().max(1) as f64).clamp(0.0, 0.9);
        let slope = report.slope[j].min(1.0);
        let corrected = (1.0 + share * (1.0 - slope) / slope).powi(2) / (1.0 - share);
        covariance +=
            product(&pulled, &pulled.transpose()) * (corrected * report.power[j] * weight[j].powi(2));
    }
    let plain = system.solve(&weights(&first.sigma), |_| true)?.covariance;
    let wider: Vec<f64> =
        (0..n)
            .map(|k| k * n + k)
            .map(|at| {
                if plain[at] > 0.0 {
                    (first.solution.covariance[at] / plain[at]).max(1.0).sqrt()
                } else {
                    1.0
                }
            })
            .collect();
    for c in 0..n {
        for r in 0..n {
            covariance[(r, c)] *= wider[r] * wider[c];
        }
    }
    if covariance.iter().all(|v| v.is_finite()) {
        Ok((bread, covariance.as_slice().to_vec()))
    } else {
        Err(CalibrationError::NotFinite)
    }
}

/// Each joint's residuals over all segments; rows that are not fitted are zero.
fn residuals(model: &RobotModel, joints: &[Vec<&JointRows>], step: &[f64]) -> Vec<Vec<f64>> {
    let of = |(j, pieces): (usize, &Vec<&JointRows>)| {
        let mut all = Vec::new();
        for piece in pieces {
            let start = all.len();
            all.extend_from_slice(&piece.residual);
            for (values, column) in piece.columns.iter().zip(model.row_columns(j)) {
                let part = step[*column];
                all[start..].iter_mut().zip(values).for_each(|(e, w)| *e -= part * w);
            }
        }
        all
    };
    joints.par_iter().enumerate().map(of).collect()
}

/// The normalised median of |e| over the rows that are fitted; none where all are met exactly.
fn spread(residuals: &[f64]) -> Option<f64> {
    let mut sizes: Vec<f64> = residuals.iter().map(|e| e.abs()).filter(|e| *e > 0.0).collect();
    (!sizes.is_empty()).then(|| median(&mut sizes) / MEDIAN_OF_NORMAL)
}

/// The rows with their weights, the first residuals on the right.
fn weighted(
    columns: &[usize],
    pieces: &[&JointRows],
    residuals: &[f64],
    sigma: f64,
    loss: Loss,
) -> JointFactor {
    let mut factor = JointFactor::new(columns.to_vec());
    let mut start = 0;
    for piece in pieces {
        let end = start + piece.residual.len();
        let root: Vec<f64> = residuals[start..end]
            .iter()
            .map(|e| loss.weight(e / sigma.max(f64::MIN_POSITIVE)).sqrt())
            .collect();
        let scaled = |values: &[f64]| values.iter().zip(&root).map(|(v, w)| v * w).collect::<Vec<f64>>();
        let own: Vec<Vec<f64>> = piece.columns.iter().map(|c| scaled(c)).collect();
        factor.push(|k| &own[k], &scaled(&piece.residual), |_| true);
        start = end;
    }
    factor
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_fall_as_the_laws_say() {
        assert_eq!(Loss::Huber.weight(1.0), 1.0);
        assert!((Loss::Huber.weight(-2.69) - 0.5).abs() < 1e-12);
        assert_eq!(Loss::Tukey.weight(0.0), 1.0);
        assert_eq!(Loss::Tukey.weight(-4.7), 0.0);
        assert!((Loss::Tukey.weight(TUKEY / 2.0) - 0.5625).abs() < 1e-12);
    }

    #[test]
    fn the_spread_does_not_see_a_few_large_residuals() {
        let mut residuals: Vec<f64> = (-500..=500).map(|k| f64::from(k) / 500.0).collect();
        let quiet = spread(&residuals).unwrap();
        residuals.extend([1e6; 20]);
        assert!((spread(&residuals).unwrap() / quiet - 1.0).abs() < 0.05);
        assert_eq!(spread(&[0.0]), None);
    }
}
