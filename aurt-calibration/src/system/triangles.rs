use aurt_traits::Dispatch;
use nalgebra::{DMatrix, DVector};

use super::factor::JointFactor;
use crate::CalibrationError;
use crate::dense::{self, dot};
use crate::linear::condition_number;

/// A column that is not longer than this is zero: what exponentials leave far from where they act (1e-160) is no motion.
const LEAST_LENGTH: f64 = 1e-100;

/// The least-squares problem of a whole robot: one [`JointFactor`] per joint over common coefficients.
///
/// Weights per joint, subsets of columns and merged recordings are all answered from the factors, without
/// the samples.
#[derive(Debug, Clone)]
pub struct System {
    coefficients: usize,
    factors: Vec<JointFactor>,
}

/// A solution of a [`System`].
#[derive(Debug, Clone)]
pub struct Solution {
    /// The coefficients ζ̂; zero where not excited or not active.
    pub coefficients: Vec<f64>,
    /// Whether the rows determine each coefficient.
    pub excited: Vec<bool>,
    /// ‖y_j − W_j ζ̂‖² of each joint, unweighted.
    pub residual_sum: Vec<f64>,
    /// (WᵀΩ⁻¹W)⁻¹ over all coefficients, column-major; zero rows where not excited.
    pub covariance: Vec<f64>,
    /// Condition number of the weighted observation matrix, columns scaled to equal length (so that it does
    /// not depend on units).
    pub condition_number: f64,
}

impl System {
    /// A system over `coefficients` coefficients.
    pub const fn new(coefficients: usize, factors: Vec<JointFactor>) -> Self {
        Self { coefficients, factors }
    }

    /// The joints' factors.
    pub fn factors(&self) -> &[JointFactor] {
        &self.factors
    }

    pub(crate) fn factors_mut(&mut self) -> &mut [JointFactor] {
        &mut self.factors
    }

    /// Number of coefficients.
    pub const fn coefficients(&self) -> usize {
        self.coefficients
    }

    /// Adds the information of other recordings of the same robot and model.
    ///
    /// # Errors
    /// [`CalibrationError::Columns`] if the models differ.
    pub fn merge(&mut self, other: &Self) -> Result<(), CalibrationError> {
        if self.factors.len() != other.factors.len() {
            return Err(CalibrationError::Columns { left: self.factors.len(), right: other.factors.len() });
        }
        self.factors.iter_mut().zip(&other.factors).try_for_each(|(a, b)| a.merge(b))
    }

    /// ‖y_j − W_j ζ‖² for each joint.
    pub fn residual_sum(&self, coefficients: &[f64]) -> Vec<f64> {
        self.factors
            .iter()
            .map(|factor| {
                let (r, n) = (factor.triangle(), factor.columns().len() + 1);
                (0..n)
                    .map(|row| {
                        let predicted: f64 = factor
                            .columns()
                            .iter()
                            .enumerate()
                            .skip(row)
                            .map(|(k, c)| r[k * n + row] * coefficients[*c])
                            .sum();
                        (r[(n - 1) * n + row] - predicted).powi(2)
                    })
                    .sum()
            })
            .collect()
    }

    /// Weighted least squares: minimises Σ_j weight_j² ‖y_j − W_j ζ‖² over the coefficients for which `active`
    /// is true. With `weights[j]` = 1/σ_j this is equation (13) of the paper, with ones it is OLS.
    ///
    /// # Errors
    /// [`CalibrationError::NotFinite`].
    pub fn solve(
        &self,
        weights: &[f64],
        active: impl Fn(usize) -> bool,
    ) -> Result<Solution, CalibrationError> {
        let reduced = self.reduced(weights, active)?;
        let (n, m) = (self.coefficients, reduced.kept.len());
        let Reduced { kept, scales, upper, .. } = &reduced;
        let gram = gram_of_inverse(&invert_upper(upper, m), m);
        let mut covariance = vec![0.0; n * n];
        for (b, other) in kept.iter().enumerate() {
            for (a, column) in kept.iter().enumerate() {
                covariance[other * n + column] = gram[b * m + a] / (scales[*column] * scales[*other]);
            }
        }
        let coefficients = reduced.coefficients(n)?;
        Ok(Solution {
            residual_sum: self.residual_sum(&coefficients),
            excited: reduced.excited(n),
            coefficients,
            covariance,
            condition_number: condition_number(upper, m),
        })
    }

