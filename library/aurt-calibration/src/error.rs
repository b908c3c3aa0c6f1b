use std::path::PathBuf;

use aurt_recording::RecordingError;
use aurt_traits::ModelError;
use thiserror::Error;

/// What can go wrong in calibration, validation and prediction.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// A model could not be evaluated.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A recording could not be preprocessed.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The recordings hold too few rows for the number of parameters (the paper asks for M > n_p).
    #[error(
        "{rows} samples per joint are left after filtering and decimation, but the model has {parameters} \
         parameters and needs more samples than that; record longer, raise `f_dyn_hz` (less decimation) or \
         use a smaller model"
    )]
    TooFewSamples {
        /// Rows per joint.
        rows: usize,
        /// Number of parameters n_p.
        parameters: usize,
    },
    /// A recording has no measurement although one is needed.
    #[error(
        "{}: no current or torque columns, but calibration and validation compare with a measurement; \
         name them `current_0 …` or `torque_0 …`, or map them with `columns = {{ measurement = … }}`",
        file.display()
    )]
    NoMeasurement {
        /// The recording.
        file: PathBuf,
    },
    /// The robot has another number of joints than a recording.
    #[error("{}: the recording has {found} joints, the model {expected}", file.display())]
    Joints {
        /// The recording.
        file: PathBuf,
        /// Joints of the model.
        expected: usize,
        /// Joints of the recording.
        found: usize,
    },
    /// Two factors over different columns cannot be merged.
    #[error("factors over {left} and {right} columns cannot be merged")]
    Columns {
        /// Columns of the one.
        left: usize,
        /// Columns of the other.
        right: usize,
    },
    /// A prior that cannot be used.
    #[error(transparent)]
    Prior(#[from] crate::consistent::PriorError),
    /// No consistent estimate was found.
    #[error(
        "no machine was found whose bodies, rotors and friction are physically possible beside these recordings;          `estimator = \"wls\"` shows what least squares makes of them"
    )]
    Inconsistent,
    /// A recording that a model was fitted to cannot judge it.
    #[error(
        "{} holds the same samples as {}, which the model is calibrated on: errors on it would be those of the fit. Hold out \
         another recording, or give both a `window_s` and let these not overlap",
        validation.display(), calibration.display()
    )]
    Repeated {
        /// The one that is to judge.
        validation: PathBuf,
        /// The one that was fitted.
        calibration: PathBuf,
    },
    /// Noise of the positions cannot be told from the motion.
    #[error(
        "noise of the positions makes up {percent:.0} % of the power of joint {joint}'s accelerations, and what is left determines \
         no parameters; lower f_dyn, or use `estimator = \"wls\"`"
    )]
    NoisyPositions {
        /// The noisiest joint.
        joint: usize,
        /// Its share of noise.
        percent: f64,
    },
    /// Too little to hold something out.
    #[error(
        "`estimator = \"essential\"` holds out blocks of at least 2 s, and the recordings make {found}, of which {needed} are \
         needed; list more or longer recordings"
    )]
    TooFewBlocks {
        /// Blocks that there are.
        found: usize,
        /// Blocks that are needed.
        needed: usize,
    },
    /// An estimator that looks at the rows again, of recordings that are read in stretches.
    #[error(
        "`estimator = \"{estimator}\"` needs whole recordings, and these are read in stretches; use `estimator = \"wls\"`, or \
             raise --stream-above"
    )]
    NeedsRows {
        /// The estimator.
        estimator: &'static str,
    },
    /// Too little of the unchanged machine to tell a change from its usual variation.
    #[error(
        "the experiment's recordings hold {found} whole windows of the unchanged machine, and {needed} are needed to tell how \
         much it varies anyway; list more recordings of it, or make windows shorter with --window-s"
    )]
    TooFewWindows {
        /// Windows that there are.
        found: usize,
        /// Windows that are needed.
        needed: usize,
    },
    /// Nothing to calibrate on.
    #[error("there is no recording to calibrate on; list at least one under `[recordings] calibration`")]
    NothingToCalibrateOn,
    /// The fit produced a value that is not a number.
    #[error("the least-squares solution is not finite; the recordings hold values that no robot produces")]
    NotFinite,
}
