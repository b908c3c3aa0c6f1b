//! Predictions beside measurements.

mod comparison;
mod metrics;
mod validate;

pub(crate) use validate::{beyond, forget_unread, validated};

pub use comparison::{ComparedJoint, Comparison, compare};
pub use metrics::{JointMetrics, Metrics};
pub use validate::{Prediction, ValidatedRows, Validation, extrapolations, predict, validate};