    /// The coefficients of [`Self::solve`] and whether each is excited, without what tells how sure they are.
    ///
    /// # Errors
    /// [`CalibrationError::NotFinite`].
    pub fn solve_coefficients(&self, weights: &[f64]) -> Result<(Vec<f64>, Vec<bool>), CalibrationError> {
        let reduced = self.reduced(weights, |_| true)?;
        Ok((reduced.coefficients(self.coefficients)?, reduced.excited(self.coefficients)))
    }

    /// Least squares with a prior: what one column alone gives to the weighted rows is a normal number of mean 0 and variance 1, and
    /// the rows say as much of it as rows with this variance each would.
    ///
    /// # Errors
    /// [`CalibrationError::NotFinite`].
    pub fn solve_with_prior(&self, weights: &[f64], variance: f64) -> Result<Vec<f64>, CalibrationError> {
        let Reduced { kept, scales, upper, right, .. } = self.reduced(weights, |_| true)?;
        let m = kept.len();
        let upper = DMatrix::from_vec(m, m, upper);
        let mut gram = upper.tr_mul(&upper);
        (0..m).for_each(|k| gram[(k, k)] += variance);
        let values = gram
            .cholesky()
            .map(|c| c.solve(&upper.tr_mul(&DVector::from_vec(right))))
            .ok_or(CalibrationError::NotFinite)?;
        let mut coefficients = vec![0.0; self.coefficients];
        for (value, column) in values.iter().zip(&kept) {
            coefficients[*column] = value / scales[*column];
        }
        Ok(coefficients)
    }

    /// The coefficients of [`Self::solve`] alone.
    pub(crate) fn solve_coefficients_of(
        &self,
        weights: &[f64],
        active: impl Fn(usize) -> bool,
    ) -> Result<Vec<f64>, CalibrationError> {
        self.reduced(weights, active)?.coefficients(self.coefficients)
    }

    /// The triangle of all joints' weighted rows, columns scaled to equal length.
    fn reduced(&self, weights: &[f64], active: impl Fn(usize) -> bool) -> Result<Reduced, CalibrationError> {
        let n = self.coefficients;
        let order = self.rows_by_first_column();
        let rows = order.len();
        let mut place: Vec<Vec<usize>> =
            self.factors.iter().map(|f| vec![0; f.columns().len() + 1]).collect();
        for (at, (_, joint, row)) in order.iter().enumerate() {
            place[*joint][*row] = at;
        }
        let mut stacked = vec![0.0; rows * (n + 1)];
        for ((factor, weight), place) in self.factors.iter().zip(weights).zip(&place) {
            let (r, size) = (factor.triangle(), factor.columns().len() + 1);
            for k in 0..size {
                let column = factor.columns().get(k).copied().unwrap_or(n);
                if column < n && !active(column) {
                    continue;
                }
                for row in 0..=k {
                    stacked[column * rows + place[row]] = weight * r[k * size + row];
                }
            }
        }
        if stacked.iter().any(|v| !v.is_finite()) {
            return Err(CalibrationError::NotFinite);
        }
        let scales: Vec<f64> = stacked.chunks_exact(rows).map(|c| dot(c, c).sqrt()).collect();
        for (column, scale) in stacked.chunks_exact_mut(rows).take(n).zip(&scales) {
            if *scale > LEAST_LENGTH {
                column.iter_mut().for_each(|v| *v /= scale);
            } else {
                column.fill(0.0);
            }
        }
        let heights: Vec<usize> = (0..n).map(|c| order.partition_point(|(first, ..)| *first <= c)).collect();
        let pivots = triangularise_below(&mut stacked, rows, &heights);
        let kept: Vec<usize> = (0..n).filter(|c| pivots[*c].is_some()).collect();
        let m = kept.len();
        let mut upper = vec![0.0; m * m];
        for (k, column) in kept.iter().enumerate() {
            upper[k * m..k * m + k + 1].copy_from_slice(&stacked[column * rows..column * rows + k + 1]);
        }
        let right = stacked[n * rows..n * rows + m].to_vec();
        let others: Vec<usize> = (0..n).filter(|c| pivots[*c].is_none()).collect();
        let mut beyond = vec![0.0; m * others.len()];
        for (k, column) in others.iter().enumerate() {
            // Below the pivots before it, what is left of the column is rounding.
            let before = kept.partition_point(|c| c < column);
            beyond[k * m..k * m + before].copy_from_slice(&stacked[column * rows..column * rows + before]);
        }
        Ok(Reduced { kept, scales, upper, right, others, beyond })
    }

