use std::sync::Arc;

use aurt_calibration::{Calibration, CalibrationOptions, NamedRecording};
use aurt_recording::{PreprocessOptions, Recording, RecordingError, preprocess};
use aurt_traits::{MeasurementUnit, RobotModel, RobotNames};

use crate::error::DiagnosisError;
use crate::faults::RecordingFaults;
use crate::recordings::rows::{RecordingRows, Role};
use crate::recordings::unresolved::{leave_out_unresolved, position_cutoff_hz};
use crate::request::{CommonScale, SelectionOptions};
use crate::vocabulary::Effect;

/// A recording that takes part in a diagnosis.
#[derive(Debug, Clone)]
pub struct QuestionedRecording {
    /// Its part.
    pub role: Role,
    /// The recording as read. Copies of a question share it: of a long recording it is a good part of the memory.
    pub raw: Arc<Recording>,
    /// The recording, preprocessed with `options`.
    pub data: Arc<NamedRecording>,
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
    pub original: Arc<Recording>,
    pub faults: RecordingFaults,
    /// The value of each joint's measurement that never changes: what was logged there is no measurement, and the joint's
    /// rows do not count.
    pub constant: Vec<Option<f64>>,
    /// The rows of which little is left without the samples whose direction is not resolved, `[joint][row]`; they do not count.
    pub unresolved: Vec<Vec<bool>>,
}

impl QuestionedRecording {
    /// A recording as read, preprocessed.
    ///
    /// # Errors
    /// What preprocessing reports.
    pub fn new(
        role: Role,
        name: String,
        raw: Recording,
        options: PreprocessOptions,
    ) -> Result<Self, RecordingError> {
        let data = Arc::new(NamedRecording { name, data: preprocess(&raw, &options)? });
        Ok(Self { role, raw: Arc::new(raw), data, options, simulated: None, spoilt: None })
    }

    /// The recording's first stamp, s.
    pub(crate) fn origin_s(&self) -> f64 {
        self.raw.time_s.first().copied().unwrap_or(0.0)
    }

    /// Puts other samples in the place of the recording's, preprocessed as they were.
    pub(crate) fn replace(&mut self, raw: Recording) -> Result<(), RecordingError> {
        let data = preprocess(&raw, &self.options)?;
        self.data = Arc::new(NamedRecording { name: self.data.name.clone(), data });
        self.raw = Arc::new(raw);
        Ok(())
    }

    /// The recording as a diagnosis examines it: with its faults found and repaired, but for those of effects that are left
    /// out (`without`), the position filter's cut-off chosen where none is asked for, and the samples left out of all rows in
    /// which the direction of a joint's motion is not resolved.
    ///
    /// # Errors
    /// [`DiagnosisError::ConstantMeasurement`] where no joint's measurement ever changes; [`DiagnosisError::Branch`] where each
    /// contains a motion beside the chain; what preprocessing the repaired
    /// recording reports.
    pub fn repaired(&self, without: &[String]) -> Result<Self, DiagnosisError> {
        let constant: Vec<Option<f64>> =
            self.raw.measurement.iter().flatten().map(|series| constant(series)).collect();
        if let Some(Some(value)) = constant.first()
            && constant.iter().all(Option::is_some)
        {
            return Err(DiagnosisError::ConstantMeasurement {
                recording: self.data.name.clone(),
                first: *value,
            });
        }
        if let Some(branch) = self.raw.report.branches.iter().find(|branch| branch.moves)
            && (0..self.raw.joints()).all(|joint| self.contains_branch(joint))
        {
            let (recording, branch) = (self.data.name.clone(), branch.clone());
            return Err(DiagnosisError::Branch { recording, branch });
        }
        let faults = RecordingFaults::find_asked(&self.data.name, &self.raw, |e| considers(without, e));
        let mut repaired = self.clone();
        // A simulator's prediction belongs to the stamps as they are.
        if let Some(raw) = faults.repaired(&self.raw).filter(|_| self.simulated.is_none()) {
            repaired.replace(raw)?;
        }
        if let Some(cutoff_hz) = position_cutoff_hz(&repaired.raw, &repaired.data.data, &repaired.options)? {
            let options =
                PreprocessOptions { position_cutoff_hz: Some(cutoff_hz), ..repaired.options.clone() };
            repaired.preprocessed_anew(options)?;
        }
        let unresolved = Vec::new();
        repaired.spoilt = Some(Box::new(Spoilt { original: self.raw.clone(), faults, constant, unresolved }));
        repaired.leave_out_unresolved()?;
        Ok(repaired)
    }

