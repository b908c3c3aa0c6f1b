//! The result of a point, as it is kept.

use aurt_calibration::{CalibratedParameter, Metrics, ShapeReport};
use aurt_traits::MeasurementUnit;
use serde::{Deserialize, Serialize};

/// Version of the file.
pub const SCHEMA: u32 = 1;

/// What became of a point. Results are kept under a hash of all that they depend on, and hold nothing else: no times,
/// no names of points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PointResult {
    /// [`SCHEMA`].
    pub schema: u32,
    /// The key under which it is kept.
    pub key: String,
    /// What came out.
    pub outcome: Outcome,
}

/// What came out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The model was fitted and judged.
    Judged(Evaluation),
    /// It could not be; why.
    Failed(String),
}

/// Fits with their errors on what they were not fitted to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Evaluation {
    /// Unit of the measurement.
    pub unit: MeasurementUnit,
    /// Number of coefficients.
    pub coefficients: usize,
    /// Number of shape parameters that were searched.
    pub shapes: usize,
    /// The fits: one, or with `leave_one_out` one for each recording.
    pub folds: Vec<Fold>,
}

/// A fit and the recordings that it is judged on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fold {
    /// Names of the recordings that it was fitted to.
    pub calibrated_on: Vec<String>,
    /// The coefficients.
    pub parameters: Vec<CalibratedParameter>,
    /// The search for shapes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape_fit: Option<ShapeReport>,
    /// Condition number of the weighted observation matrix.
    pub condition_number: f64,
    /// Warnings of the calibration.
    pub warnings: Vec<String>,
    /// The held-out recordings.
    pub judged: Vec<Judged>,
}

/// The errors on one held-out recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Judged {
    /// Its name.
    pub recording: String,
    /// Over all rows while the robot is in motion.
    pub all: Errors,
    /// Over the rows at which the joint moves.
    pub moving: Errors,
}

/// Errors over some rows: in all, and block of time by block of time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Errors {
    /// In all.
    pub metrics: Metrics,
    /// Rows of each block, `[joint][block]`.
    pub block_rows: Vec<Vec<usize>>,
    /// Σ (y − ŷ)² of each block, `[joint][block]`.
    pub block_squared_errors: Vec<Vec<f64>>,
}

/// Which rows are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rows {
    /// All while the robot is in motion.
    #[default]
    All,
    /// Those at which the joint moves.
    Moving,
}

impl Judged {
    /// The errors over some rows.
    #[must_use]
    pub const fn errors(&self, rows: Rows) -> &Errors {
        match rows {
            Rows::All => &self.all,
            Rows::Moving => &self.moving,
        }
    }
}

impl Evaluation {
    /// All held-out recordings, fold after fold.
    pub fn judged(&self) -> impl Iterator<Item = &Judged> {
        self.folds.iter().flat_map(|f| &f.judged)
    }

    /// Mean squared error of each joint over all held-out recordings, unit of the measurement squared; `NaN` where no
    /// row qualifies.
    #[must_use]
    pub fn mse(&self, rows: Rows) -> Vec<f64> {
        self.pooled(rows).into_iter().map(|(squared, _, rows)| squared / rows as f64).collect()
    }

    /// Root mean squared error over root mean squared measurement, as a fraction.
    #[must_use]
    pub fn nrmse(&self, rows: Rows) -> Vec<f64> {
        self.pooled(rows).into_iter().map(|(squared, power, _)| (squared / power).sqrt()).collect()
    }

    /// Σ e², Σ y² and rows of each joint.
    fn pooled(&self, rows: Rows) -> Vec<(f64, f64, usize)> {
        let mut pooled: Vec<(f64, f64, usize)> = Vec::new();
        for metrics in self.judged().map(|j| &j.errors(rows).metrics) {
            pooled.resize(metrics.samples.len(), (0.0, 0.0, 0));
            for (joint, sum) in pooled.iter_mut().enumerate().filter(|(j, _)| metrics.samples[*j] > 0) {
                let squared = metrics.mse[joint] * metrics.samples[joint] as f64;
                sum.0 += squared;
                sum.1 += squared / metrics.nrmse[joint].powi(2);
                sum.2 += metrics.samples[joint];
            }
        }
        pooled
    }
}
