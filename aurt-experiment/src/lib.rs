//! Experiment files: reading and checking them with the place of every mistake, composing robot models.
//!
//! - [`Experiment`] is an experiment's TOML file, checked;
//! - [`Experiment::robot_model`] composes the robot model.
//!
//! Models are found by name in a [`Registry`](aurt_plugins::Registry), which knows the linked ones and those of loaded
//! libraries.

mod assemble;
mod error;
pub mod experiment;

pub use error::Error;
pub use experiment::{Complaint, Experiment, ExperimentErrors, Problem};