    /// Preprocesses the recording again with other options.
    pub(crate) fn preprocessed_anew(&mut self, options: PreprocessOptions) -> Result<(), RecordingError> {
        let data = preprocess(&self.raw, &options)?;
        self.data = Arc::new(NamedRecording { name: self.data.name.clone(), data });
        self.options = options;
        self.leave_out_unresolved()
    }

    /// Leaves out the samples of a repaired recording in which a direction is not resolved.
    fn leave_out_unresolved(&mut self) -> Result<(), RecordingError> {
        if let Some(spoilt) = &mut self.spoilt {
            let data = &mut Arc::make_mut(&mut self.data).data;
            spoilt.unresolved = leave_out_unresolved(&self.raw, data, &self.options)?;
        }
        Ok(())
    }

    /// Whether a joint's measurement contains a motion beside the chain.
    fn contains_branch(&self, joint: usize) -> bool {
        self.raw.report.branches.iter().any(|branch| branch.upstream.contains(&joint))
    }

    /// Leaves out the rows that a fault has touched, those of which little is left around reversals, and all of a joint whose
    /// measurement never changes or contains a motion beside the chain.
    pub(crate) fn mask(&self, rows: &mut RecordingRows) {
        for (_, joint) in rows.joints.iter_mut().enumerate().filter(|(j, _)| self.contains_branch(*j)) {
            joint.counts.fill(false);
            joint.silence();
        }
        let (Some(spoilt), Some(segment)) = (&self.spoilt, self.data.data.segments.first()) else { return };
        let cutoff_hz = segment.parallel_filter.cutoff_hz();
        let faulty = spoilt.faults.faulty_rows(&spoilt.original, rows, cutoff_hz);
        for ((joint, faulty), unresolved) in rows.joints.iter_mut().zip(faulty).zip(&spoilt.unresolved) {
            for ((counts, faulty), unresolved) in joint.counts.iter_mut().zip(faulty).zip(unresolved) {
                *counts &= !faulty && !unresolved;
            }
            joint.silence();
        }
        for (joint, _) in rows.joints.iter_mut().zip(&spoilt.constant).filter(|(_, value)| value.is_some()) {
            joint.counts.fill(false);
            joint.silence();
        }
    }
}

/// The value of a series that never changes.
fn constant(series: &[f64]) -> Option<f64> {
    let first = *series.first()?;
    series.iter().all(|v| *v == first).then_some(first)
}

/// What a diagnosis is asked: a model, recordings, and what is taken as given.
#[derive(Debug)]
pub struct Question<'a> {
    /// The model's structure.
    pub model: &'a RobotModel,
    /// A calibrated model that is not to be recalibrated.
    pub frozen: Option<&'a Calibration>,
    pub recordings: &'a [QuestionedRecording],
    pub unit: MeasurementUnit,
    /// Frequency of the robot's dynamics, Hz.
    pub f_dyn_hz: f64,
    /// How calibration is done.
    pub calibration: CalibrationOptions,
    /// What an effect must bring.
    pub selection: SelectionOptions,
    /// Effects that are not to be considered (for proofs of `unexplained`).
    pub without: &'a [String],
    /// The scale that the recordings were brought to, if their currents have no torque constants and motion determines one.
    pub scale: Option<&'a CommonScale>,
}

impl Question<'_> {
    /// Names of the robot's joints and links.
    pub(crate) fn names(&self) -> RobotNames<'_> {
        self.model.names()
    }

    /// Whether an effect is considered.
    pub(crate) fn considers(&self, effect: &Effect) -> bool {
        considers(self.without, effect)
    }
}

/// Whether an effect is not among those that are left out.
fn considers(without: &[String], effect: &Effect) -> bool {
    !without.iter().any(|w| w == effect.id)
}
