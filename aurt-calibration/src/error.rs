use std::path::PathBuf;

use aurt_recording::RecordingError;
use aurt_traits::ModelError;
use thiserror::Error;

/// What can go wrong in calibration, validation and prediction.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum CalibrationError {
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The recordings hold too few rows for the number of parameters (the paper asks for M > n_p).
    #[error(
        "{rows} samples per joint remain after filtering and decimation, but the model has {parameters} \
         parameters and requires more samples than parameters; record longer, raise `f_dyn_hz` (less decimation) or \
         use a smaller model"
    )]
    TooFewSamples { rows: usize, parameters: usize },
    /// A recording has no measurement although one is needed.
    #[error(
        "{}: no current or torque columns, which calibration and validation require; \
         name them `current_0 …` or `torque_0 …`, or map them with `columns = {{ measurement = … }}`",
        file.display()
    )]
    NoMeasurement { file: PathBuf },
    /// The robot has another number of joints than a recording.
    #[error("{}: the recording has {found} joints, but the model has {expected}", file.display())]
    Joints {
        file: PathBuf,
        /// Joints of the model.
        expected: usize,
        /// Joints of the recording.
        found: usize,
    },
    /// Two factors over different columns cannot be merged.
    #[error("factors over {left} and {right} columns cannot be merged")]
    Columns { left: usize, right: usize },
    #[error(transparent)]
    Prior(#[from] crate::consistent::PriorError),
    #[error(
        "no physically consistent bodies, rotors and friction were found for these recordings; `estimator = \"wls\"` \
         shows the unconstrained estimate"
    )]
    Inconsistent,
    /// Too little to hold something out.
    #[error(
        "`estimator = \"essential\"` holds out blocks of at least 2 s; the recordings give {found}, but {needed} are required; add \
         more or longer recordings"
    )]
    TooFewBlocks { found: usize, needed: usize },
    /// An estimator that looks at the rows again, of recordings that are read in stretches.
    #[error(
        "`estimator = \"{estimator}\"` requires whole recordings, but these are streamed; use `estimator = \"wls\"`, or raise \
         --stream-above"
    )]
    NeedsRows { estimator: &'static str },
    /// Too little of the unchanged machine to tell a change from its usual variation.
    #[error(
        "the experiment's recordings hold {found} whole windows of the unchanged machine, but {needed} are required to estimate \
         its normal variation; add recordings, or use shorter windows with --window-s"
    )]
    TooFewWindows { found: usize, needed: usize },
    #[error("no recording to calibrate on; list at least one under `[recordings] calibration`")]
    NothingToCalibrateOn,
    /// The fit produced a value that is not a number.
    #[error("the least-squares solution is not finite; the recordings contain impossible values")]
    NotFinite,
}
