//! Reading and preprocessing robot recordings: formats, clocks, filters.
//!
//! [`read_recording`] turns a file into a [`Recording`]: what the joints did and what was measured, as it was
//! recorded. [`preprocess`] turns a recording into [`Segment`]s: uniform, filtered, differentiated, with the
//! measurement filtered and thinned out. [`ZeroPhaseBank`] is the filter for the regressor's columns, which are
//! never held in memory as a whole.
//!
//! Joints count from 0. Units are SI.

mod csv;
mod error;
mod preprocess;
mod recording;

pub use csv::{ColumnRef, ColumnSelection, ColumnsRef, ReadOptions, read_recording};
pub use error::RecordingError;
pub use preprocess::{
    ClockReport, DecimatedTile, Decimation, DroppedSegment, PreprocessOptions, PreprocessReport,
    Preprocessed, Section, Segment, SegmentReport, ZeroPhase, ZeroPhaseBank, preprocess,
};
pub use recording::{DroppedRow, ReadReport, Recording};
