//! Estimates that follow a machine over time, and alarms when it changes.
//!
//! [`Tracker`] is recursive least squares in square-root form: one triangle per joint takes rows in as they come, and
//! old rows fade at a rate of their own for each coefficient. [`drift_windows`] turns a recording into what has changed
//! since a calibration: the friction of each joint, the gain of each joint's measurement, and a load on the last link.
//! [`Baseline`] learns from recordings of the unchanged machine how much these vary anyway, and [`Cusum`] charts what
//! exceeds that, with a threshold from a stated rate of false alarms.

mod baseline;
mod cusum;
mod drift;
mod tracker;

pub use baseline::{Baseline, Drift, MIN_WINDOWS};
pub use cusum::{ChangePoint, Cusum, average_run_length, threshold_for};
pub use drift::{Cut, DriftGroup, DriftParameter, DriftReference, DriftWindow, drift_windows};
pub use tracker::Tracker;
