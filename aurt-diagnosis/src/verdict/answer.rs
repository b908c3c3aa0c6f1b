//! Which of the four answers a diagnosis gives, to each of its two questions.
//!
//! What was selected describes the data better than the model does; whether it *is* what is missing is another
//! question. In part where more than noise is left of a joint, and not where it takes more coincidences than happen at once.

use crate::investigation::Investigation;
use crate::verdict::errors::Errors;
use crate::verdict::{Answer, Finding, RegisteredFinding};
use crate::vocabulary::{Effect, Family};

/// More things than this do not change at once, each for itself. Friction does, from day to day.
const MOST_CHANGES: usize = 3;

/// More joints than this do not change at once in what is not friction, each for itself.
const MOST_CHANGED_JOINTS: usize = 2;

/// So many contacts, beside changes that are not friction, are one thing that has no name.
const MOST_CONTACTS: usize = 3;

/// A model that predicts less than this share of every joint's measurement has nothing to do with it.
pub(crate) const UNRELATED: f64 = 0.1;

/// The answer to what has changed (to all, where there is but one question), and to what is missing in all recordings, of which
/// `something` is left.
pub(crate) fn answers(
    investigation: &Investigation,
    effects: &[Finding],
    registered: &[RegisteredFinding],
    errors: &Errors,
    something: bool,
) -> (Answer, Option<Answer>) {
    let in_all = |present_in: &[String]| present_in.len() > 1;
    let word = |is_asked: &dyn Fn(&[String]) -> bool, question: &Asked| {
        let named: Vec<&Finding> = effects.iter().filter(|f| is_asked(&f.present_in)).collect();
        let nameless = registered.iter().any(|r| is_asked(&r.present_in));
        word(investigation, &named, nameless || question.unclaimed, question)
    };
    let coincidence = coincidences(investigation);
    match &errors.change {
        Some(joints) => {
            let left = !joints.is_empty();
            let change = match word(&|p| !in_all(p), &Asked { left, coincidence, unclaimed: false }) {
                // Both were fitted together, for want of a reference: what has changed can hide in that.
                Answer::NoMismatch if investigation.undetermined => Answer::Unexplained,
                answer => answer,
            };
            let chosen = &investigation.selection.chosen;
            let unclaimed =
                chosen.iter().any(|c| c.withheld.is_some() && !investigation.groups[c.group].target_only());
            let missing = Asked { left: errors.structure || something, coincidence: false, unclaimed };
            (change, Some(word(&in_all, &missing)))
        }
        None => (
            word(&|_| true, &Asked { left: errors.structure || something, coincidence, unclaimed: false }),
            None,
        ),
    }
}

/// One question.
struct Asked {
    /// Whether more than noise is left.
    left: bool,
    coincidence: bool,
    /// True where the model has an effect that is not claimed: something is there, as where a model without a name is.
    unclaimed: bool,
}

fn word(investigation: &Investigation, named: &[&Finding], nameless: bool, asked: &Asked) -> Answer {
    let (faults, physics): (Vec<&Finding>, Vec<&Finding>) = named.iter().partition(|f| f.family == Family::Q);
    let by_physics = by_physics(&physics, asked);
    match by_physics {
        _ if !faults.is_empty() && (investigation.faults_matter || by_physics == Answer::NoMismatch) => {
            Answer::Named
        }
        Answer::Named if nameless => Answer::PartlyExplained,
        Answer::NoMismatch if nameless || is_unrelated(&investigation.predicted) => Answer::Unexplained,
        answer => answer,
    }
}

const fn by_physics(physics: &[&Finding], asked: &Asked) -> Answer {
    match physics {
        [] if asked.left => Answer::Unexplained,
        [] => Answer::NoMismatch,
        _ if asked.coincidence => Answer::Unexplained,
        _ if asked.left => Answer::PartlyExplained,
        _ => Answer::Named,
    }
}

/// Whether the model in question predicts next to nothing of any joint.
pub(crate) fn is_unrelated(predicted: &[Option<f64>]) -> bool {
    let mut known = predicted.iter().flatten().peekable();
    known.peek().is_some() && known.all(|share| *share < UNRELATED)
}

/// Whether more has changed from calibration to target than changes at once: several things that are not friction,
/// each on a joint of its own, or with contacts at several times. A constant beside a Coulomb level is friction that
/// differs by direction; it counts where something else has changed that is not friction.
fn coincidences(investigation: &Investigation) -> bool {
    if !investigation.problem.has_reference() {
        return false;
    }
    let is_constant = |effect: &Effect| effect.same_force.iter().any(|same| !same.is_friction);
    let changed: Vec<(&Effect, usize)> = investigation
        .selection
        .chosen
        .iter()
        .map(|c| &investigation.groups[c.group])
        .filter(|g| g.target_only() && g.joints.len() == 1)
        .map(|g| (g.effect, g.joints[0]))
        .filter(|(effect, _)| !effect.is_friction || is_constant(effect))
        .collect();
    let strange = changed.iter().filter(|(effect, _)| !effect.is_friction).count();
    let mut joints: Vec<usize> = changed.iter().map(|(_, joint)| *joint).collect();
    joints.sort_unstable();
    joints.dedup();
    strange > MOST_CHANGES
        || strange > 0 && joints.len() > MOST_CHANGED_JOINTS
        || strange > 0 && investigation.contacts.len() >= MOST_CONTACTS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_that_predicts_nothing_anywhere_is_unrelated() {
        assert!(is_unrelated(&[Some(0.01), Some(-0.3), None]));
        assert!(!is_unrelated(&[Some(0.01), Some(0.8)]), "a wrist may be all noise");
        assert!(!is_unrelated(&[None]), "nothing moved");
    }
}
