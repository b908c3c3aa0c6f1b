//! Experiment files and model files: reading and checking them with the place of every mistake, composing robot models.
//!
//! - [`Experiment`] is an experiment's TOML file, checked;
//! - [`RigidBodyDynamics`] and [`Experiment::robot_model`] compose the robot model;
//! - [`model_file`] writes and reads models as JSON.
//!
//! Models are found by name in a [`Registry`], which knows the linked ones and those of loaded libraries.

mod assemble;
mod error;
pub mod experiment;
pub mod model_file;

pub use assemble::{BASE_PARAMETER_SEED, RigidBodyDynamics};
pub use aurt_plugins::{BuildError, Node, NodeKind, Origin, Registry, SlotModel, Span, suggestion};
pub use error::Error;
pub use experiment::{Experiment, ExperimentErrors, Problem};
