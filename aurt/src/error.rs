//! Why something failed.

use std::path::PathBuf;

use aurt_calibration::{CalibrationError, GainsError};
use aurt_diagnosis::DiagnosisError;
use aurt_files::output::WriteError;
use aurt_plugins::BuildError;
use aurt_rbd::robots::RobotErrors;
use aurt_rbd::{MdhErrors, RbdError};
use aurt_recording::RecordingError;
use aurt_traits::{MeasurementUnit, ModelError};

use crate::likeness::Likeness;

/// What samples that are used twice would do.
fn consequence(role: &str, other: &str) -> &'static str {
    if role == other {
        ": each sample counts once, or deviations come out too small"
    } else {
        ", so it is not held-out data: a model is not judged by samples that it was made from"
    }
}

/// Why something failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum Error {
    /// A robot, its models, or a file that holds them.
    #[error(transparent)]
    Model(Box<aurt_plugins::model::Error>),
    #[error(transparent)]
    Recording(Box<RecordingError>),
    #[error(transparent)]
    Calibration(Box<CalibrationError>),
    #[error(transparent)]
    Gains(Box<GainsError>),
    #[cfg(feature = "simulation")]
    #[error(transparent)]
    Simulation(Box<aurt_simulation::SimulationError>),
    #[error(transparent)]
    Diagnosis(Box<DiagnosisError>),
    /// A file or a model is not what is needed here.
    #[error("{}: {reason}; {remedy}", path.display())]
    Unfit {
        /// The file, or what stands for it.
        path: PathBuf,
        reason: String,
        remedy: String,
    },
    /// Recordings of one model measure different quantities.
    #[error(
        "{} is in {}, but {} is in {}; one model has one unit: declare `unit` for the recording whose columns \
         are misread, convert with `torque_constants_nm_per_a`, or calibrate them separately",
        first.display(), first_unit.symbol(), other.display(), other_unit.symbol()
    )]
    MixedUnits { first: PathBuf, first_unit: MeasurementUnit, other: PathBuf, other_unit: MeasurementUnit },
    /// One recording holds samples of another.
    #[error(
        "{} ({role}) {likeness} {} ({other_role}){}; name another recording, or give both a `window_s` that do not \
         overlap",
        recording.display(), other.display(), consequence(role, other_role)
    )]
    Repeated {
        recording: PathBuf,
        role: &'static str,
        other: PathBuf,
        other_role: &'static str,
        likeness: Likeness,
    },
    #[error(
        "the model is in {}, the recordings are in {}; with `torque_constants_nm_per_a` currents become torques; a model in A \
         goes with recordings in A", given.symbol(), recorded.symbol()
    )]
    GivenUnit { given: MeasurementUnit, recorded: MeasurementUnit },
    /// A file could not be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Write { path: PathBuf, source: std::io::Error },
}

impl From<aurt_plugins::model::Error> for Error {
    fn from(error: aurt_plugins::model::Error) -> Self {
        match error {
            aurt_plugins::model::Error::Write { path, source } => Self::Write { path, source },
            other => Self::Model(Box::new(other)),
        }
    }
}

/// Errors of robots and models.
macro_rules! of_model {
    ($($error:ty),+) => {$(
        impl From<$error> for Error {
            fn from(error: $error) -> Self {
                aurt_plugins::model::Error::from(error).into()
            }
        }
    )+};
}

of_model!(aurt_plugins::Error, RbdError, MdhErrors, RobotErrors, Vec<BuildError>, Vec<ModelError>);

impl From<ModelError> for Error {
    fn from(error: ModelError) -> Self {
        vec![error].into()
    }
}

impl From<RecordingError> for Error {
    fn from(error: RecordingError) -> Self {
        Self::Recording(Box::new(error))
    }
}

impl From<CalibrationError> for Error {
    fn from(error: CalibrationError) -> Self {
        match error {
            CalibrationError::Recording(error) => error.into(),
            other => Self::Calibration(Box::new(other)),
        }
    }
}

impl From<GainsError> for Error {
    fn from(error: GainsError) -> Self {
        match error {
            GainsError::Calibration(error) => error.into(),
            other => Self::Gains(Box::new(other)),
        }
    }
}

#[cfg(feature = "simulation")]
impl From<aurt_simulation::SimulationError> for Error {
    fn from(error: aurt_simulation::SimulationError) -> Self {
        Self::Simulation(Box::new(error))
    }
}

impl From<DiagnosisError> for Error {
    fn from(error: DiagnosisError) -> Self {
        Self::Diagnosis(Box::new(error))
    }
}

impl From<WriteError> for Error {
    fn from(error: WriteError) -> Self {
        Self::Write { path: error.path, source: error.source }
    }
}
