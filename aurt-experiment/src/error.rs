//! Why an experiment cannot be read.

use thiserror::Error;

use crate::experiment::ExperimentErrors;

/// Why an experiment cannot be read.
#[derive(Debug, Error)]
pub enum Error {
    /// The experiment is wrong in one or more places.
    #[error(transparent)]
    Experiment(#[from] Box<ExperimentErrors>),
    #[error(transparent)]
    Model(#[from] aurt_plugins::model::Error),
}
