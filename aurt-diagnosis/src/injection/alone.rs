//! Detectors that can be asked alone: faults of recordings.

use aurt_recording::Recording;

use crate::error::DiagnosisError;
use crate::injection::prepared::Prepared;
use crate::investigation::JudgedFaults;
use crate::recordings::rows::Role;
use crate::request::{Question, QuestionedRecording};
use crate::verdict::Answer;
use crate::vocabulary::Effect;

/// A fault that recordings show.
#[derive(Debug, Clone, PartialEq)]
pub struct SeenFault {
    pub effect: &'static Effect,
    /// The joints concerned.
    pub joints: Vec<usize>,
    /// Whether the diagnosis names it: nothing else is said of the recordings as they are, or the repair improves the fit.
    pub named: bool,
}

impl Prepared<'_> {
    /// The faults of altered recordings, as read, in the order of the question's, that suffice to explain a mismatch.
    ///
    /// # Errors
    /// What preprocessing reports.
    pub fn faults_of(&self, altered: &[Recording]) -> Result<Vec<SeenFault>, DiagnosisError> {
        let mut recordings: Vec<QuestionedRecording> = Vec::new();
        for (recording, raw) in self.question.recordings.iter().zip(altered) {
            let mut seen = recording.clone();
            if raw.samples() > 0 {
                seen.replace(raw.clone())?;
            }
            recordings.push(seen);
        }
        let without = self.question.without;
        let repaired = recordings.iter().map(|r| r.repaired(without)).collect::<Result<Vec<_>, _>>()?;
        let judged = JudgedFaults::new(
            &Question { recordings: &recordings, ..*self.question },
            &Question { recordings: &repaired, ..*self.question },
        )?;
        let named = match self.verdict().verdict {
            Answer::NoMismatch | Answer::HeldOutDiffers | Answer::Named => true,
            Answer::PartlyExplained | Answer::Unexplained => judged.matter,
        };
        let is_asked =
            |name: &str| recordings.iter().any(|r| r.role != Role::Validation && r.data.name == name);
        let sufficient = judged.faults.into_iter().filter(|f| f.suffices && is_asked(&f.recording));
        Ok(sufficient.map(|f| SeenFault { effect: f.effect, joints: f.joints, named }).collect())
    }
}
