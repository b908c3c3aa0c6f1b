use std::path::PathBuf;

use crate::ExperimentErrors;
use aurt_calibration::CalibrationError;
use thiserror::Error;

/// Why a sweep, as a whole, cannot go on. What is wrong with a single point is its result, not one of these.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum SweepError {
    /// `[sweep]`, or an experiment that it makes, is wrong in one or more places.
    #[error(transparent)]
    Definition(#[from] Box<ExperimentErrors>),
    /// The experiment, models or libraries.
    #[error(transparent)]
    Plugins(#[from] crate::Error),
    #[error("{}: there is no [sweep] to run; add one that names keys and their values", path.display())]
    NoSweep { path: PathBuf },
    #[error(
        "{}: points are ranked by their error on recordings that they were not fitted to; list some under \
         `[recordings] validation`, or set `validate = \"leave_one_out\"` under [sweep] and list at least two \
         calibration recordings",
        path.display()
    )]
    NothingHeldOut { path: PathBuf },
    /// The folder holds something else than a sweep.
    #[error("{}: {reason}; {remedy}", path.display())]
    Folder {
        path: PathBuf,
        /// What is wrong, as the rest of a sentence.
        reason: String,
        remedy: String,
    },
    #[error(
        "{}: another sweep is at work in this folder; wait until it is done, or name another folder",
        path.display()
    )]
    Locked { path: PathBuf },
    #[error("{}: there is no point {index}; the plan has points 1 to {points}", path.display())]
    NoPoint { path: PathBuf, index: usize, points: usize },
    #[error(
        "{}: point {index} is no longer what was planned: the experiment, a recording, a library or the program \
         has changed since; plan again with `aurt sweep plan`",
        path.display()
    )]
    Stale { path: PathBuf, index: usize },
    #[error("{}: cannot be read: {source}", path.display())]
    Read { path: PathBuf, source: std::io::Error },
    #[error("{}: cannot be written: {source}", path.display())]
    Write { path: PathBuf, source: std::io::Error },
    #[error("sbatch {problem}")]
    Slurm {
        /// What happened, as the rest of a sentence.
        problem: String,
    },
}

/// Why a point has no errors to show.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PointError {
    /// Recordings could not be read or preprocessed.
    #[error(transparent)]
    Recordings(#[from] aurt::Error),
    /// The rigid bodies or the robot model.
    #[error(transparent)]
    Model(#[from] aurt_plugins::model::Error),
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    #[error("the held-out recordings leave no rows to judge by")]
    NothingJudged,
    #[error("the program failed on this point: {0}")]
    Panic(String),
}

impl From<aurt_files::output::WriteError> for SweepError {
    fn from(error: aurt_files::output::WriteError) -> Self {
        Self::Write { path: error.path, source: error.source }
    }
}
