use aurt_traits::{LoadTorque, MeasurementUnit};
use serde::{Deserialize, Serialize};

use crate::{
    CalibratedParameter, CalibrationOptions, ConsistentReport, EssentialReport, JointRange, PositionBias,
    RobustReport, ShapeReport,
};

/// Everything a calibration found out, beside the structure of the robot model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// What was measured, and so the unit of predictions.
    pub unit: MeasurementUnit,
    /// The settings used.
    pub options: CalibrationOptions,
    /// Frequency of the robot's dynamics in Hz, from which the filters' cut-offs follow.
    pub f_dyn_hz: f64,
    /// The coefficients, in the robot model's order.
    pub parameters: Vec<CalibratedParameter>,
    /// Covariance of the coefficients, from which their deviations are: the lower triangle, row after row, in the order of
    /// `parameters` and the products of their units; zero where a coefficient is not excited. Of `consistent` it is that of
    /// the least squares before. Empty where it is not known or not finite.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub covariance: Vec<f64>,
    /// Weights of the load torque, to be used in prediction.
    pub load: LoadTorque,
    /// σ_j of equation (14), unit of the measurement.
    pub sigma: Vec<f64>,
    /// Rows of each joint that entered the fit.
    pub samples_per_joint: Vec<usize>,
    /// Condition number of the weighted observation matrix with columns of equal length.
    pub condition_number: f64,
    /// Covered ranges, joint by joint.
    pub ranges: Vec<JointRange>,
    /// Names of the recordings.
    pub recordings: Vec<String>,
    /// What a user should know of this calibration.
    pub warnings: Vec<String>,
    /// Of these, the ones that say that a value is none that a machine has, or a limit of its model.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub about_physics: Vec<String>,
    /// The search for shape parameters, if the model has any and they were searched.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape_fit: Option<ShapeReport>,
    /// The step to a machine that can exist, where that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub consistent: Option<ConsistentReport>,
    /// The elimination of parameters, where that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub essential: Option<EssentialReport>,
    /// What noise of the positions does to least squares, where rows were looked at again.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_bias: Option<PositionBias>,
    /// How rows were weighted, where that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robust: Option<RobustReport>,
}

impl Calibration {
    /// The coefficients' values.
    pub fn coefficients(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.value).collect()
    }

    /// The [`Self::covariance`] as a symmetric matrix n × n, row after row; `None` where it is not known. Rows and columns
    /// of coefficients that are not excited are NaN.
    pub fn covariance_matrix(&self) -> Option<Vec<f64>> {
        let n = self.parameters.len();
        if self.covariance.len() != n * (n + 1) / 2 || n == 0 {
            return None;
        }
        let mut matrix = vec![f64::NAN; n * n];
        for r in (0..n).filter(|r| self.parameters[*r].excited) {
            for c in (0..=r).filter(|c| self.parameters[*c].excited) {
                let entry = self.covariance[r * (r + 1) / 2 + c];
                (matrix[r * n + c], matrix[c * n + r]) = (entry, entry);
            }
        }
        Some(matrix)
    }
}
