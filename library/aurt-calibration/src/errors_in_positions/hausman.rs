//! The test of Durbin, Wu and Hausman: do instruments find other coefficients than least squares?
//!
//! W and Z are the regressor of the measured motion and of the same motion behind a lower filter. With exact positions both
//! ζ̂ = (WᵀΩ⁻¹W)⁻¹WᵀΩ⁻¹y and ζ̂_IV = (ZᵀΩ⁻¹W)⁻¹ZᵀΩ⁻¹y are consistent, whatever the filter takes away, since noise of the
//! measurement knows of neither; noise of the positions biases ζ̂, and ζ̂_IV by the little of it that passes the lower filter.
//! They agree where Zᵀ sees nothing in the residual e of least squares,
//!
//! g = Σ_j σ_j⁻² Z_jᵀ e_j = ZᵀΩ⁻¹W (ζ̂_IV − ζ̂),  Cov g = Σ_j σ_j⁻⁴ Z̃_jᵀ Γ_j Z̃_j,  Z̃ = Z − W (WᵀΩ⁻¹W)⁻¹WᵀΩ⁻¹Z,
//!
//! with Γ_j the memory of the noise as in `deviations`, so that gᵀ (Cov g)⁺ g follows χ² (Durbin 1954; Wu 1973; Hausman 1978).
//! Z̃ nearly vanishes where positions are exact, and any trifle of the model would be significant: differences of a tenth of a
//! deviation of ζ̂ are allowed for, Cov g + 0.01 · ZᵀΩ⁻¹W Cov ζ̂ WᵀΩ⁻¹Z. Only instruments of the rigid bodies are tested, since
//! friction turns with the sign of the velocity: there noise is no small error of the regressor, and ζ̂_IV is biased too.

use aurt_traits::{LoadTorque, RobotModel};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::{
    Calibration, CalibrationError, CalibrationOptions, NamedRecording, TermScopes,
    deviations::{Autocovariance, JointRows, pieces, put_instruments, rows_of},
    student::chi_squared_above,
    wls::weights,
};

/// Below this share of the greatest variance a combination of instruments tells nothing.
const NEGLIGIBLE: f64 = 1e-8;
/// The variance of a difference that does not matter, over that of ζ̂.
const ALLOWED: f64 = 0.01;
/// The probability below which least squares is called biased.
const SIGNIFICANT: f64 = 0.05;

/// Whether least squares and instrumental variables agree.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hausman {
    /// gᵀ (Cov g)⁺ g.
    pub statistic: f64,
    /// Degrees of freedom of χ².
    pub freedom: usize,
    /// The probability of a larger statistic where positions are exact.
    pub probability: f64,
}

/// Coefficients and their covariance, column-major.
type Estimated = (Vec<f64>, Vec<f64>);

impl Hausman {
    /// Whether least squares is biased, by a test that says so of 5 % of the recordings with exact positions.
    #[must_use]
    pub fn is_biased(&self) -> bool {
        self.probability < SIGNIFICANT
    }
}

/// The test for a calibration by weighted least squares on `recordings`; `None` where no instrument differs from the regressor.
///
/// # Errors
/// What models report, and [`CalibrationError::Recording`] if a segment is too short for the filter of the instruments.
pub fn hausman(
    model: &RobotModel,
    recordings: &[&NamedRecording],
    scopes: &TermScopes,
    calibration: &Calibration,
) -> Result<Option<Hausman>, CalibrationError> {
    Tested {
        model,
        recordings,
        scopes,
        load: &calibration.load,
        options: &calibration.options,
        coefficients: &calibration.coefficients(),
        weights: &weights(&calibration.sigma),
    }
    .test()
}

/// A fit to be tested.
pub(crate) struct Tested<'a> {
    pub model: &'a RobotModel,
    pub recordings: &'a [&'a NamedRecording],
    pub scopes: &'a TermScopes,
    pub load: &'a LoadTorque,
    pub options: &'a CalibrationOptions,
    pub coefficients: &'a [f64],
    /// 1/σ_j.
    pub weights: &'a [f64],
}

/// A stretch of a joint's rows: columns of W and of Z.
struct Pair {
    plain: JointRows,
    instruments: Vec<Vec<f64>>,
    times: f64,
}

