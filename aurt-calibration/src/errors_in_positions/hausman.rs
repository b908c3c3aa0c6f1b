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
//!
//! The test also rejects where the model lacks a torque, since W and Z then leave different shares of it in ζ̂ and ζ̂_IV. Noise
//! predicts size and direction of the difference: with the shift s of ζ̂ that the noise drawn once more shows ([`Shift`]) it is
//! E g = −ZᵀΩ⁻¹W s, and the draws' scatter S about s, which the noise in the recording has too, adds (1 + 1/draws) times
//! ZᵀΩ⁻¹W S WᵀΩ⁻¹Z to Cov g. If g + ZᵀΩ⁻¹W s is still significant, noise is not the only reason.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{normal::inverse_over, shift::Shift};
use crate::{
    CalibrationError,
    dense::dot,
    deviations::{Autocovariance, put_instruments},
    linear,
    rows::{JointRows, Observed},
    statistics::chi_squared_above,
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
    /// The same of what remains when the shift that the measured noise of the positions predicts is subtracted; absent
    /// where no noise was drawn, and where there is more than such a prediction holds for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beyond_noise: Option<f64>,
}

/// Coefficients and their covariance, column-major.
type Estimated = (Vec<f64>, Vec<f64>);

impl Hausman {
    /// Whether least squares is biased, by a test that says so of 5 % of the recordings with exact positions.
    #[must_use]
    pub fn is_biased(&self) -> bool {
        self.probability < SIGNIFICANT
    }

    /// Whether the measured noise of the positions cannot be the only reason for the difference: the same test, of what that
    /// noise does not predict. The model then lacks something that differs between the two filters.
    #[must_use]
    pub fn is_beyond_noise(&self) -> bool {
        self.is_biased() && self.beyond_noise.is_some_and(|probability| probability < SIGNIFICANT)
    }
}

pub(crate) struct Tested<'a> {
    pub rows: Observed<'a>,
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
    /// The test; `shift` is what noise of the positions is taken to have done to the coefficients.
    ///
    /// # Errors
    /// What models report, and [`CalibrationError::Recording`] if a segment is too short for the filter of the instruments.
    pub(crate) fn test(&self, shift: &Shift) -> Result<Option<Hausman>, CalibrationError> {
        let Self { rows: Observed { model, .. }, weights, .. } = *self;
        let n = self.coefficients.len();
        let joints = self.pairs()?;
        let products = self.products(&joints);
        let [plain, crossed] = sum(&products, n);
        let kept: Vec<usize> = (0..n).filter(|k| plain[(*k, *k)] > 0.0).collect();
        let Some(inverse) = inverse_over(&plain, &kept) else { return Ok(None) };
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
                    let coloured = |column: &[f64]| {
                        let mut out = Vec::new();
                        noise.coloured(column, &mut out);
                        out
                    };
                    let (mut own, mut fitted) = (Vec::new(), Vec::new());
                    for column in &tested {
                        let (left, explained) = pair.split(columns, *column, &taken);
                        score[*column] += pair.times * dot(&left, &pair.plain.residual);
                        own.push(coloured(&left));
                        fitted.push(coloured(&explained));
                    }
                    for (a, first) in tested.iter().enumerate() {
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
        let Some(Statistic { value, freedom, probability }) = statistic(&score, &variance, &tested) else {
            return Ok(None);
        };
        let predicted = |shift: &[f64]| crossed.tr_mul(&DVector::from_column_slice(shift));
        let draws = shift.draws().count() as f64;
        let beyond_noise = (draws > 1.0).then(|| {
            let mean = predicted(shift.coefficients());
            let mut with_noise = variance;
            for draw in shift.draws() {
                let away = predicted(draw) - &mean;
                with_noise += &away * away.transpose() * ((1.0 + 1.0 / draws) / (draws - 1.0));
            }
            statistic(&(score + mean), &with_noise, &tested).map(|rest| rest.probability)
        });
        Ok(Some(Hausman { statistic: value, freedom, probability, beyond_noise: beyond_noise.flatten() }))
    }

    /// ζ̂_IV and (ZᵀΩ⁻¹W)⁻¹, column-major.
    pub(crate) fn instrumental(&self) -> Result<Option<Estimated>, CalibrationError> {
        let n = self.coefficients.len();
        let joints = self.pairs()?;
        let [plain, crossed] = sum(&self.products(&joints), n);
        let kept: Vec<usize> = (0..n).filter(|k| plain[(*k, *k)] > 0.0).collect();
        let mut score = DVector::zeros(n);
        for (j, pairs) in joints.iter().enumerate() {
            for pair in pairs {
                for (z, c) in pair.instruments.iter().zip(self.rows.model.row_columns(j)) {
                    score[*c] += self.weights[j].powi(2) * pair.times * dot(z, &pair.plain.residual);
                }
            }
        }
        let reduced = DMatrix::from_fn(kept.len(), kept.len(), |a, b| {
            crossed[(kept[b], kept[a])] / (plain[(kept[a], kept[a])] * plain[(kept[b], kept[b])]).sqrt()
        });
        let Some(inverse) = linear::inverse(&reduced) else { return Ok(None) };
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
            let columns = self.rows.model.row_columns(j);
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

    fn pairs(&self) -> Result<Vec<Vec<Pair>>, CalibrationError> {
        let mut joints: Vec<Vec<Pair>> = (0..self.rows.model.joints()).map(|_| Vec::new()).collect();
        for piece in self.rows.pieces() {
            let rows = self.rows.rows_of(piece.segment, &piece.acting, self.coefficients)?;
            let mut other: Vec<JointRows> = rows
                .iter()
                .map(|r| JointRows { columns: Vec::new(), residual: r.residual.clone(), counted: r.counted })
                .collect();
            put_instruments(&self.rows, &piece, &mut other)?;
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

fn sum(products: &[[DMatrix<f64>; 2]], n: usize) -> [DMatrix<f64>; 2] {
    [0, 1].map(|k| products.iter().fold(DMatrix::zeros(n, n), |sum, p| sum + &p[k]))
}

/// gᵀ V⁺ g, its degrees of freedom, and the probability of a larger one.
struct Statistic {
    value: f64,
    freedom: usize,
    probability: f64,
}

fn statistic(score: &DVector<f64>, variance: &DMatrix<f64>, kept: &[usize]) -> Option<Statistic> {
    let kept: Vec<usize> = kept.iter().copied().filter(|k| variance[(*k, *k)] > 0.0).collect();
    let scale: Vec<f64> = kept.iter().map(|k| variance[(*k, *k)].sqrt()).collect();
    let at = |a: usize, b: usize| variance[(kept[a], kept[b])] / (scale[a] * scale[b]);
    let (values, vectors) = linear::symmetric_eigen(&DMatrix::from_fn(kept.len(), kept.len(), at))?;
    let along = vectors.tr_mul(&DVector::from_fn(kept.len(), |a, _| score[kept[a]] / scale[a]));
    let greatest = values.max();
    let told = values.iter().zip(along.iter()).filter(|(v, _)| **v > NEGLIGIBLE * greatest);
    let (value, freedom) = told.fold((0.0, 0), |(sum, count), (v, g)| (sum + g * g / v, count + 1));
    let probability = chi_squared_above(value, freedom as f64);
    (freedom > 0 && probability.is_finite()).then_some(Statistic { value, freedom, probability })
}
