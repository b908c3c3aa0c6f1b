use crate::system::weights;
use crate::{CalibrationError, JointFactor, Solution, System};

/// Recursive weighted least squares in square-root form: Σ_j σ_j⁻² ‖y_j − W_j ζ‖² over all rows so far.
///
/// Each joint's rows are folded into a triangle R_j of [W_j | y_j] by Householder reflections, so that memory does not
/// depend on how many rows there were, and the estimate without forgetting is that of the batch
/// ([`System::solve`]). [`Self::forget`] is vector-type forgetting (Saelid, Foss 1983; Parkum, Poulsen, Holst 1992):
/// the information A becomes D A D with D = diag(√kept), which leaves the estimate where it is and widens each
/// coefficient's deviation by its own rate.
#[derive(Debug, Clone)]
pub struct Tracker {
    system: System,
    weights: Vec<f64>,
    rows: Vec<f64>,
    skipped: usize,
}

impl Tracker {
    /// A tracker that has seen nothing. `columns[j]` are the coefficients that joint j's rows have; `sigma[j]` is the
    /// standard deviation of its noise, unit of the measurement.
    pub fn new(coefficients: usize, columns: Vec<Vec<usize>>, sigma: &[f64]) -> Self {
        let rows = vec![0.0; columns.len()];
        let factors = columns.into_iter().map(JointFactor::new).collect();
        Self { system: System::new(coefficients, factors), weights: weights(sigma), rows, skipped: 0 }
    }

    /// Takes in one filtered row of a joint: `row[k]` belongs to the k-th of the joint's columns. A row that is not
    /// finite is skipped and counted; returns whether it was taken.
    ///
    /// # Errors
    /// [`CalibrationError::Columns`] if there is no such joint or the row has another length than its columns.
    pub fn push(&mut self, joint: usize, row: &[f64], measured: f64) -> Result<bool, CalibrationError> {
        let columns = self.system.factors().get(joint).map_or(0, |f| f.columns().len());
        if columns == 0 || row.len() != columns {
            return Err(CalibrationError::Columns { left: columns, right: row.len() });
        }
        if !measured.is_finite() || row.iter().any(|v| !v.is_finite()) {
            self.skipped += 1;
            return Ok(false);
        }
        self.system.factors_mut()[joint].push(|k| &row[k..=k], &[measured], |_| true);
        self.rows[joint] += 1.0;
        Ok(true)
    }

    /// Takes in rows that are already folded.
    ///
    /// # Errors
    /// [`CalibrationError::Columns`] if they have other columns.
    pub fn add(&mut self, rows: &System) -> Result<(), CalibrationError> {
        self.system.merge(rows)?;
        self.rows.iter_mut().zip(rows.factors()).for_each(|(n, f)| *n += f.rows() as f64);
        Ok(())
    }

    /// Lets old rows fade: coefficient k keeps the share `kept[k]` of its information, 0 < `kept[k]` ≤ 1. The
    /// estimate stays where it is.
    ///
    /// # Errors
    /// [`CalibrationError::NotFinite`].
    pub fn forget(&mut self, kept: &[f64]) -> Result<(), CalibrationError> {
        if kept.iter().all(|k| *k == 1.0) {
            return Ok(());
        }
        let (estimate, _) = self.system.solve_coefficients(&self.weights)?;
        // One factor for all joints' residuals: they balance one another at the estimate.
        let mean = (kept.iter().sum::<f64>() / kept.len() as f64).sqrt();
        for (factor, rows) in self.system.factors_mut().iter_mut().zip(&mut self.rows) {
            *rows *= mean * mean;
            *factor = faded(factor, kept, mean, &estimate);
        }
        Ok(())
    }

    /// The estimate from all rows so far, with the covariance of rows with independent noise σ_j.
    ///
    /// # Errors
    /// [`CalibrationError::NotFinite`].
    pub fn estimate(&self) -> Result<Solution, CalibrationError> {
        self.system.solve(&self.weights, |_| true)
    }

    /// How many rows of each joint the estimate rests on; with forgetting, the equivalent number.
    pub fn rows(&self) -> &[f64] {
        &self.rows
    }