impl Tested<'_> {
    pub(crate) fn test(&self) -> Result<Option<Hausman>, CalibrationError> {
        let Self { model, load, options, weights, .. } = *self;
        let n = self.coefficients.len();
        let joints = self.pairs(load, options)?;
        let products = self.products(&joints);
        let [plain, crossed] = sum(&products, n);
        let kept: Vec<usize> = (0..n).filter(|k| plain[(*k, *k)] > 0.0).collect();
        let Some(inverse) = inverse(&plain, &kept) else { return Ok(None) };
        let taken = &inverse * &crossed;
        let tested: Vec<usize> = kept.iter().copied().filter(|k| *k < model.base().len()).collect();

        let parts: Vec<(DVector<f64>, DMatrix<f64>)> = (0..model.joints())
            .into_par_iter()
            .map(|j| {
                let columns = model.row_columns(j);
                let (mut memory, mut counted) = (Autocovariance::default(), 0.0);
                for pair in &joints[j] {
                    memory.add(&pair.plain.residual, pair.plain.counted);
                    counted += pair.plain.counted as f64;
                }
                let noise = memory.fit();
                let (mut score, mut variance) = (DVector::zeros(n), DMatrix::zeros(n, n));
                for pair in &joints[j] {
                    let coloured = |columns: &[Vec<f64>]| -> Vec<Vec<f64>> {
                        let of = |z: &Vec<f64>| {
                            let mut out = Vec::new();
                            noise.coloured(z, &mut out);
                            out
                        };
                        columns.iter().map(of).collect()
                    };
                    let (left, explained): (Vec<_>, Vec<_>) =
                        tested.iter().map(|c| pair.split(columns, *c, &taken)).unzip();
                    let (own, fitted) = (coloured(&left), coloured(&explained));
                    for (a, first) in tested.iter().enumerate() {
                        score[*first] += pair.times * dot(&left[a], &pair.plain.residual);
                        for (b, second) in tested.iter().enumerate() {
                            let sum = dot(&own[a], &own[b]) + ALLOWED * dot(&fitted[a], &fitted[b]);
                            variance[(*first, *second)] += pair.times.powi(2) * sum;
                        }
                    }
                }
                // The fit took up part of the noise.
                let weight = weights[j].powi(2);
                let share = inverse.dot(&products[j][0]) / counted.max(1.0);
                let scale = noise.innovation * weight * weight / (1.0 - share.clamp(0.0, 0.9));
                (score * weight, variance * scale)
            })
            .collect();
        let (score, variance) = parts
            .into_iter()
            .fold((DVector::zeros(n), DMatrix::zeros(n, n)), |(g, v), (a, b)| (g + a, v + b));
        Ok(statistic(&score, &variance, &tested))
    }

    /// ζ̂_IV and (ZᵀΩ⁻¹W)⁻¹, column-major.
    pub(crate) fn instrumental(&self) -> Result<Option<Estimated>, CalibrationError> {
        let n = self.coefficients.len();
        let joints = self.pairs(self.load, self.options)?;
        let [plain, crossed] = sum(&self.products(&joints), n);
        let kept: Vec<usize> = (0..n).filter(|k| plain[(*k, *k)] > 0.0).collect();
        let mut score = DVector::zeros(n);
        for (j, pairs) in joints.iter().enumerate() {
            for pair in pairs {
                for (z, c) in pair.instruments.iter().zip(self.model.row_columns(j)) {
                    score[*c] += self.weights[j].powi(2) * pair.times * dot(z, &pair.plain.residual);
                }
            }
        }
        let reduced = DMatrix::from_fn(kept.len(), kept.len(), |a, b| {
            crossed[(kept[b], kept[a])] / (plain[(kept[a], kept[a])] * plain[(kept[b], kept[b])]).sqrt()
        });
        let Some(inverse) = reduced.try_inverse() else { return Ok(None) };
        let mut bread = DMatrix::zeros(n, n);
        for (a, first) in kept.iter().enumerate() {
            for (b, second) in kept.iter().enumerate() {
                bread[(*first, *second)] =
                    inverse[(a, b)] / (plain[(*first, *first)] * plain[(*second, *second)]).sqrt();
            }
        }
        let step = &bread * score;
        let coefficients = self.coefficients.iter().zip(step.iter()).map(|(a, b)| a + b).collect();
        Ok(Some((coefficients, bread.as_slice().to_vec())))
    }

    /// σ_j⁻² W_jᵀW_j and σ_j⁻² W_jᵀZ_j of each joint.
    fn products(&self, joints: &[Vec<Pair>]) -> Vec<[DMatrix<f64>; 2]> {
        let n = self.coefficients.len();
        let of = |j: usize| {
            let columns = self.model.row_columns(j);
            let [mut plain, mut crossed] = [(); 2].map(|()| DMatrix::zeros(n, n));
            for pair in &joints[j] {
                for (a, first) in pair.plain.columns.iter().zip(columns) {
                    for (k, second) in columns.iter().enumerate() {
                        plain[(*first, *second)] += pair.times * dot(a, &pair.plain.columns[k]);
                        crossed[(*first, *second)] += pair.times * dot(a, &pair.instruments[k]);
                    }
                }
            }
            [plain, crossed].map(|m| m * self.weights[j].powi(2))
        };
        (0..joints.len()).into_par_iter().map(of).collect()
    }

    fn pairs(
        &self,
        load: &LoadTorque,
        options: &CalibrationOptions,
    ) -> Result<Vec<Vec<Pair>>, CalibrationError> {
        let mut joints: Vec<Vec<Pair>> = (0..self.model.joints()).map(|_| Vec::new()).collect();
        for piece in pieces(self.model, self.recordings, self.scopes) {
            let rows = rows_of(self.model, piece.segment, &piece.acting, load, self.coefficients, options)?;
            let mut other: Vec<JointRows> = rows
                .iter()
                .map(|r| JointRows { columns: Vec::new(), residual: r.residual.clone(), counted: r.counted })
                .collect();
            put_instruments(self.model, &piece, load, options, &mut other)?;
            for ((plain, other), into) in rows.into_iter().zip(other).zip(&mut joints) {
                into.push(Pair { plain, instruments: other.columns, times: piece.times });
            }
        }
        Ok(joints)
    }
}

