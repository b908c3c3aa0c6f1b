//! Estimates that follow a machine over time, and the moment at which it changed.
//!
//! [`Tracker`] is recursive least squares in square-root form: one triangle per joint takes rows in as they come, and
//! old rows fade at a rate of their own for each coefficient. [`Cusum`] finds changes in standardised values, with a
//! threshold from a stated rate of false alarms.

mod cusum;
mod tracker;

pub use cusum::{ChangePoint, Cusum, average_run_length, threshold_for};
pub use tracker::Tracker;
