use crate::{CalibrationError, JointFactor, condition::condition_number};

/// A column whose part independent of the columns before it is smaller than this share of its length is
/// taken as not excited.
const DEPENDENCE_TOLERANCE: f64 = 1e-9;

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
    #[must_use]
    pub const fn new(coefficients: usize, factors: Vec<JointFactor>) -> Self {
        Self { coefficients, factors }
    }

    /// The joints' factors.
    #[must_use]
    pub fn factors(&self) -> &[JointFactor] {
        &self.factors
    }

    /// Number of coefficients.
    #[must_use]
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
    #[must_use]
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
        let n = self.coefficients;
        let rows: usize = self.factors.iter().map(|f| f.columns().len() + 1).sum();
        let mut stacked = vec![0.0; rows * (n + 1)];
        let mut first = 0;
        for (factor, weight) in self.factors.iter().zip(weights) {
            let (r, size) = (factor.triangle(), factor.columns().len() + 1);
            for k in 0..size {
                let column = factor.columns().get(k).copied().unwrap_or(n);
                if column < n && !active(column) {
                    continue;
                }
                for row in 0..=k {
                    stacked[column * rows + first + row] = weight * r[k * size + row];
                }
            }
            first += size;
        }
        if stacked.iter().any(|v| !v.is_finite()) {
            return Err(CalibrationError::NotFinite);
        }
        let scales: Vec<f64> =
            stacked.chunks_exact(rows).map(|c| c.iter().map(|v| v * v).sum::<f64>().sqrt()).collect();
        for (column, scale) in stacked.chunks_exact_mut(rows).take(n).zip(&scales) {
            if *scale > 0.0 {
                column.iter_mut().for_each(|v| *v /= scale);
            }
        }
        let pivots = triangularise(&mut stacked, rows, n);
        let kept: Vec<usize> = (0..n).filter(|c| pivots[*c].is_some()).collect();
        let m = kept.len();
        let mut upper = vec![0.0; m * m];
        for (k, column) in kept.iter().enumerate() {
            upper[k * m..k * m + k + 1].copy_from_slice(&stacked[column * rows..column * rows + k + 1]);
        }
        let inverse = invert_upper(&upper, m);
        let right = &stacked[n * rows..n * rows + m];
        let mut coefficients = vec![0.0; n];
        let mut covariance = vec![0.0; n * n];
        for (a, column) in kept.iter().enumerate() {
            let value: f64 = (a..m).map(|k| inverse[k * m + a] * right[k]).sum();
            coefficients[*column] = value / scales[*column];
            for (b, other) in kept.iter().enumerate() {
                let product: f64 = (a.max(b)..m).map(|k| inverse[k * m + a] * inverse[k * m + b]).sum();
                covariance[other * n + column] = product / (scales[*column] * scales[*other]);
            }
        }
        if coefficients.iter().any(|v| !v.is_finite()) {
            return Err(CalibrationError::NotFinite);
        }
        Ok(Solution {
            residual_sum: self.residual_sum(&coefficients),
            excited: pivots.iter().map(Option::is_some).collect(),
            coefficients,
            covariance,
            condition_number: condition_number(&upper, m),
        })
    }
}

/// Householder QR in place, left to right, of `columns` columns and one right-hand side (the last); a column
/// that depends on those before it gets no pivot. Returns each column's row of R.
pub(crate) fn triangularise(matrix: &mut [f64], rows: usize, columns: usize) -> Vec<Option<usize>> {
    let mut pivots = vec![None; columns];
    let mut next = 0;
    for c in 0..columns {
        if next == rows {
            break;
        }
        let (left, right) = matrix.split_at_mut((c + 1) * rows);
        let column = &mut left[c * rows..];
        let length = column.iter().map(|v| v * v).sum::<f64>().sqrt();
        let rest = column[next..].iter().map(|v| v * v).sum::<f64>().sqrt();
        if rest <= DEPENDENCE_TOLERANCE * length.max(f64::MIN_POSITIVE) {
            continue;
        }
        let alpha = column[next];
        let beta = -rest.copysign(if alpha == 0.0 { 1.0 } else { alpha });
        let tau = (beta - alpha) / beta;
        let scale = 1.0 / (alpha - beta);
        column[next + 1..].iter_mut().for_each(|v| *v *= scale);
        for other in right.chunks_exact_mut(rows) {
            let along: f64 = other[next + 1..].iter().zip(&column[next + 1..]).map(|(o, v)| o * v).sum();
            let projection = tau * (other[next] + along);
            other[next] -= projection;
            for (o, v) in other[next + 1..].iter_mut().zip(&column[next + 1..]) {
                *o -= projection * v;
            }
        }
        column[next] = beta;
        column[next + 1..].fill(0.0);
        pivots[c] = Some(next);
        next += 1;
    }
    pivots
}

/// Inverse of an upper triangle, both column-major.
fn invert_upper(upper: &[f64], n: usize) -> Vec<f64> {
    let mut inverse = vec![0.0; n * n];
    for k in 0..n {
        inverse[k * n + k] = 1.0 / upper[k * n + k];
        for row in (0..k).rev() {
            let sum: f64 = (row + 1..=k).map(|i| upper[i * n + row] * inverse[k * n + i]).sum();
            inverse[k * n + row] = -sum / upper[row * n + row];
        }
    }
    inverse
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
    fn an_inactive_column_is_left_out() {
        let (system, truth) = example();
        let solution = system.solve(&[1.0, 1.0], |c| c != 1).unwrap();
        assert!((solution.coefficients[2] - truth[1] / 2.0).abs() < 1e-12);
        assert!(!solution.excited[1]);
    }
}
