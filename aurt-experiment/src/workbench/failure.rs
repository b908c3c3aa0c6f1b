//! Why a command failed.

use std::path::{Path, PathBuf};

use crate::ExperimentErrors;
use crate::sweep::SweepError;
use aurt_calibration::{CalibrationError, GainsError};
use aurt_diagnosis::DiagnosisError;
use aurt_export::ExportError;
use aurt_files::output::WriteError;
use aurt_plugins::BuildError;
use aurt_rbd::robots::RobotErrors;
use aurt_rbd::{MdhErrors, RbdError};
use aurt_recording::RecordingError;
use aurt_simulation::SimulationError;
use aurt_traits::ModelError;
use thiserror::Error;

#[derive(Debug, Error)]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum Failure {
    #[error(transparent)]
    Experiment(Box<ExperimentErrors>),
    /// What the library reports: robots, models, recordings, calibration, diagnosis.
    #[error(transparent)]
    Library(aurt::Error),
    /// A prediction of another simulator cannot be used.
    #[error("{}: {reason}; {remedy}", path.display())]
    Simulated { path: PathBuf, reason: String, remedy: String },
    /// A table of numbers is not what the command needs.
    #[error("{}{}: {reason}; {remedy}", path.display(), line.map(|l| format!(":{l}")).unwrap_or_default())]
    Table {
        path: PathBuf,
        /// The line, from 1, if it is about one.
        line: Option<usize>,
        /// The cell of that line, from 1, if it is about one.
        cell: Option<usize>,
        reason: String,
        remedy: String,
    },
    /// Something that a file asks for cannot be.
    #[error("{}: {failure}", path.display())]
    In { path: PathBuf, failure: Box<Failure> },
    #[error(transparent)]
    Export(#[from] ExportError),
    #[error("{option}: {} {reason}; {remedy}", path.display())]
    Output {
        option: &'static str,
        path: PathBuf,
        /// What is wrong, as the rest of the sentence.
        reason: String,
        remedy: String,
    },
    #[error(
        "{}: a value of line {line} is not a finite number, so nothing is written; the model, its coefficients or the \
         motion are far beyond those of a robot: look at them with `aurt check` and at the values in the model file",
        path.display()
    )]
    NotFinite { path: PathBuf, line: usize },
    /// Something needs whole recordings, but they are read in stretches.
    #[error("{reason}; {remedy}")]
    Stretches { path: Option<PathBuf>, reason: String, remedy: String },
    #[error(transparent)]
    Sweep(Box<SweepError>),
    #[error("{option}: {reason}; {remedy}")]
    Argument { option: &'static str, reason: String, remedy: String },
}

impl Failure {
    /// A file or a model is not what the command needs.
    pub fn unfit(path: impl Into<PathBuf>, reason: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Library(aurt::Error::Unfit { path: path.into(), reason: reason.into(), remedy: remedy.into() })
    }

    /// An argument does not go with the rest.
    pub fn argument(option: &'static str, reason: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Argument { option, reason: reason.into(), remedy: remedy.into() }
    }

    /// An output cannot be where it is asked for.
    pub fn output(
        option: &'static str,
        path: impl Into<PathBuf>,
        reason: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self::Output { option, path: path.into(), reason: reason.into(), remedy: remedy.into() }
    }

    pub fn write(path: impl Into<PathBuf>, source: std::io::Error) -> Self {
        Self::Library(aurt::Error::Write { path: path.into(), source })
    }

    /// The same, said of the file that asks for it where the failure is one of its values and names no file itself.
    pub fn of_value_in(self, path: &Path) -> Self {
        let is_value = match &self {
            Self::Library(aurt::Error::Recording(error)) => {
                matches!(**error, RecordingError::InvalidOption { .. })
            }
            Self::Library(aurt::Error::Calibration(error)) => {
                matches!(**error, CalibrationError::NothingToCalibrateOn)
            }
            _ => false,
        };
        if is_value { self.in_file(path) } else { self }
    }

    pub fn in_file(self, path: &Path) -> Self {
        let names_its_file = |error: &SimulationError| {
            matches!(error, SimulationError::Syntax { .. } | SimulationError::Io { .. })
        };
        match self {
            Self::Library(aurt::Error::Simulation(error)) if names_its_file(&error) => (*error).into(),
            other => Self::In { path: path.to_owned(), failure: Box::new(other) },
        }
    }
}

impl From<crate::Error> for Failure {
    fn from(error: crate::Error) -> Self {
        match error {
            crate::Error::Experiment(errors) => Self::Experiment(errors),
            crate::Error::Model(error) => error.into(),
        }
    }
}

impl From<SweepError> for Failure {
    fn from(error: SweepError) -> Self {
        match error {
            SweepError::Definition(errors) => Self::Experiment(errors),
            SweepError::Plugins(error) => error.into(),
            other => Self::Sweep(Box::new(other)),
        }
    }
}

macro_rules! of_library {
    ($($error:ty),+ $(,)?) => {$(
        impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::Library(error.into())
            }
        }
    )+};
}

of_library!(
    aurt::Error,
    aurt_plugins::model::Error,
    aurt_plugins::Error,
    CalibrationError,
    DiagnosisError,
    GainsError,
    MdhErrors,
    ModelError,
    RbdError,
    RecordingError,
    RobotErrors,
    SimulationError,
    Vec<BuildError>,
    Vec<ModelError>,
    WriteError,
);
