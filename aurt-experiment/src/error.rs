//! Why an experiment cannot be read.

use thiserror::Error;

use crate::experiment::ExperimentErrors;

/// Why an experiment cannot be read.
#[derive(Debug, Error)]
pub enum Error {
    #[error(transparent)]
    Experiment(#[from] Box<ExperimentErrors>),
    #[error(transparent)]
    Model(#[from] aurt_plugins::model::Error),
}
