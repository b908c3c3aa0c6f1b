//! Recordings of simulated robot manipulators with known, concealable physics.

pub mod case;
pub mod effects;
mod error;
pub mod fit;
pub mod inject;
mod json_file;
pub mod model;
pub mod plant;
mod random;
pub mod robots;
mod scenario;
mod scenario_file;
pub mod score;
pub mod sensors;
mod strength;
pub mod trajectory;

pub use error::SimulationError;
pub use plant::{Controller, Traces};
pub use random::Random;
pub use robots::{Drive, MotionLimits, Robot, Rotors};
pub use scenario::{Scenario, simulate, simulate_with_traces, trace};
pub use scenario_file::{DriveChange, LinkChange, ScenarioFile};
pub use sensors::{Logger, SimulatedRecording};
pub use strength::Strength;
pub use trajectory::{Motion, Trajectory};
