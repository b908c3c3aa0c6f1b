use aurt_calibration::CalibrationError;
use aurt_recording::{BranchMotion, RecordingError};
use aurt_traits::ModelError;
use thiserror::Error;

/// What can go wrong in a diagnosis.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DiagnosisError {
    /// A recording has nothing to compare with.
    #[error("{recording}: no current or torque columns; a diagnosis compares a model with a measurement")]
    NoMeasurement { recording: String },
    /// No recording takes part.
    #[error(
        "there is nothing to diagnose: list recordings under `[recordings] calibration`, and under `target` \
         those that show what the model lacks"
    )]
    NothingToDiagnose,
    /// What is in question is too short for any judgement.
    #[error(
        "{recording}: {length_s:.1} s of motion are too short: at least {needed_s:.1} s are needed for \
         held-out validation; record longer, or raise `f_dyn_hz` under [diagnosis]"
    )]
    Brief {
        /// The recording, the longest of its kind.
        recording: String,
        /// How long it is, s.
        length_s: f64,
        /// How long it has to be, s.
        needed_s: f64,
    },
    /// The measurement of no joint ever changes.
    #[error(
        "{recording}: the measurement of every joint is constant (joint 0: {first}); no current or torque was logged; check \
         which columns `measurement` names"
    )]
    ConstantMeasurement {
        recording: String,
        /// The value of joint 0.
        first: f64,
    },
    /// Every joint's measurement contains a motion that no model of the chain has, or the base stands elsewhere than in the first.
    #[error("{recording}: {branch}")]
    Branch {
        recording: String,
        /// The first joint beside the chain that moves.
        branch: BranchMotion,
    },
    /// A figure of a verdict is not a number.
    #[error(
        "{figure} is not a finite number: the recordings do not determine it; record longer, or motions of all joints"
    )]
    NotFinite {
        /// Which one.
        figure: String,
    },
    /// A candidate term does not fit the robot.
    #[error("candidate of effect `{effect}`: {reason}")]
    Candidate {
        effect: &'static str,
        /// What was said of it.
        reason: String,
    },
    /// A file of what was learnt from proofs cannot be used.
    #[error("{}: {reason}; write it with `aurt-lab prove --learn`", path.display())]
    Learnt {
        /// The file.
        path: std::path::PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// The experiment's text could not be extended.
    #[error("the improved experiment could not be written: {reason}")]
    Improvement {
        /// Why.
        reason: String,
    },
    /// Calibration failed.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// Drives could not be estimated or simulated.
    #[error(transparent)]
    Drive(#[from] aurt_calibration::drives::DriveError),
    /// Preprocessing failed.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A model failed.
    #[error(transparent)]
    Model(#[from] ModelError),
}
