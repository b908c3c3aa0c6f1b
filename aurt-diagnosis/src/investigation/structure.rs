//! The structure of the robot, from the calibration recordings alone.
//!
//! A robot lacks the same physics whichever recordings stand beside those that it was calibrated with. So these are investigated
//! by themselves where there are targets, and what they show is in every model of the targets: it cannot be removed, and gives way
//! to nothing. What only both together show in all recordings stays in the model, lest a change takes its place, and is an indication.

use aurt_plugins::Registry;

use crate::effects::time_delay::EFFECT as DELAY;
use crate::investigation::investigate;
use crate::recordings::rows::Role;
use crate::request::{Question, QuestionedRecording, StructuralEffect};
use crate::vocabulary::{Presence, Proposal};

/// The effects of the calibration recordings; none where there are no targets, where a model is given, or where the calibration
/// recordings do not determine one. What cannot be investigated is reported of all recordings.
pub(super) fn structure_alone(
    question: &Question<'_>,
    registry: &Registry,
    progress: &mut impl FnMut(&str),
) -> Option<Vec<StructuralEffect>> {
    let of = |role: Role| question.recordings.iter().filter(move |r| r.role == role);
    if question.frozen.is_some() || of(Role::Target).next().is_none() {
        return None;
    }
    let recordings: Vec<QuestionedRecording> = of(Role::Calibration).cloned().collect();
    let alone = Question { recordings: &recordings, ..*question };
    let mut told = |step: &str| progress(&format!("calibration recordings alone: {step}"));
    let found = investigate(&alone, registry, &mut told as &mut dyn FnMut(&str)).ok()?;
    let groups = found.selection.chosen.iter().map(|c| &found.groups[c.group]);
    let known = groups.filter(|g| g.is_named() && *g.effect != DELAY).map(|g| {
        let proposal =
            Proposal { presence: Presence::Known, ..found.candidates[g.candidate].proposal.clone() };
        StructuralEffect { effect: g.effect, proposal }
    });
    (!found.undetermined).then(|| known.collect())
}