    pub(crate) fn triangle(&self, weights: &[f64]) -> Result<Triangle, CalibrationError> {
        let Reduced { kept, scales, upper, right, others, beyond } = self.reduced(weights, |_| true)?;
        let m = kept.len();
        let unscaled = |columns: &[usize], values: Vec<f64>| {
            let mut matrix = DMatrix::from_vec(m, columns.len(), values);
            for (mut column, c) in matrix.column_iter_mut().zip(columns) {
                column *= scales[*c];
            }
            matrix
        };
        Ok(Triangle {
            upper: unscaled(&kept, upper),
            beyond: unscaled(&others, beyond),
            right: DVector::from_vec(right),
            kept,
            others,
        })
    }

    /// The rows of all triangles as (first column that can be non-zero, joint, row), by that column: while the columns
    /// are eliminated from left to right, a row takes part no sooner than there.
    fn rows_by_first_column(&self) -> Vec<(usize, usize, usize)> {
        let mut order = Vec::new();
        for (joint, factor) in self.factors.iter().enumerate() {
            let mut first = self.coefficients;
            order.push((first, joint, factor.columns().len()));
            for (row, column) in factor.columns().iter().enumerate().rev() {
                first = first.min(*column);
                order.push((first, joint, row));
            }
        }
        order.sort_unstable();
        order
    }
}

/// A triangular system over the columns that rows determine, which are scaled to equal length.
#[derive(Debug)]
struct Reduced {
    kept: Vec<usize>,
    scales: Vec<f64>,
    /// Column-major.
    upper: Vec<f64>,
    right: Vec<f64>,
    others: Vec<usize>,
    /// Entries of the other columns in the rows of the triangle, column-major.
    beyond: Vec<f64>,
}

/// All that the weighted rows say: ‖R ζ_kept + B ζ_others − z‖² is their squared residual, but for a constant.
#[derive(Debug)]
pub(crate) struct Triangle {
    /// The coefficients that the rows determine if the others are given.
    pub kept: Vec<usize>,
    /// Those that depend on them.
    pub others: Vec<usize>,
    /// R.
    pub upper: DMatrix<f64>,
    /// B.
    pub beyond: DMatrix<f64>,
    /// z.
    pub right: DVector<f64>,
}

impl Reduced {
    fn coefficients(&self, n: usize) -> Result<Vec<f64>, CalibrationError> {
        let m = self.kept.len();
        let mut values = self.right.clone();
        for k in (0..m).rev() {
            let column = &self.upper[k * m..k * m + k + 1];
            values[k] /= column[k];
            let (above, value) = values.split_at_mut(k);
            above.iter_mut().zip(column).for_each(|(a, r)| *a -= value[0] * r);
        }
        let mut coefficients = vec![0.0; n];
        for (value, column) in values.iter().zip(&self.kept) {
            coefficients[*column] = value / self.scales[*column];
        }
        if coefficients.iter().all(|v| v.is_finite()) {
            Ok(coefficients)
        } else {
            Err(CalibrationError::NotFinite)
        }
    }

    fn excited(&self, n: usize) -> Vec<bool> {
        let mut excited = vec![false; n];
        self.kept.iter().for_each(|c| excited[*c] = true);
        excited
    }
}

/// Householder QR in place, left to right, of `columns` columns and one right-hand side (the last); a column
/// that depends on those before it gets no pivot. Returns each column's row of R.
pub(crate) fn triangularise(matrix: &mut [f64], rows: usize, columns: usize) -> Vec<Option<usize>> {
    triangularise_below(matrix, rows, &vec![rows; columns])
}

/// [`triangularise`] of columns of which the k-th is zero below its first `heights[k]` rows; heights ascend.
fn triangularise_below(matrix: &mut [f64], rows: usize, heights: &[usize]) -> Vec<Option<usize>> {
    let mut pivots = vec![None; heights.len()];
    dense::triangularise_below(Dispatch::active(), matrix, rows, heights, &mut pivots);
    pivots
}

/// Inverse of an upper triangle, both column-major.
fn invert_upper(upper: &[f64], n: usize) -> Vec<f64> {
    let mut inverse = vec![0.0; n * n];
    for k in 0..n {
        let column = &mut inverse[k * n..k * n + k + 1];
        column[k] = 1.0;
        for i in (0..=k).rev() {
            let (above, rest) = column.split_at_mut(i);
            rest[0] /= upper[i * n + i];
            above.iter_mut().zip(&upper[i * n..i * n + i]).for_each(|(a, r)| *a -= rest[0] * r);
        }
    }
    inverse
}

