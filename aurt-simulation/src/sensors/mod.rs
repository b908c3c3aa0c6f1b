//! From what happened to what a logger writes: encoders, current sensors, clock, resolution and file.

mod csv;
mod current;
mod faults;
mod instrument;
mod logger;

pub use current::{DriveRipple, NoiseMemory};
pub use faults::{ClockFaults, CorruptRows};
pub use instrument::{Channel, Instrument};
pub use logger::{ColumnNames, Logger, SimulatedRecording, linear_at};
