use std::path::PathBuf;

use aurt_rbd::RbdError;
use aurt_traits::ModelError;
use thiserror::Error;

use crate::{
    experiment::ExperimentErrors,
    model_file::{Step, in_words},
};

/// Why something about experiments or model files failed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// Models, libraries or plugins.
    #[error(transparent)]
    Plugins(Box<aurt_plugins::Error>),
    /// An experiment is wrong in one or more places.
    #[error(transparent)]
    Experiment(#[from] Box<ExperimentErrors>),
    /// The rigid bodies cannot be built, or their base parameters not be determined.
    #[error(transparent)]
    RigidBody(#[from] RbdError),
    /// Stacks, arm terms and rigid bodies do not fit together.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Assembly(Vec<ModelError>),
    /// A value of a model file is wrong; [`Error::in_file`] makes a [`Error::ModelFile`] of it.
    #[error("{}{reason}{}", in_words(place), and_help(help))]
    ModelValue {
        /// The way to the value.
        place: Vec<Step>,
        /// What is wrong with it, as the rest of a sentence about it.
        reason: String,
        /// What to do.
        help: Option<String>,
    },
    /// A model file is wrong.
    #[error("{}:{line}:{column}: {reason}{}", path.display(), and_help(help))]
    ModelFile {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// The column, from 1.
        column: usize,
        /// What is wrong.
        reason: String,
        /// What to do.
        help: Option<String>,
    },
    /// Something cannot be written into a model file.
    #[error("{what} cannot be saved: {reason}")]
    Unsaved {
        /// What could not be saved.
        what: String,
        /// Why.
        reason: String,
    },
    /// A file could not be read.
    #[error("{path}: cannot be read: {source}", path = path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A file could not be written.
    #[error("{path}: cannot be written: {source}", path = path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
}

fn and_help(help: &Option<String>) -> String {
    help.as_ref().map_or_else(String::new, |help| format!("; {help}"))
}

impl From<aurt_plugins::Error> for Error {
    fn from(error: aurt_plugins::Error) -> Self {
        Self::Plugins(Box::new(error))
    }
}

impl From<aurt_output::WriteError> for Error {
    fn from(error: aurt_output::WriteError) -> Self {
        Self::Write { path: error.path, source: error.source }
    }
}
