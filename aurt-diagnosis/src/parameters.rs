//! Estimated parameters under their canonical names.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::Value;

/// An estimate with its standard deviation, or several along the joints of a finding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterValue {
    /// Value: a number, or a list along the finding's joints.
    pub value: Value,
    /// Standard deviation, of the same shape; null where it is unknown.
    pub std: Value,
}

/// Parameters by their canonical names.
pub type Parameters = BTreeMap<String, ParameterValue>;

/// A coefficient as it was fitted: name, value, standard deviation. A coefficient that the baseline absorbs has the
/// value 0 and an infinite deviation.
pub type FittedColumn = (String, f64, f64);

impl ParameterValue {
    /// A value and its deviation; numbers that are not finite become null.
    pub(crate) fn new(value: impl Into<Value>, std: impl Into<Value>) -> Self {
        Self { value: value.into(), std: std.into() }
    }

    /// A value of which no deviation is known.
    pub(crate) fn exact(value: impl Into<Value>) -> Self {
        Self::new(value, Value::Null)
    }

    /// The number and its deviation, where it is one number; an unknown deviation is 0.
    pub(crate) fn number(&self) -> Option<[f64; 2]> {
        Some([self.value.as_f64()?, self.std.as_f64().unwrap_or(0.0)])
    }
}

/// Coefficients on top of a level that the model has already.
pub(crate) fn raised(fitted: &[FittedColumn], by: f64) -> Vec<FittedColumn> {
    fitted.iter().map(|(name, value, std)| (name.clone(), value + by, *std)).collect()
}