/// X Xᵀ of an upper triangle X, column-major.
fn gram_of_inverse(inverse: &[f64], n: usize) -> Vec<f64> {
    let mut gram = vec![0.0; n * n];
    for k in 0..n {
        let column = &inverse[k * n..k * n + k + 1];
        for (b, factor) in column.iter().enumerate() {
            let sum = &mut gram[b * n..b * n + b + 1];
            sum.iter_mut().zip(column).for_each(|(s, x)| *s += factor * x);
        }
    }
    for b in 0..n {
        for a in 0..b {
            gram[a * n + b] = gram[b * n + a];
        }
    }
    gram
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(seed: f64, n: usize) -> Vec<f64> {
        (0..n).map(|i| ((i as f64 + 1.0) * (0.569_840_290_998 + seed)).fract() - 0.5).collect()
    }

    /// Two joints that share coefficient 0; coefficient 2 repeats coefficient 1 and so is not excited.
    fn example() -> (System, [f64; 4]) {
        let n = 400;
        let truth = [1.5, -2.0, 0.0, 0.25];
        let (a, b, c, d) = (series(0.0, n), series(0.11, n), series(0.23, n), series(0.37, n));
        let doubled: Vec<f64> = b.iter().map(|v| 2.0 * v).collect();
        let y0: Vec<f64> = (0..n).map(|i| truth[0] * a[i] + truth[1] * b[i]).collect();
        let y1: Vec<f64> = (0..n).map(|i| truth[0] * c[i] + truth[3] * d[i]).collect();
        let mut first = JointFactor::new(vec![0, 1, 2]);
        first.push(|k| [&a, &b, &doubled][k].as_slice(), &y0, |_| true);
        let mut second = JointFactor::new(vec![0, 3]);
        second.push(|k| [&c, &d][k].as_slice(), &y1, |_| true);
        (System::new(4, vec![first, second]), truth)
    }

    #[test]
    fn exact_data_give_the_exact_coefficients_and_name_what_is_not_excited() {
        let (system, truth) = example();
        let solution = system.solve(&[1.0, 3.0], |_| true).unwrap();
        for (found, expected) in solution.coefficients.iter().zip(truth) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        assert_eq!(solution.excited, [true, true, false, true]);
        assert!(solution.residual_sum.iter().all(|r| *r < 1e-20));
        assert!(solution.condition_number >= 1.0);
    }

    #[test]
    fn a_column_of_what_is_left_of_an_exponential_is_none() {
        let n = 200;
        let (a, y) = (series(0.0, n), series(0.4, n));
        let gone: Vec<f64> = series(0.2, n).iter().map(|v| 1e-160 * v).collect();
        let mut factor = JointFactor::new(vec![0, 1]);
        factor.push(|k| [&a, &gone][k].as_slice(), &y, |_| true);
        let solution = System::new(2, vec![factor]).solve(&[1.0], |_| true).unwrap();
        assert_eq!(solution.excited, [true, false]);
        assert_eq!(solution.coefficients[1], 0.0);
    }

    /// (WᵀW + v S²) ζ = Wᵀy, with the lengths S of the columns.
    #[test]
    fn a_prior_balances_what_the_rows_say() {
        let (system, truth) = example();
        let plain = system.solve_coefficients(&[1.0, 1.0]).unwrap().0;
        let free = system.solve_with_prior(&[1.0, 1.0], 0.0).unwrap();
        assert!(plain.iter().zip(&free).all(|(a, b)| (a - b).abs() < 1e-10));
        let n = 400;
        let (a, y): (Vec<f64>, Vec<f64>) = series(0.0, n).iter().map(|v| (*v, 3.0 * v)).unzip();
        let mut factor = JointFactor::new(vec![0]);
        factor.push(|_| a.as_slice(), &y, |_| true);
        let alone = System::new(1, vec![factor]);
        let shrunk = alone.solve_with_prior(&[1.0], 0.5).unwrap()[0];
        assert!((shrunk - 3.0 / 1.5).abs() < 1e-12, "{shrunk}");
        let far = system.solve_with_prior(&[1.0, 1.0], 1e12).unwrap();
        assert!(far.iter().zip(truth).all(|(value, truth)| value.abs() < 1e-9 * (1.0 + truth.abs())));
    }

    #[test]
    fn an_inactive_column_is_left_out() {
        let (system, truth) = example();
        let solution = system.solve(&[1.0, 1.0], |c| c != 1).unwrap();
        assert!((solution.coefficients[2] - truth[1] / 2.0).abs() < 1e-12);
        assert!(!solution.excited[1]);
    }
}
