//! Fits over all blocks of time.

use crate::evidence::gram::{Moments, dot};
use crate::evidence::linear::Cholesky;
use crate::evidence::problem::Problem;
use crate::hypotheses::group::Switch;

/// A fit over all blocks.
#[derive(Debug, Clone)]
pub struct TotalFit {
    /// Coefficients, in the order of the switches.
    pub coefficients: Vec<f64>,
    /// Their variances for unit-variance weighted rows; infinite where not excited.
    pub variance: Vec<f64>,
    /// Squared error, `[kind][joint]`.
    pub squared_errors: [Vec<f64>; 2],
}

impl Problem {
    /// Least squares over all blocks: coefficients and their covariance (unit weights mean unit variance).
    pub fn fit(&self, switches: &[Switch], weights: &[f64]) -> TotalFit {
        let n = switches.len();
        let (coefficients, squared_errors) = self.least_squares(switches, weights);
        let cholesky = Cholesky::new(&self.cross(&self.moments.total, switches, switches, weights), n);
        let variance = (0..n)
            .map(|k| {
                let mut unit = vec![0.0; n];
                unit[k] = 1.0;
                cholesky.forward(&mut unit);
                if cholesky.used()[k] { dot(&unit, &unit) } else { f64::INFINITY }
            })
            .collect();
        TotalFit { coefficients, variance, squared_errors }
    }

    /// The weight of each joint's rows: one over the variance that a fit leaves, at least the floor and the rounding error of the
    /// measurement; zero for a joint whose measurement is zero throughout.
    pub(crate) fn weights(&self, squared_errors: &[Vec<f64>; 2], floor: &[f64]) -> Vec<f64> {
        let sum = |of: &dyn Fn(usize) -> f64| of(0) + of(1);
        let weight = |j: usize| {
            let rows = self.rows(j, false).max(1.0);
            let left = sum(&|kind| squared_errors[kind][j]) / rows;
            let rounding = f64::EPSILON * sum(&|kind| self.total()[kind][j].square) / rows;
            let variance = left.max(rounding).max(floor.get(j).copied().unwrap_or(0.0));
            if variance > 0.0 { variance.recip() } else { 0.0 }
        };
        (0..self.joints()).map(weight).collect()
    }

    /// Coefficients of the least squares over all blocks, and their squared errors, `[kind][joint]`.
    pub fn least_squares(&self, switches: &[Switch], weights: &[f64]) -> (Vec<f64>, [Vec<f64>; 2]) {
        self.least_squares_of(&self.moments.total, switches, weights)
    }

    /// The same over the recordings beside the targets alone: squared errors of each joint.
    pub(crate) fn reference_errors(&self, switches: &[Switch], weights: &[f64]) -> Vec<f64> {
        let [reference, targets] = self.total();
        let none = targets.iter().map(|m| {
            let mut none = m.clone();
            none.scale(0.0);
            none
        });
        let in_all: Vec<Switch> = switches.iter().filter(|s| !s.target_only).copied().collect();
        let [errors, _] = self.least_squares_of(&[reference.clone(), none.collect()], &in_all, weights).1;
        errors
    }

    fn least_squares_of(
        &self,
        moments: &[Vec<Moments>; 2],
        switches: &[Switch],
        weights: &[f64],
    ) -> (Vec<f64>, [Vec<f64>; 2]) {
        let (ordered, free) = free_first(switches);
        let fit = self.part_fit(moments, &ordered, free, weights);
        let mut values = self.extend(moments, &fit, (&ordered, free), &[], weights).into_iter();
        let mut coefficients = vec![0.0; switches.len()];
        for signed in [false, true] {
            for (value, _) in coefficients.iter_mut().zip(switches).filter(|(_, s)| s.nonnegative == signed) {
                *value = values.next().unwrap_or(0.0);
            }
        }
        let squared_errors = self.squared_errors(moments, switches, &coefficients);
        (coefficients, squared_errors)
    }

    /// Correlation of some coefficients, `places` among the switches, in a fit over all blocks; column-major. None where one
    /// of them is not excited.
    pub(crate) fn correlation(
        &self,
        switches: &[Switch],
        weights: &[f64],
        places: &[usize],
    ) -> Option<Vec<f64>> {
        let n = switches.len();
        let cholesky = Cholesky::new(&self.cross(self.total(), switches, switches, weights), n);
        let columns: Vec<Vec<f64>> = places
            .iter()
            .map(|k| {
                let mut unit = vec![0.0; n];
                unit[*k] = 1.0;
                cholesky.forward(&mut unit);
                let length = dot(&unit, &unit).sqrt();
                (cholesky.used()[*k] && length > 0.0).then(|| unit.iter().map(|v| v / length).collect())
            })
            .collect::<Option<_>>()?;
        Some(columns.iter().flat_map(|a| columns.iter().map(|b| dot(a, b))).collect())
    }
}

/// Switches of any sign, then those that may not be negative, and the number of the former.
pub(crate) fn free_first(switches: &[Switch]) -> (Vec<Switch>, usize) {
    let (signed, any): (Vec<Switch>, Vec<Switch>) = switches.iter().partition(|s| s.nonnegative);
    let free = any.len();
    (any.into_iter().chain(signed).collect(), free)
}
