//! What noise of the positions does to least squares when it is added once more.

use aurt_traits::{ColumnGroup, RobotModel};

/// Adding a noise of the same power once more shifts an estimate by what the noise has shifted it already where the shift
/// grows with the power, as it does for rigid bodies, and by √2 − 1 of it where it grows with its root: the sign of a velocity
/// is wrong around rest, in a range as wide as the noise. Laws of friction lie between the two; for them the larger is taken.
const MOST: f64 = 1.0 + std::f64::consts::SQRT_2;

/// The most by which noise of the positions may have shifted estimates. It is not taken off them, since which of the two
/// powers holds is not known, but counts as one more error of theirs.
#[derive(Debug, Clone, Default)]
pub(crate) struct Shift {
    /// Zero where the noise is not taken to shift.
    most: Vec<f64>,
    coefficients: usize,
}

impl Shift {
    /// From an estimate, coefficients first and shapes behind them, and the estimates with the noise added once more.
    pub(crate) fn of(model: &RobotModel, estimate: &[f64], drawn: &[Vec<f64>]) -> Self {
        let coefficients = model.parameters().len();
        let mut factor = vec![MOST; estimate.len()];
        for (group, _) in model.groups() {
            if !matches!(group, ColumnGroup::JointDynamics(_)) {
                factor[model.group(*group)].fill(1.0);
            }
        }
        let most = estimate
            .iter()
            .enumerate()
            .map(|(k, own)| {
                let shifts: Vec<f64> = drawn.iter().map(|d| d[k] - own).collect();
                factor[k] * shifts.iter().sum::<f64>() / shifts.len().max(1) as f64
            })
            .collect();
        Self { most, coefficients }
    }

    /// Of the coefficients.
    pub(crate) fn coefficients(&self) -> &[f64] {
        &self.most[..self.coefficients.min(self.most.len())]
    }

    /// Of the shapes.
    pub(crate) fn shapes(&self) -> &[f64] {
        &self.most[self.coefficients.min(self.most.len())..]
    }

    /// Adds the shifts of the coefficients to a covariance, column-major, that is multiplied by `scale` later on.
    pub(crate) fn widen(&self, covariance: &mut [f64], scale: f64) {
        let most = self.coefficients();
        for (column, own) in most.iter().enumerate() {
            for (row, other) in most.iter().enumerate() {
                covariance[column * most.len() + row] += own * other / scale;
            }
        }
    }
}
