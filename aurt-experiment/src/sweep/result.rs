//! The result of a point, as it is kept.

use aurt_calibration::{CalibratedParameter, ShapeReport};
use aurt_traits::MeasurementUnit;
use serde::{Deserialize, Serialize};

const SCHEMA: u32 = 2;

/// What became of a point. Results are kept under a hash of all that they depend on, and hold nothing else: no times,
/// no names of points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PointResult {
    schema: u32,
    key: String,
    /// BLAKE3 of the key and the outcome as compact JSON. Numbers survive writing and reading to the last bit, so the
    /// hash of what was read is that of what was written unless somebody changed it.
    checksum: String,
    pub outcome: Outcome,
}

impl PointResult {
    pub(crate) fn new(key: &str, outcome: Outcome) -> serde_json::Result<Self> {
        Ok(Self { schema: SCHEMA, key: key.to_owned(), checksum: checksum(key, &outcome)?, outcome })
    }

    /// True if it is the result under a key, of this version, as it was written.
    pub(crate) fn is_whole(&self, key: &str) -> bool {
        let same = || checksum(key, &self.outcome).is_ok_and(|sum| sum == self.checksum);
        self.schema == SCHEMA && self.key == key && same()
    }
}

fn checksum(key: &str, outcome: &Outcome) -> serde_json::Result<String> {
    let text = serde_json::to_vec(&(key, outcome))?;
    Ok(blake3::hash(&text).to_hex().as_str()[..40].to_owned())
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    Judged(Evaluation),
    /// It could not be; why.
    Failed(String),
}

/// Fits with their errors on what they were not fitted to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Evaluation {
    pub unit: MeasurementUnit,
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
    pub parameters: Vec<CalibratedParameter>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shape_fit: Option<ShapeReport>,
    /// Condition number of the weighted observation matrix; absent if it is infinite.
    pub condition_number: Option<f64>,
    pub warnings: Vec<String>,
    /// The held-out recordings.
    pub judged: Vec<Judged>,
}

/// The errors on one held-out recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Judged {
    pub recording: String,
    /// Over all rows while the robot is in motion, joint after joint.
    pub all: Vec<JointErrors>,
    pub moving: Vec<JointErrors>,
}

/// Sums over one joint's rows, in all and block of time by block of time.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointErrors {
    pub rows: usize,
    /// Σ (y − ŷ)², unit of the measurement squared.
    pub squared_error: f64,
    /// Σ y².
    pub squared_measurement: f64,
    pub absolute_measurement: f64,
    pub block_rows: Vec<usize>,
    /// Σ (y − ŷ)² of each block.
    pub block_squared_error: Vec<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rows {
    /// All while the robot is in motion.
    #[default]
    All,
    Moving,
}

impl JointErrors {
    pub(crate) fn add(&mut self, block: usize, measured: f64, predicted: f64) {
        let squared = (measured - predicted).powi(2);
        self.rows += 1;
        self.squared_error += squared;
        self.squared_measurement += measured * measured;
        self.absolute_measurement += measured.abs();
        if self.block_rows.len() <= block {
            self.block_rows.resize(block + 1, 0);
            self.block_squared_error.resize(block + 1, 0.0);
        }
        self.block_rows[block] += 1;
        self.block_squared_error[block] += squared;
    }

    /// Appends empty blocks, so that all joints have the same.
    pub(crate) fn extend_to(&mut self, blocks: usize) {
        self.block_rows.resize(blocks, 0);
        self.block_squared_error.resize(blocks, 0.0);
    }

    /// Mean squared error; `NaN` without rows.
    pub fn mse(&self) -> f64 {
        self.squared_error / self.rows as f64
    }

    /// Mean squared error over mean absolute measurement (Table II of the paper).
    pub fn nmse(&self) -> f64 {
        self.squared_error / self.absolute_measurement
    }

    /// Root mean squared error over root mean squared measurement, as a fraction.
    pub fn nrmse(&self) -> f64 {
        (self.squared_error / self.squared_measurement).sqrt()
    }
}

impl Judged {
    pub fn errors(&self, rows: Rows) -> &[JointErrors] {
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

    /// The sums of each joint over all held-out recordings; their blocks follow each other.
    pub fn pooled(&self, rows: Rows) -> Vec<JointErrors> {
        let mut pooled: Vec<JointErrors> = Vec::new();
        for errors in self.judged().map(|j| j.errors(rows)) {
            pooled.resize(errors.len(), JointErrors::default());
            for (sum, one) in pooled.iter_mut().zip(errors) {
                sum.rows += one.rows;
                sum.squared_error += one.squared_error;
                sum.squared_measurement += one.squared_measurement;
                sum.absolute_measurement += one.absolute_measurement;
                sum.block_rows.extend_from_slice(&one.block_rows);
                sum.block_squared_error.extend_from_slice(&one.block_squared_error);
            }
        }
        pooled
    }
}
