//! What noise of the positions does to least squares when it is added once more.

use aurt_traits::{ColumnGroup, RobotModel};

/// Adding a noise of the same power once more shifts an estimate by what the noise has shifted it already where the shift
/// grows with the power, as it does for rigid bodies, and by √2 − 1 of it where it grows with its root: the sign of a velocity
/// is wrong around rest, in a range as wide as the noise. Laws of friction, of joints and of arm terms that are no loads, lie
/// between the two; for them the larger is taken.
const OF_FRICTION: f64 = 1.0 + std::f64::consts::SQRT_2;

/// By how much noise of the positions is taken to have shifted estimates. It is not taken off them, since which of the two
/// powers holds is not known, but counts as one more error of theirs.
#[derive(Debug, Clone, Default)]
pub(crate) struct Shift {
    all: Vec<f64>,
    coefficients: usize,
}

impl Shift {
    /// From an estimate, coefficients first and shapes behind them, and the estimates with the noise added once more; `owners`
    /// are the groups of the shapes. Without draws there is no shift.
    pub(crate) fn of(
        model: &RobotModel,
        owners: &[ColumnGroup],
        estimate: &[f64],
        drawn: &[Vec<f64>],
    ) -> Self {
        if drawn.is_empty() {
            return Self::default();
        }
        let coefficients = model.parameters().len();
        let mut factors = vec![1.0; coefficients];
        for (group, _) in model.groups() {
            factors[model.group(*group)].fill(factor(model, *group));
        }
        factors.extend(owners.iter().map(|group| factor(model, *group)));
        let mean = |k: usize| drawn.iter().map(|d| d[k] - estimate[k]).sum::<f64>() / drawn.len() as f64;
        let all = factors.iter().enumerate().map(|(k, factor)| factor * mean(k)).collect();
        Self { all, coefficients }
    }

    pub(crate) fn coefficients(&self) -> &[f64] {
        &self.all[..self.coefficients.min(self.all.len())]
    }

    pub(crate) fn shapes(&self) -> &[f64] {
        &self.all[self.coefficients.min(self.all.len())..]
    }

    /// Adds the shifts of the coefficients to a covariance, column-major.
    pub(crate) fn widen(&self, covariance: &mut [f64]) {
        let shifts = self.coefficients();
        for (column, own) in shifts.iter().enumerate() {
            for (row, other) in shifts.iter().enumerate() {
                covariance[column * shifts.len() + row] += own * other;
            }
        }
    }
}

/// What a shift by the noise added once more is multiplied by.
fn factor(model: &RobotModel, group: ColumnGroup) -> f64 {
    let is_friction = match group {
        ColumnGroup::RigidBody => false,
        ColumnGroup::JointDynamics(_) => true,
        ColumnGroup::ArmTerm(k) => !model.arm_terms()[k].is_load(),
    };
    if is_friction { OF_FRICTION } else { 1.0 }
}
