use aurt_calibration::{Calibration, CalibrationOptions, NamedRecording};
use aurt_recording::{PreprocessOptions, Recording, preprocess};
use aurt_traits::{MeasurementUnit, RobotModel};

use crate::error::DiagnosisError;
use crate::recordings::faults::RecordingFaults;
use crate::recordings::rows::{RecordingRows, Role};
use crate::request::SelectionOptions;

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
    /// What is wrong with the recording, once that was looked for; `raw` and `data` are then repaired.
    pub spoilt: Option<Box<Spoilt>>,
}

/// A recording's faults, and the recording before its repair.
#[derive(Debug, Clone)]
pub struct Spoilt {
    /// The recording as read.
    pub original: Recording,
    /// Its faults.
    pub faults: RecordingFaults,
}

impl QuestionedRecording {
    /// The recording with its faults found and repaired.
    ///
    /// # Errors
    /// What preprocessing the repaired recording reports.
    pub(crate) fn repaired(&self) -> Result<Self, DiagnosisError> {
        let faults = RecordingFaults::find(&self.data.name, &self.raw);
        let mut repaired = self.clone();
        // A simulator's prediction belongs to the stamps as they are.
        if let Some(raw) = faults.repaired(&self.raw).filter(|_| self.simulated.is_none()) {
            repaired.data.data = preprocess(&raw, &self.options)?;
            repaired.raw = raw;
        }
        repaired.spoilt = Some(Box::new(Spoilt { original: self.raw.clone(), faults }));
        Ok(repaired)
    }

    /// Leaves out the rows that a fault has touched.
    pub(crate) fn mask(&self, rows: &mut RecordingRows) {
        let (Some(spoilt), Some(segment)) = (&self.spoilt, self.data.data.segments.first()) else { return };
        let cutoff_hz = segment.parallel_filter.cutoff_hz();
        let faulty = spoilt.faults.faulty_rows(&spoilt.original, rows, cutoff_hz);
        for (joint, faulty) in rows.joints.iter_mut().zip(faulty) {
            for (counts, faulty) in joint.counts.iter_mut().zip(faulty) {
                *counts &= !faulty;
            }
            joint.silence();
        }
    }
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
