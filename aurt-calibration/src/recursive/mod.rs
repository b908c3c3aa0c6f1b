//! Estimates that follow a machine over time, and alarms when it changes.
//!
//! [`Tracker`] is recursive least squares in square-root form: one triangle per joint takes rows in as they come, and
//! old rows fade at a rate of their own for each coefficient. [`drift_windows`] turns a recording into what has changed
//! since a calibration: the friction of each joint, the gain of each joint's measurement, and a load on the last link.
//! [`Baseline`] learns from recordings of the unchanged machine, each seen by a calibration to the others ([`LeftOut`]), how much
//! these vary anyway, from window to window ([`DriftEstimate`]) and from motion to motion; a [`Chart`] alarms at what exceeds that, with a threshold
//! from a stated rate of false alarms ([`Cusum`]).

mod baseline;
mod chart;
mod cusum;
mod drift;
mod left_out;
mod level;
mod tracker;

pub use baseline::{Baseline, Drift, MIN_WINDOWS};
pub use chart::Chart;
pub use cusum::{ChangePoint, Cusum, average_run_length, threshold_for};
pub use drift::{Cut, DriftGroup, DriftParameter, DriftReference, DriftWindow, drift_windows};
pub use left_out::LeftOut;
pub use level::{DriftEstimate, own_residuals};
pub use tracker::Tracker;
