//! Which of the four answers a diagnosis gives.
//!
//! What was selected describes the data better than the model does; whether it *is* what is missing is another
//! question. It is not where much of the mismatch stays, or where it takes more coincidences than happen at once.

use crate::evidence::account::{Left, STRUCTURE, accounts_for};
use crate::hypotheses::group::is_friction;
use crate::investigation::Investigation;
use crate::recordings::rows::Role;
use crate::request::Question;
use crate::verdict::{Answer, Finding, JointResidual};

/// More things than this do not change at once, each for itself. Friction does, from day to day.
const MOST_CHANGES: usize = 3;

/// More joints than this do not change at once in what is not friction, each for itself.
const MOST_CHANGED_JOINTS: usize = 2;

/// So many contacts, beside changes that are not friction, are one thing that has no name.
const MOST_CONTACTS: usize = 3;

/// What was found, as far as the answer depends on it.
pub(crate) struct Account<'a> {
    /// Physics, the first label first.
    pub(crate) physics: &'a [Finding],
    /// What it leaves.
    pub(crate) residual: &'a [JointResidual],
    /// Whether contacts are named.
    pub(crate) contacts: bool,
    /// Whether impacts or ringing are named.
    pub(crate) shaking: bool,
    /// Whether faults of the recordings are named.
    pub(crate) faults: bool,
}

impl Account<'_> {
    /// The answer.
    pub(crate) fn answer(&self, question: &Question<'_>, investigation: &Investigation) -> Answer {
        if self.shaking {
            return Answer::Named;
        }
        if nameless(question, investigation) {
            return Answer::Unexplained;
        }
        if self.contacts {
            return if self.contacts_suffice(question, investigation) {
                Answer::Named
            } else {
                Answer::Unexplained
            };
        }
        let by_physics = self.by_physics(investigation);
        if self.faults && (investigation.faults_matter || by_physics == Answer::NoMismatch) {
            return Answer::Named;
        }
        by_physics
    }

    fn by_physics(&self, investigation: &Investigation) -> Answer {
        let Some(first) = self.physics.first() else {
            return if self.structure_left() { Answer::Unexplained } else { Answer::NoMismatch };
        };
        if !self.accounts() || coincidences(investigation) {
            Answer::Unexplained
        } else if first.alternatives.is_empty() {
            Answer::Named
        } else {
            Answer::Ambiguous
        }
    }

    fn structure_left(&self) -> bool {
        self.residual.iter().any(|r| r.structure_left)
    }

    fn accounts(&self) -> bool {
        accounts_for(&self.residual.iter().map(Left::from).collect::<Vec<_>>())
    }

    /// Whether contacts, and the physics beside them, are all there is. Outside its windows a contact leaves nothing,
    /// beyond what the model in question leaves of recordings that have no contact.
    fn contacts_suffice(&self, question: &Question<'_>, investigation: &Investigation) -> bool {
        if coincidences(investigation) {
            return false;
        }
        let in_targets = |c: &crate::contact::Contact| question.recordings[c.recording].role == Role::Target;
        let reference = investigation.contacts.iter().all(in_targets);
        let left = |(r, misfit): (&JointResidual, &f64)| {
            let usual = if reference { (0.5 * misfit).exp() } else { 1.0 };
            r.unexplained_rms > STRUCTURE * usual * r.floor_rms
        };
        !self.residual.iter().zip(&investigation.misfit).any(left)
            || (!self.physics.is_empty() && self.accounts())
    }
}

impl From<&JointResidual> for Left {
    fn from(residual: &JointResidual) -> Self {
        Self { before: residual.baseline_rms, after: residual.unexplained_rms, floor: residual.floor_rms }
    }
}

/// Whether something was found whose name may not be used: structure that has no name.
fn nameless(question: &Question<'_>, investigation: &Investigation) -> bool {
    let barred = |effect: &str| question.without.iter().any(|w| w == effect);
    investigation.shaking.iter().any(|s| s.confirmed && barred(s.effect))
        || investigation.faults.iter().any(|f| f.suffices && barred(f.effect))
        || !investigation.contacts.is_empty() && barred("external_contact")
}

/// Whether more has changed from calibration to target than changes at once: several things that are not friction,
/// each on a joint of its own, or with contacts at several times. A constant beside a Coulomb level is friction that
/// differs by direction; it counts where something else has changed that is not friction.
fn coincidences(investigation: &Investigation) -> bool {
    if !investigation.problem.has_reference() {
        return false;
    }
    let changed: Vec<(&str, usize)> = investigation
        .selection
        .chosen
        .iter()
        .map(|c| &investigation.groups[c.group])
        .filter(|g| g.target_only() && g.joints.len() == 1)
        .map(|g| (g.effect, g.joints[0]))
        .filter(|(effect, _)| !is_friction(effect) || *effect == "coulomb_asymmetry")
        .collect();
    let strange = changed.iter().filter(|(effect, _)| !is_friction(effect)).count();
    let mut joints: Vec<usize> = changed.iter().map(|(_, joint)| *joint).collect();
    joints.sort_unstable();
    joints.dedup();
    strange > MOST_CHANGES
        || strange > 0 && joints.len() > MOST_CHANGED_JOINTS
        || strange > 0 && investigation.contacts.len() >= MOST_CONTACTS
}
