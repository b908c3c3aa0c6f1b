use crate::Experiment;
use aurt_calibration::{CalibrationOptions, NamedRecording, ShapeOptions, ValidatedRows};
use aurt_traits::MeasurementUnit;

use crate::sweep::PointError;
use crate::sweep::definition::Validate;

/// The recordings of an experiment, preprocessed.
#[derive(Debug, Clone)]
pub struct Data {
    pub calibration: Vec<NamedRecording>,
    /// To be judged on: the validation recordings, or with `leave_one_out` the calibration recordings in their order,
    /// preprocessed as validation recordings are.
    pub judged: Vec<NamedRecording>,
    pub unit: MeasurementUnit,
    pub warnings: Vec<String>,
}

/// How a point is fitted and judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    pub calibration: CalibrationOptions,
    pub shapes: ShapeOptions,
    /// The rows of a held-out recording that count.
    pub rows: ValidatedRows,
}

/// Reads recordings as `aurt run` does; the sweep itself reads none.
pub trait Loader: Sync {
    /// Reads and preprocesses the recordings of an experiment.
    fn load(&self, experiment: &Experiment, validate: Validate) -> Result<Data, PointError>;

    fn settings(&self, experiment: &Experiment) -> Settings;
}
