//! Reading and preprocessing robot recordings: formats, clocks, filters.
//!
//! [`read_recording`] turns a file into a [`Recording`]: what the joints did and what was measured, as it was
//! recorded. [`preprocess`] turns a recording into [`Segment`]s: uniform, filtered, differentiated, with the
//! measurement filtered and thinned out. [`ZeroPhaseBank`] is the filter for the regressor's columns, which are
//! never held in memory as a whole. [`LongRecording`] does both for recordings longer than memory.
//!
//! ```
//! use aurt_recording::{PreprocessOptions, ReadOptions, preprocess, read_recording};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("motion.csv");
//! # let rows = (0..2000).map(|k| 0.002 * f64::from(k)).map(|t| format!("{t:.3},{:.6},{:.6}\n", (3.0 * t).sin(), (3.0 * t).cos()));
//! # let text = String::from("time,q_0,torque_0\n") + &rows.collect::<String>();
//! # std::fs::write(&path, text)?;
//! let recording = read_recording(&path, &ReadOptions::default())?;
//! let prepared = preprocess(&recording, &PreprocessOptions::new(10.0))?;
//! for segment in &prepared.segments {
//!     // The regressor of a single inertia has one column: the acceleration. It passes the measurement's filter.
//!     let column = segment.motion.view().acceleration_rad_s2(0);
//!     let mut bank = segment.bank(1);
//!     let mut rows = Vec::new();
//!     let mut collect = |tile: aurt_recording::DecimatedTile<'_>| rows.extend_from_slice(tile.column(0));
//!     for tile in column.chunks(256) {
//!         bank.push(tile, tile.len(), tile.len(), &mut collect);
//!     }
//!     bank.finish(&mut collect)?;
//!     assert_eq!(rows.len(), segment.rows());
//! }
//! # Ok(())
//! # }
//! ```
//!
//! Joints count from 0. Units are SI.

mod arrays;
mod csv;
mod error;
mod foreign;
mod format;
mod joined;
mod joint_state;
mod lerobot;
mod long;
mod matlab;
mod mcap_bag;
mod noise;
mod numpy;
mod parquet;
mod preprocess;
mod recorded_as;
mod recording;
mod robot_joints;
mod spread;
mod written;

pub use csv::{ColumnRef, ColumnSelection, ColumnsRef, Csv, ReadOptions};
pub use error::RecordingError;
pub use format::{FORMATS, RecordingFormat, RecordingInput, read_recording, read_running};
pub use joined::JoinedFile;
pub use lerobot::is_lerobot;
pub use long::{LongPrepared, LongRecording, LongSegment, Stretch};
pub use matlab::Matlab;
pub use mcap_bag::McapBag;
pub use noise::{
    Interpolation, Interpolator, MedianSpectrum, PositionNoise, SpectrumBand, WhiteAndMarkov,
    acceleration_gain, lattice_step, velocity_gain, white_level, white_level_at,
};
pub use numpy::NumPy;
pub use parquet::Parquet;
pub use preprocess::{
    ClockReport, DecimatedTile, Decimation, DroppedSegment, PreprocessOptions, PreprocessReport,
    Preprocessed, Section, Segment, SegmentReport, ZeroPhase, ZeroPhaseBank, preprocess,
};
pub use recorded_as::{AngleUnit, CurrentUnit, Quantity, RecordedAs, TimeUnit};
pub use recording::{DroppedRow, ReadReport, Recording};
pub use robot_joints::{RecordedJoints, RobotJoints, RobotRecording};
pub use spread::Stretches;
pub use written::{JointTopic, mcap, parquet};