impl Pair {
    /// A column of Z̃, and of what W explains of Z.
    fn split(&self, columns: &[usize], column: usize, taken: &DMatrix<f64>) -> (Vec<f64>, Vec<f64>) {
        let mut explained = vec![0.0; self.plain.residual.len()];
        for (values, k) in self.plain.columns.iter().zip(columns) {
            let factor = taken[(*k, column)];
            explained.iter_mut().zip(values).for_each(|(z, w)| *z += factor * w);
        }
        let own = columns.iter().position(|c| *c == column).map(|k| &self.instruments[k]);
        let left = explained.iter().enumerate().map(|(row, w)| own.map_or(0.0, |z| z[row]) - w).collect();
        (left, explained)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn sum(products: &[[DMatrix<f64>; 2]], n: usize) -> [DMatrix<f64>; 2] {
    [0, 1].map(|k| products.iter().fold(DMatrix::zeros(n, n), |sum, p| sum + &p[k]))
}

/// The inverse over the columns that are kept, zero elsewhere.
fn inverse(matrix: &DMatrix<f64>, kept: &[usize]) -> Option<DMatrix<f64>> {
    let scale: Vec<f64> = kept.iter().map(|k| matrix[(*k, *k)].sqrt()).collect();
    let at = |a: usize, b: usize| matrix[(kept[a], kept[b])] / (scale[a] * scale[b]);
    let inverse = DMatrix::from_fn(kept.len(), kept.len(), at).cholesky()?.inverse();
    let mut full = DMatrix::zeros(matrix.nrows(), matrix.ncols());
    for (a, first) in kept.iter().enumerate() {
        for (b, second) in kept.iter().enumerate() {
            full[(*first, *second)] = inverse[(a, b)] / (scale[a] * scale[b]);
        }
    }
    Some(full)
}

/// gᵀ V⁺ g.
fn statistic(score: &DVector<f64>, variance: &DMatrix<f64>, kept: &[usize]) -> Option<Hausman> {
    let kept: Vec<usize> = kept.iter().copied().filter(|k| variance[(*k, *k)] > 0.0).collect();
    let scale: Vec<f64> = kept.iter().map(|k| variance[(*k, *k)].sqrt()).collect();
    let at = |a: usize, b: usize| variance[(kept[a], kept[b])] / (scale[a] * scale[b]);
    let eigen = DMatrix::from_fn(kept.len(), kept.len(), at).symmetric_eigen();
    let score = DVector::from_fn(kept.len(), |a, _| score[kept[a]] / scale[a]);
    let along = eigen.eigenvectors.transpose() * score;
    let greatest = eigen.eigenvalues.max();
    let told = eigen.eigenvalues.iter().zip(along.iter()).filter(|(v, _)| **v > NEGLIGIBLE * greatest);
    let (statistic, freedom) = told.fold((0.0, 0), |(sum, count), (v, g)| (sum + g * g / v, count + 1));
    let probability = chi_squared_above(statistic, freedom as f64);
    (freedom > 0 && probability.is_finite()).then_some(Hausman { statistic, freedom, probability })
}
