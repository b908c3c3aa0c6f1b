//! Why a command failed.

use std::path::{Path, PathBuf};

use aurt_calibration::{CalibrationError, GainsError};
use aurt_diagnosis::DiagnosisError;
use aurt_experiment::{BuildError, ExperimentErrors};
use aurt_export::ExportError;
use aurt_rbd::{MdhErrors, RbdError};
use aurt_recording::RecordingError;
use aurt_robots::RobotErrors;
use aurt_simulation::SimulationError;
use aurt_sweep::SweepError;
use aurt_traits::{MeasurementUnit, ModelError};
use thiserror::Error;

/// Why a command failed.
#[derive(Debug, Error)]
pub enum Failure {
    /// An experiment is wrong in one or more places.
    #[error(transparent)]
    Experiment(Box<ExperimentErrors>),
    /// Models, experiments or model files.
    #[error(transparent)]
    Plugins(aurt_experiment::Error),
    /// Model options on the command line do not give models.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Build(Vec<BuildError>),
    /// The table of modified Denavit–Hartenberg parameters.
    #[error(transparent)]
    Mdh(#[from] MdhErrors),
    /// The rigid bodies.
    #[error(transparent)]
    Rbd(RbdError),
    /// The description of a robot.
    #[error(transparent)]
    Robot(#[from] RobotErrors),
    /// A recording.
    #[error(transparent)]
    Recording(Box<RecordingError>),
    /// Calibration, validation or prediction.
    #[error(transparent)]
    Calibration(Box<CalibrationError>),
    /// Gains of the drives.
    #[error(transparent)]
    Gains(Box<GainsError>),
    /// A simulation.
    #[error(transparent)]
    Simulation(Box<SimulationError>),
    /// A diagnosis.
    #[error(transparent)]
    Diagnosis(Box<DiagnosisError>),
    /// A prediction of another simulator cannot be used.
    #[error("{}: {reason}; {remedy}", path.display())]
    Simulated {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
        /// What to do.
        remedy: String,
    },
    /// A table of numbers is not what the command needs.
    #[error("{}{}: {reason}; {remedy}", path.display(), line.map(|l| format!(":{l}")).unwrap_or_default())]
    Table {
        /// The file.
        path: PathBuf,
        /// The line, from 1, if it is about one.
        line: Option<usize>,
        /// The cell of that line, from 1, if it is about one.
        cell: Option<usize>,
        /// What is wrong.
        reason: String,
        /// What to do.
        remedy: String,
    },
    /// Something that a file asks for cannot be.
    #[error("{}: {failure}", path.display())]
    In {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        failure: Box<Failure>,
    },
    /// A model cannot be exported.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// A robot model cannot be composed.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Models(Vec<ModelError>),
    /// An output cannot be where it is asked for.
    #[error("{option}: {} {reason}; {remedy}", path.display())]
    Output {
        /// The option that names it.
        option: &'static str,
        /// The path.
        path: PathBuf,
        /// What is wrong, as the rest of the sentence.
        reason: String,
        /// What to do.
        remedy: String,
    },
    /// An output could not be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A result is no number.
    #[error(
        "{}: a value of line {line} is not a finite number, so nothing is written; the model, its coefficients or the \
         motion are far beyond those of a robot: look at them with `aurt check` and at the values in the model file",
        path.display()
    )]
    NotFinite {
        /// The file that was to be written.
        path: PathBuf,
        /// The line of it.
        line: usize,
    },
    /// A model file is not what the command needs.
    #[error("{}: {reason}; {remedy}", path.display())]
    ModelFile {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        reason: String,
        /// What to do.
        remedy: String,
    },
    /// Recordings of one experiment measure different quantities.
    #[error(
        "{} is in {}, but {} is in {}; one model has one unit: declare `unit` for the recording whose columns \
         are misread, convert with `torque_constants_nm_per_a`, or calibrate them separately",
        first.display(), first_unit.symbol(), other.display(), other_unit.symbol()
    )]
    MixedUnits {
        /// A recording.
        first: PathBuf,
        /// Its unit.
        first_unit: MeasurementUnit,
        /// Another recording.
        other: PathBuf,
        /// Its unit.
        other_unit: MeasurementUnit,
    },
    /// Something needs whole recordings, but they are read in stretches.
    #[error("{reason}; {remedy}")]
    Stretches {
        /// The recording, if it is one.
        path: Option<PathBuf>,
        /// What is wrong, and why they are not read whole.
        reason: String,
        /// What to do.
        remedy: String,
    },
    /// A sweep.
    #[error(transparent)]
    Sweep(Box<SweepError>),
    /// An argument does not go with the rest.
    #[error("{option}: {reason}; {remedy}")]
    Argument {
        /// The option.
        option: &'static str,
        /// What is wrong.
        reason: String,
        /// What to do.
        remedy: String,
    },
}

impl From<aurt_experiment::Error> for Failure {
    fn from(error: aurt_experiment::Error) -> Self {
        match error {
            aurt_experiment::Error::Experiment(errors) => Self::Experiment(errors),
            aurt_experiment::Error::RigidBody(error) => error.into(),
            aurt_experiment::Error::Assembly(errors) => Self::Models(errors),
            other => Self::Plugins(other),
        }
    }
}

impl Failure {
    /// The same, said of the file that asks for it where the failure is one of its values and names no file itself.
    pub fn of_value_in(self, path: &Path) -> Self {
        let is_value = match &self {
            Self::Recording(error) => matches!(**error, RecordingError::InvalidOption { .. }),
            Self::Calibration(error) => matches!(**error, CalibrationError::NothingToCalibrateOn),
            _ => false,
        };
        if is_value { self.in_file(path) } else { self }
    }

    /// The same, said of the file that asks for it.
    pub fn in_file(self, path: &Path) -> Self {
        match self {
            // These name their file already.
            Self::Simulation(error)
                if matches!(*error, SimulationError::Syntax { .. } | SimulationError::Io { .. }) =>
            {
                Self::Simulation(error)
            }
            other => Self::In { path: path.to_owned(), failure: Box::new(other) },
        }
    }
}

impl From<aurt_plugins::Error> for Failure {
    fn from(error: aurt_plugins::Error) -> Self {
        match error {
            aurt_plugins::Error::Write { path, source } => Self::Write { path, source },
            other => Self::Plugins(other.into()),
        }
    }
}

impl From<ModelError> for Failure {
    fn from(error: ModelError) -> Self {
        Self::Models(vec![error])
    }
}

impl From<RbdError> for Failure {
    fn from(error: RbdError) -> Self {
        match error {
            RbdError::Mdh(errors) => Self::Mdh(errors),
            other => Self::Rbd(other),
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

impl From<DiagnosisError> for Failure {
    fn from(error: DiagnosisError) -> Self {
        Self::Diagnosis(Box::new(error))
    }
}

impl From<SimulationError> for Failure {
    fn from(error: SimulationError) -> Self {
        Self::Simulation(Box::new(error))
    }
}

impl From<RecordingError> for Failure {
    fn from(error: RecordingError) -> Self {
        Self::Recording(Box::new(error))
    }
}

impl From<CalibrationError> for Failure {
    fn from(error: CalibrationError) -> Self {
        match error {
            CalibrationError::Recording(error) => error.into(),
            other => Self::Calibration(Box::new(other)),
        }
    }
}
