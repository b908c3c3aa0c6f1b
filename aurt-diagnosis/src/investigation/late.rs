//! Measurements that come late, or positions that do: found by shifting them, and undone.
//!
//! A column −τ̇ says where to look, not what is there: friction that builds up after reversals, elastic gears and inertia
//! look like it to first order. The measurement itself, shifted by one delay after the other, does not: what a model
//! leaves has a minimum at the true delay, on most joints, with friction that lags and rotors allowed for on all of them.

use crate::error::DiagnosisError;
use crate::investigation::Investigation;
use crate::investigation::delay_scan::{Scan, is_delay};
use crate::recordings::rows::Role;
use crate::request::{Question, QuestionedRecording};

pub use crate::investigation::delay_scan::Delay;

/// A delay that was undone, and the investigation that found it.
#[derive(Debug)]
pub struct Late {
    pub delay: Delay,
    /// What was found before it was undone.
    pub before: Box<Investigation>,
}

impl Investigation {
    /// Whether a delay is among what was selected.
    pub(crate) fn is_late(&self) -> bool {
        self.selection.chosen.iter().any(|c| is_delay(self, &self.groups[c.group]))
    }
}

impl Delay {
    /// The delay of all recordings, or of the targets alone, at which the model and what was found leave least.
    pub(crate) fn found(
        question: &Question<'_>,
        investigation: &Investigation,
    ) -> Result<Option<Self>, DiagnosisError> {
        let problem = &investigation.problem;
        // Rows are of repaired recordings.
        let recordings = question
            .recordings
            .iter()
            .map(|r| r.repaired(question.without))
            .collect::<Result<Vec<_>, _>>()?;
        let question = &Question { recordings: &recordings, ..*question };
        let scan = |target_only| Scan::new(question, investigation, target_only).delay();
        let in_all = problem.has_reference() || !problem.has_target();
        let found = [in_all.then(|| scan(false)), problem.has_target().then(|| scan(true))];
        Ok(found.into_iter().flatten().flatten().max_by(|a, b| a.score.total_cmp(&b.score)))
    }

    /// The recordings with the delay undone.
    pub(crate) fn undone(&self, question: &Question<'_>) -> Result<Vec<QuestionedRecording>, DiagnosisError> {
        question
            .recordings
            .iter()
            .map(|recording| {
                let mut shifted = recording.clone();
                if self.target_only && recording.role == Role::Calibration {
                    return Ok(shifted);
                }
                let mut options = recording.options.clone();
                let delays = options.delay_s.get_or_insert_with(|| vec![0.0; question.model.joints()]);
                delays.iter_mut().for_each(|delay| *delay += self.delay_s);
                shifted.preprocessed_anew(options)?;
                Ok(shifted)
            })
            .collect()
    }
}
