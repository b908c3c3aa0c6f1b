//! Experiments: reading and checking their files, and what the commands do with them.
//!
//! The rooms stand in order; each imports only from those before it:
//!
//! | room | what it does |
//! |---|---|
//! | [`experiment`] | experiment files with the place of every mistake: [`Experiment`] |
//! | [`sweep`] | many variants of one experiment, run resumably and ranked |
//! | [`workbench`] | what the commands do with experiments, for every front end |
//! | [`doctor`] | usual mistakes of a setup, and a first experiment without them |
//!
//! [`Experiment::robot_model`] composes the robot model. Models are found by name in a
//! [`Registry`](aurt_plugins::Registry), which knows the linked ones and those of loaded libraries.

#![expect(missing_docs, reason = "the front ends are its only users; names that say all need no sentence")]

mod assemble;
pub mod doctor;
mod error;
pub mod experiment;
pub mod sweep;
pub mod workbench;

pub use error::Error;
pub use experiment::{Complaint, Experiment, ExperimentErrors, Problem};
