//! From what happened to what a logger writes: encoders, current sensors, clock, resolution and file.

mod csv;
mod faults;
mod instrument;
mod logger;

pub use faults::{ClockFaults, CorruptRows};
pub use instrument::{Channel, Instrument};
pub use logger::{ColumnNames, Logger, SimulatedRecording};
