use aurt_calibration::{Calibration, CalibrationOptions, NamedRecording};
use aurt_recording::{PreprocessOptions, Recording};
use aurt_traits::{MeasurementUnit, RobotModel};

use crate::{Role, SelectionOptions};

/// A recording that takes part in a diagnosis.
#[derive(Debug, Clone)]
pub struct QuestionedRecording {
    /// Its part.
    pub role: Role,
    /// The recording as read.
    pub raw: Recording,
    /// The recording, preprocessed with `options`.
    pub data: NamedRecording,
    /// How it was preprocessed.
    pub options: PreprocessOptions,
    /// What another simulator predicts for it at its own time stamps, `[joint][sample]`; the question is then
    /// what that simulator lacks.
    pub simulated: Option<Vec<Vec<f64>>>,
}

/// What a diagnosis is asked: a model, recordings, and what is taken as given.
#[derive(Debug)]
pub struct Question<'a> {
    /// The model's structure.
    pub model: &'a RobotModel,
    /// A calibrated model that is not to be recalibrated.
    pub frozen: Option<&'a Calibration>,
    /// The recordings.
    pub recordings: &'a [QuestionedRecording],
    /// Unit of the measurement.
    pub unit: MeasurementUnit,
    /// Frequency of the robot's dynamics, Hz.
    pub f_dyn_hz: f64,
    /// How calibration is done.
    pub calibration: CalibrationOptions,
    /// What an effect must bring.
    pub selection: SelectionOptions,
    /// Effects that are not to be considered (for proofs of `unexplained`).
    pub without: &'a [String],
}
