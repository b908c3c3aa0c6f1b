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
//!
//! # Features
//! Text is always read. The others are on by default: `mcap` (bags of ROS 2: MCAP, SQLite, folders), `parquet`, `lerobot`,
//! `numpy`, `matlab`.

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    not(all(feature = "mcap", feature = "parquet", any(feature = "matlab", feature = "numpy"))),
    expect(dead_code, reason = "what several formats share is there for each of them")
)]

#[cfg(any(feature = "matlab", feature = "numpy"))]
mod arrays;
#[cfg(feature = "mcap")]
mod bag;
mod branches;
mod csv;
mod error;
mod format;
mod formats;
#[cfg(feature = "parquet")]
mod guarded;
mod joined;
#[cfg(feature = "lerobot")]
mod lerobot;
mod long;
#[cfg(feature = "matlab")]
mod matlab;
mod memory;
mod noise;
#[cfg(feature = "numpy")]
mod numpy;
#[cfg(feature = "parquet")]
mod parquet;
mod preprocess;
mod read_options;
mod reading;
mod recorded_as;
mod recording;
mod robot_joints;
mod sampling;
mod spread;
mod written;

#[cfg(feature = "parquet")]
pub use self::parquet::PARQUET;
#[cfg(feature = "mcap")]
pub use bag::BAG;
pub use branches::BranchMotion;
pub use csv::CSV;
pub use csv::families::is_time_name;
pub use error::RecordingError;
pub use format::RecordingFormat;
pub use formats::{FORMATS, is_recording_folder};
pub use long::{LongPrepared, LongRecording, LongSegment, Stretch};
#[cfg(feature = "matlab")]
pub use matlab::MATLAB;
pub use noise::{
    Interpolation, Interpolator, MedianSpectrum, PositionNoise, SpectrumBand, WhiteAndMarkov,
    acceleration_gain, lattice_step, median, median_step_s, velocity_gain, white_level_at,
};
#[cfg(feature = "numpy")]
pub use numpy::NUMPY;
pub use preprocess::{
    ClockReport, DecimatedTile, Decimation, DroppedSegment, PreprocessOptions, PreprocessReport,
    Preprocessed, Section, Segment, SegmentReport, ZeroPhase, ZeroPhaseBank, preprocess,
};
pub use read_options::ReadOptions;
pub use reading::{read_recording, read_running};
pub use recorded_as::{
    AngleUnit, ColumnRef, ColumnSelection, ColumnsRef, CurrentUnit, DroppedRows, JoinedFile, Quantity,
    RecordedAs, TimeUnit,
};
pub use recording::{DroppedRow, ReadReport, RecordedJoints, Recording};
pub use robot_joints::{RobotJoints, RobotRecording};
pub use sampling::{StampUnit, quiet_f_dyn_hz, suitable_f_dyn_hz};
pub use spread::Stretches;
pub use written::PlannedMotion;
#[cfg(feature = "parquet")]
pub use written::parquet;
#[cfg(feature = "mcap")]
pub use written::{JointTopic, mcap};
