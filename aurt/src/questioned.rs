//! Recordings as a diagnosis takes them.

use std::sync::Arc;

use aurt_diagnosis::{Question, QuestionedRecording, Role};
use aurt_recording::{Recording, RobotJoints};

use crate::data::{Loaded, Pipeline, Purpose, Source};
use crate::error::Error;

/// What a diagnosis is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Asked {
    /// What a structure or a given model lacks; there is no target.
    Lack,
    /// What targets show in comparison with other recordings: a change is told from what all recordings show.
    Change,
    /// What targets show beyond a given model or simulator; there are no other recordings.
    Beyond,
}

impl Asked {
    /// Of a question, as its recordings have it.
    pub fn of(question: &Question<'_>) -> Self {
        let has = |role| question.recordings.iter().any(|r| r.role == role);
        match (has(Role::Target), has(Role::Calibration)) {
            (true, true) => Self::Change,
            (true, false) => Self::Beyond,
            (false, _) => Self::Lack,
        }
    }
}

/// A recording with its part in a diagnosis.
#[derive(Debug, Clone)]
pub struct Part {
    /// Where the recording is from.
    pub source: Source,
    /// The recording.
    pub recording: Recording,
    /// Its part.
    pub role: Role,
    /// What another simulator predicts for it, `[joint][sample]`, where that is compared instead of a model.
    pub simulated: Option<Vec<Vec<f64>>>,
}

impl Part {
    /// The recording with the joints of a robot.
    pub(crate) fn loaded(&self, joints: &RobotJoints) -> Result<Loaded, Error> {
        Ok(Loaded { source: self.source.clone(), recording: self.recording.clone().of_robot(joints)? })
    }

    pub(crate) fn questioned(
        &self,
        loaded: Loaded,
        pipeline: &Pipeline<'_>,
    ) -> Result<QuestionedRecording, Error> {
        let Self { role, simulated, .. } = self;
        // A target in which the arm stands has no motion to be trimmed to; it can show a contact all the same.
        let trimmed = pipeline.preprocess_as_read(&loaded, Purpose::Calibration);
        let (data, purpose) = match trimmed {
            Err(_) if *role == Role::Target => {
                (pipeline.preprocess_as_read(&loaded, Purpose::Validation).or(trimmed)?, Purpose::Validation)
            }
            trimmed => (trimmed?, Purpose::Calibration),
        };
        let options = pipeline.options(loaded.recording.unit, purpose);
        let raw = match loaded.source.window_s.filter(|_| simulated.is_none()) {
            Some(window) => loaded.recording.window(window)?,
            None => loaded.recording.into(),
        };
        Ok(QuestionedRecording {
            role: *role,
            raw: Arc::new(raw),
            data: Arc::new(data),
            options,
            simulated: simulated.clone(),
            spoilt: None,
        })
    }
}
