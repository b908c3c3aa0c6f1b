//! Why a robot model cannot be put together, read or written.

use std::path::PathBuf;

use crate::BuildError;
use aurt_rbd::robots::RobotErrors;
use aurt_rbd::{MdhErrors, RbdError};
use aurt_traits::ModelError;
use thiserror::Error;

use crate::model::place::{Step, in_words};

/// Why a robot model cannot be put together, read or written.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum Error {
    #[error(transparent)]
    Plugins(Box<crate::Error>),
    /// The table of modified Denavit–Hartenberg parameters.
    #[error(transparent)]
    Mdh(#[from] MdhErrors),
    #[error(transparent)]
    Robot(#[from] RobotErrors),
    #[error("`{name}` is not the name of a known robot; {remedy}")]
    UnknownRobot { name: String, remedy: String },
    /// The rigid bodies cannot be built, or their base parameters not be determined.
    #[error(transparent)]
    RigidBody(RbdError),
    /// Friction models or arm terms are unknown, or their keys are wrong.
    #[error("{}", lines(.0))]
    Build(Vec<BuildError>),
    /// Stacks, arm terms and rigid bodies do not fit together.
    #[error("{}", lines(.0))]
    Assembly(Vec<ModelError>),
    /// A value of a model file is wrong; [`Error::in_file`] makes a [`Error::ModelFile`] of it.
    #[error("{}{reason}{}", in_words(place), and_help(help))]
    ModelValue {
        place: Vec<Step>,
        /// What is wrong with it, as the rest of a sentence about it.
        reason: String,
        help: Option<String>,
    },
    /// The same at its place; lines and columns count from 1.
    #[error("{}:{line}:{column}: {reason}{}", path.display(), and_help(help))]
    ModelFile { path: PathBuf, line: usize, column: usize, reason: String, help: Option<String> },
    #[error("{what} cannot be saved: {reason}")]
    Unsaved { what: String, reason: String },
    #[error("{path}: cannot be read: {source}", path = path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error("{path}: cannot be written: {source}", path = path.display())]
    Write { path: PathBuf, source: std::io::Error },
}

fn lines<E: ToString>(errors: &[E]) -> String {
    errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

fn and_help(help: &Option<String>) -> String {
    help.as_ref().map_or_else(String::new, |help| format!("; {help}"))
}

impl From<crate::Error> for Error {
    fn from(error: crate::Error) -> Self {
        match error {
            crate::Error::Write { path, source } => Self::Write { path, source },
            other => Self::Plugins(Box::new(other)),
        }
    }
}

impl From<RbdError> for Error {
    fn from(error: RbdError) -> Self {
        match error {
            RbdError::Mdh(errors) => Self::Mdh(errors),
            other => Self::RigidBody(other),
        }
    }
}

impl From<Vec<ModelError>> for Error {
    fn from(errors: Vec<ModelError>) -> Self {
        Self::Assembly(errors)
    }
}

impl From<Vec<BuildError>> for Error {
    fn from(errors: Vec<BuildError>) -> Self {
        Self::Build(errors)
    }
}
