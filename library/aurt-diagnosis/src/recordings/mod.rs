//! Rows of the recordings: what is wrong with them, and which of them fit and which judge.

pub(crate) mod divided;
pub mod faults;
pub(crate) mod partition;
pub(crate) mod rows;
pub(crate) mod term_rows;

pub use divided::{ConfirmRows, FitRows};
pub use faults::{Fault, RecordingFaults};
pub use partition::Partition;
pub use rows::{Fit, Instrument, Layout, RecordingRows, Role};
