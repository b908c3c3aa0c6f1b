//! Which of the four answers a diagnosis gives.
//!
//! What was selected describes the data better than the model does; whether it *is* what is missing is another
//! question. It is not where much of the mismatch stays, or where it takes more coincidences than happen at once.

use crate::{Answer, Finding, Investigation, JointResidual, Question, Role, selection::is_friction};

/// A joint whose residual exceeds the noise floor by this factor (root mean square) shows structure. Floors are
/// estimates: of 700 joints of simulated recordings that lacked nothing, one exceeded its floor by 1.5.
pub const STRUCTURE: f64 = 1.65;

/// Named effects must account for this share of the excess power over the noise floor, over all joints; else what they
/// describe is not what is missing.
const ACCOUNTED: f64 = 0.7;

/// The share that must be accounted for where most joints reach the noise floor, and one is left above it by
/// [`FAR_ABOVE`]: where the rest of the model is right, a right name leaves little.
const ACCOUNTED_AMONG_RIGHT: f64 = 0.9;

/// Factor over the noise floor, root mean square.
const FAR_ABOVE: f64 = 2.1;

/// A joint within this factor of the noise floor has reached it.
const REACHED: f64 = 1.3;

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
        let in_targets = |c: &crate::Contact| question.recordings[c.recording].role == Role::Target;
        let reference = investigation.contacts.iter().all(in_targets);
        let left = |(r, misfit): (&JointResidual, &f64)| {
            let usual = if reference { (0.5 * misfit).exp() } else { 1.0 };
            r.unexplained_rms > STRUCTURE * usual * r.floor_rms
        };
        !self.residual.iter().zip(&investigation.misfit).any(left)
            || (!self.physics.is_empty() && self.accounts())
    }
}

/// What a joint is off by, root mean square.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Left {
    /// Without what was found.
    pub(crate) before: f64,
    /// With it.
    pub(crate) after: f64,
    /// What noise alone leaves.
    pub(crate) floor: f64,
}

impl From<&JointResidual> for Left {
    fn from(residual: &JointResidual) -> Self {
        Self { before: residual.baseline_rms, after: residual.unexplained_rms, floor: residual.floor_rms }
    }
}

/// Whether what was found accounts for the excess over the noise floor.
pub(crate) fn accounts_for(joints: &[Left]) -> bool {
    // In units of the noise, so that no joint counts for more than another.
    let excess = |of: fn(&Left) -> f64| -> f64 {
        let of_joint = |joint: &Left| {
            let noise = joint.floor.powi(2);
            (of(joint).powi(2) - noise).max(0.0) / noise.max(f64::MIN_POSITIVE)
        };
        joints.iter().map(of_joint).sum()
    };
    let before = excess(|joint| joint.before);
    let accounted = if before > 0.0 { 1.0 - excess(|joint| joint.after) / before } else { 1.0 };
    let above = |factor: f64| joints.iter().filter(|joint| joint.after > factor * joint.floor).count();
    let others_are_right = 2 * above(REACHED) <= joints.len();
    let far = above(FAR_ABOVE) > 0 && others_are_right && accounted < ACCOUNTED_AMONG_RIGHT;
    !(above(STRUCTURE) > 0 && accounted < ACCOUNTED || far)
}

/// Whether something was found whose name may not be used: structure that has no name.
fn nameless(question: &Question<'_>, investigation: &Investigation) -> bool {
    let barred = |effect: &str| question.without.iter().any(|w| w == effect);
    investigation.shaking.iter().any(|s| barred(s.effect))
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Of joints with a noise floor of 1, from (before, after).
    fn accounts(rms: &[(f64, f64)]) -> bool {
        let left = |(before, after): &(f64, f64)| Left { before: *before, after: *after, floor: 1.0 };
        accounts_for(&rms.iter().map(left).collect::<Vec<_>>())
    }

    #[test]
    fn what_leaves_the_noise_accounts_for_all() {
        assert!(accounts(&[(9.0, 1.1), (1.0, 1.0), (1.0, 0.9), (1.2, 1.2)]));
        assert!(accounts(&[(1.0, 1.0), (1.1, 1.1)]), "nothing was there");
    }

    #[test]
    fn what_leaves_a_third_of_the_power_accounts_for_too_little() {
        assert!(!accounts(&[(5.0, 3.0), (5.0, 2.8), (4.0, 2.5)]));
        assert!(
            accounts(&[(5.0, 2.0), (5.0, 2.2), (4.0, 2.0)]),
            "a real robot keeps something on all joints"
        );
    }

    #[test]
    fn among_joints_at_the_noise_a_right_name_leaves_little() {
        let others = [(1.0, 1.0), (1.1, 1.1), (0.9, 0.9), (1.0, 1.0)];
        let with = |one: (f64, f64)| accounts(&[&[one][..], &others].concat());
        assert!(!with((7.5, 3.2)), "82 % accounted for, three times the noise left");
        assert!(with((20.0, 3.2)), "97 % accounted for");
        assert!(with((3.0, 1.6)));
    }
}
