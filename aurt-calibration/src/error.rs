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
    #[error(
        "{rows} samples per joint remain after filtering and decimation, but the model has {parameters} \
         parameters and requires more samples than parameters; record longer, raise `f_dyn_hz` (less decimation) or \
         use a smaller model"
    )]
    TooFewSamples { rows: usize, parameters: usize },
    #[error(
        "{}: no current or torque columns, which calibration and validation require; \
         name them `current_0 …` or `torque_0 …`, or map them with `columns = {{ measurement = … }}`",
        file.display()
    )]
    NoMeasurement { file: PathBuf },
    #[error("{}: the recording has {found} joints, but the model has {expected}", file.display())]
    Joints { file: PathBuf, expected: usize, found: usize },
    #[error("factors over {left} and {right} columns cannot be merged")]
    Columns { left: usize, right: usize },
    #[error(transparent)]
    Prior(#[from] crate::consistent::PriorError),
    #[error(
        "no physically consistent bodies, rotors and friction were found for these recordings; `estimator = \"wls\"` \
         shows the unconstrained estimate"
    )]
    Inconsistent,
    #[error(
        "`estimator = \"essential\"` holds out blocks of at least 2 s; the recordings give {found}, but {needed} are required; add \
         more or longer recordings"
    )]
    TooFewBlocks { found: usize, needed: usize },
    #[error(
        "`estimator = \"{estimator}\"` requires whole recordings, but these are streamed; use `estimator = \"wls\"`, or raise \
         --stream-above"
    )]
    NeedsRows { estimator: &'static str },
    #[error(
        "the experiment's recordings hold {found} whole windows of the unchanged machine, but {needed} are required to estimate \
         its normal variation; add recordings, or use shorter windows with --window-s"
    )]
    TooFewWindows { found: usize, needed: usize },
    #[error("no recording to calibrate on; list at least one under `[recordings] calibration`")]
    NothingToCalibrateOn,
    #[error("the least-squares solution is not finite; the recordings contain impossible values")]
    NotFinite,
}
