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
    #[must_use]
    pub fn coefficients(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.value).collect()
    }
}
