//! Measurements that come late: found as a column, undone by shifting.

use aurt_recording::preprocess;

use crate::error::DiagnosisError;
use crate::evidence::baseline::weighted_fit;
use crate::hypotheses::effects::Addition;
use crate::hypotheses::group::Switch;
use crate::investigation::Investigation;
use crate::recordings::rows::{Instrument, Role};
use crate::request::{Question, QuestionedRecording};

/// How late the measurement is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delay {
    /// By how much, s.
    pub delay_s: f64,
    /// Its standard deviation, s.
    pub std_s: f64,
    /// Evidence in nats.
    pub score: f64,
    /// Whether only the target recordings are late.
    pub target_only: bool,
}

/// A delay that was undone, and the investigation that found it.
#[derive(Debug)]
pub struct Late {
    /// The delay.
    pub delay: Delay,
    /// What was found before it was undone.
    pub before: Box<Investigation>,
}

/// What an investigation says of delays.
pub(crate) enum Found {
    /// Nothing.
    Nothing,
    /// A delay.
    Delay(Delay),
    /// Something that friction shows at reversals, and the rigid bodies' torque does not: no delay.
    OnlyFriction,
    /// Something that a few joints show: no delay of the clock that stamps them all.
    FewJoints,
}

/// A joint shows a delay that lowers its error by this share, in log-MSE …
const SHOWN: f64 = 0.02;
/// … and so must this share of the joints.
const JOINTS_SHARE: f64 = 0.5;

/// A delay is one if the rigid bodies' torque is late by at least this share of what all of it is, …
const RIGID_SHARE: f64 = 0.5;
/// … or by no less than this many standard deviations below that.
const RIGID_STD: f64 = 2.0;

impl Delay {
    /// The delay among what an investigation has selected.
    pub(crate) fn found(investigation: &Investigation) -> Found {
        let instrument = |group: usize| match investigation.candidates[investigation.groups[group].candidate]
            .proposal
            .addition
        {
            Addition::Instrument(_, which @ (Instrument::Delay | Instrument::DelayOfAll)) => Some(which),
            _ => None,
        };
        let chosen = &investigation.selection.chosen;
        let Some((one, which)) = chosen.iter().find_map(|c| Some((c, instrument(c.group)?))) else {
            return Found::Nothing;
        };
        let shown = one.joint_loss.iter().filter(|loss| **loss > SHOWN).count();
        if (shown as f64) < JOINTS_SHARE * one.joint_loss.len() as f64 {
            return Found::FewJoints;
        }
        let target_only = investigation.groups[one.group].target_only();
        let mut all = investigation.switches();
        let place = |all: &[Switch], which: Instrument| {
            let column = investigation.layout.instrument(0, which);
            all.iter().position(|s| s.column == column && s.target_only == target_only)
        };
        let share = investigation.mean_independent_share.max(f64::MIN_POSITIVE);
        let (fit, _) = weighted_fit(&investigation.problem, &all, &investigation.floor);
        let Some(own) = place(&all, which) else { return Found::Nothing };
        let (delay_s, std_s) = (fit.coefficients[own], (fit.variance[own] / share).sqrt());
        if which == Instrument::DelayOfAll {
            if place(&all, Instrument::Delay).is_none() {
                let column = investigation.layout.instrument(0, Instrument::Delay);
                all.push(Switch { column, target_only, nonnegative: false });
            }
            let (both, _) = weighted_fit(&investigation.problem, &all, &investigation.floor);
            let Some(further) = place(&all, Instrument::Delay) else { return Found::Nothing };
            // The rigid bodies' torque is in both columns.
            let rigid_s = both.coefficients[own] + both.coefficients[further];
            let rigid_std_s = (both.variance[further] / share).sqrt();
            let agrees = rigid_s >= RIGID_SHARE * delay_s
                || rigid_std_s < delay_s && rigid_s >= delay_s - RIGID_STD * rigid_std_s;
            if !agrees {
                return Found::OnlyFriction;
            }
        }
        Found::Delay(Self { delay_s, std_s, score: one.score, target_only })
    }

    /// The recordings with the delay undone.
    ///
    /// # Errors
    /// What preprocessing reports.
    pub(crate) fn undone(&self, question: &Question<'_>) -> Result<Vec<QuestionedRecording>, DiagnosisError> {
        question
            .recordings
            .iter()
            .map(|recording| {
                let mut shifted = recording.clone();
                if self.target_only && recording.role == Role::Calibration {
                    return Ok(shifted);
                }
                let delays =
                    shifted.options.delay_s.get_or_insert_with(|| vec![0.0; question.model.joints()]);
                delays.iter_mut().for_each(|delay| *delay += self.delay_s);
                shifted.data.data = preprocess(&shifted.raw, &shifted.options)?;
                Ok(shifted)
            })
            .collect()
    }
}
