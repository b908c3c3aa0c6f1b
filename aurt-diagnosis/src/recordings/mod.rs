//! Rows of the recordings, and which of them fit and which judge.

pub(crate) mod divided;
pub(crate) mod partition;
pub(crate) mod rows;
pub(crate) mod term_rows;
pub(crate) mod unresolved;

pub use divided::{ConfirmRows, FitRows};
pub use partition::Partition;
pub use rows::{Fit, Instrument, Layout, RecordingRows, Role};
