//! Detectors that can be asked alone: faults of recordings.

use aurt_recording::Recording;

use crate::error::DiagnosisError;
use crate::injection::prepared::Prepared;
use crate::investigation::repair_helps;
use crate::recordings::rows::Role;
use crate::request::{Question, QuestionedRecording};
use crate::verdict::Answer;
use crate::vocabulary::Effect;

/// A fault that recordings show.
#[derive(Debug, Clone, PartialEq)]
pub struct SeenFault {
    /// The effect.
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
        let asked = repaired.iter().filter(|r| r.role != Role::Validation);
        let faults: Vec<_> = asked
            .filter_map(|r| r.spoilt.as_ref())
            .flat_map(|s| s.faults.faults.iter().filter(|f| f.suffices).cloned())
            .collect();
        if faults.is_empty() {
            return Ok(Vec::new());
        }
        let named = match self.verdict().verdict {
            Answer::NoMismatch | Answer::HeldOutDiffers | Answer::Named => true,
            Answer::PartlyExplained | Answer::Unexplained => repair_helps(
                &Question { recordings: &recordings, ..*self.question },
                &Question { recordings: &repaired, ..*self.question },
            )?,
        };
        Ok(faults.into_iter().map(|f| SeenFault { effect: f.effect, joints: f.joints, named }).collect())
    }
}
