//! Recordings of simulated robot manipulators with known, concealable physics.

#![expect(missing_docs, reason = "names that say all need no sentence")]

pub mod effects;
pub mod error;
pub mod inject;
pub mod model;
pub mod plant;
mod random;
pub mod robots;
mod scenario;
mod scenario_file;
pub mod sensors;
pub mod trajectory;

pub use error::SimulationError;
pub use plant::{Controller, Traces};
pub use random::Random;
pub use robots::{Drive, MotionLimits, Robot, Rotors};
pub use scenario::{Scenario, simulate, simulate_with_traces, trace, trace_with_instrument};
pub use scenario_file::{DriveChange, LinkChange, ScenarioFile};
pub use sensors::{Logger, SimulatedRecording};
pub use trajectory::{Motion, Trajectory};