    /// Rows that were not finite.
    pub const fn skipped(&self) -> usize {
        self.skipped
    }
}

/// The triangle [R D | R D ζ̂ + c (z − R ζ̂)], its last diagonal scaled by c.
fn faded(factor: &JointFactor, kept: &[f64], c: f64, estimate: &[f64]) -> JointFactor {
    let mut r = factor.triangle();
    let (columns, size) = (factor.columns().to_vec(), factor.columns().len() + 1);
    let last = (size - 1) * size;
    for row in 0..size {
        let (mut before, mut after) = (0.0, 0.0);
        for (k, column) in columns.iter().enumerate().skip(row) {
            let entry = &mut r[k * size + row];
            before += *entry * estimate[*column];
            *entry *= kept[*column].sqrt();
            after += *entry * estimate[*column];
        }
        r[last + row] = after + c * (r[last + row] - before);
    }
    JointFactor::from_triangle(columns, r, factor.rows())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reproducible numbers between −½ and ½.
    fn number(i: usize, k: usize) -> f64 {
        ((i as f64 + 1.0) * (0.754_877_666_2 + 0.137 * k as f64)).fract() - 0.5
    }

    fn row(i: usize, joint: usize) -> ([f64; 2], f64, [f64; 2]) {
        let truth = if i < 2000 { [2.0, -1.0, 0.5] } else { [2.0, -1.0, 0.9] };
        let x = [number(i, joint), number(i, joint + 2)];
        let y = x[0] * truth[joint] + x[1] * truth[2] + 0.01 * number(i, joint + 5);
        (x, y, [truth[joint], truth[2]])
    }

    fn tracker() -> Tracker {
        Tracker::new(3, vec![vec![0, 2], vec![1, 2]], &[0.01, 0.02])
    }

    #[test]
    fn fading_leaves_the_estimate_and_widens_each_deviation_by_its_own_rate() {
        let mut tracker = tracker();
        for i in 0..1000 {
            for joint in 0..2 {
                let (x, y, _) = row(i, joint);
                assert!(tracker.push(joint, &x, y).unwrap());
            }
        }
        let before = tracker.estimate().unwrap();
        let kept = [1.0, 0.5, 0.25];
        tracker.forget(&kept).unwrap();
        let after = tracker.estimate().unwrap();
        for (k, kept) in kept.iter().enumerate() {
            let (a, b) = (before.coefficients[k], after.coefficients[k]);
            assert!((a - b).abs() < 1e-12, "{a} {b}");
            let ratio = after.covariance[4 * k] / before.covariance[4 * k];
            assert!((ratio * kept - 1.0).abs() < 1e-9, "{ratio}");
        }
    }

    #[test]
    fn a_change_is_followed_with_forgetting_and_averaged_without() {
        let (mut with, mut without) = (tracker(), tracker());
        for i in 0..4000 {
            if i % 50 == 0 {
                with.forget(&[1.0, 1.0, 0.8]).unwrap();
            }
            for joint in 0..2 {
                let (x, y, _) = row(i, joint);
                with.push(joint, &x, y).unwrap();
                without.push(joint, &x, y).unwrap();
            }
        }
        let (with, without) = (with.estimate().unwrap(), without.estimate().unwrap());
        assert!((with.coefficients[2] - 0.9).abs() < 0.005, "{:?}", with.coefficients);
        assert!((without.coefficients[2] - 0.7).abs() < 0.05, "{:?}", without.coefficients);
    }

    #[test]
    fn rows_that_are_no_numbers_are_counted_and_wrong_rows_refused() {
        let mut tracker = tracker();
        assert!(!tracker.push(0, &[f64::NAN, 1.0], 0.0).unwrap());
        assert!(!tracker.push(1, &[0.0, 1.0], f64::INFINITY).unwrap());
        assert_eq!((tracker.skipped(), tracker.rows()), (2, &[0.0, 0.0][..]));
        assert!(tracker.push(0, &[1.0], 0.0).is_err());
        assert!(tracker.push(2, &[1.0, 1.0], 0.0).is_err());
    }
}
