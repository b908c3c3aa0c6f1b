//! Whether what was found accounts for what is missing.

/// A joint whose residual exceeds its reference by this factor (root mean square) shows structure. Floors are
/// estimates: of 700 joints of simulated recordings that lacked nothing, one exceeded its floor by 1.5.
pub const STRUCTURE: f64 = 1.65;

/// Named effects must account for this share of the excess power, over all joints and on the mean over those that have an
/// excess; else what they describe is not what is missing.
const ACCOUNTED: f64 = 0.7;

/// The share that must be accounted for where most joints reach the reference, and one is left above it by
/// [`FAR_ABOVE`]: where the rest of the model is right, a right name leaves little.
const ACCOUNTED_AMONG_RIGHT: f64 = 0.9;

/// Factor over the reference, root mean square.
const FAR_ABOVE: f64 = 2.1;

/// A joint within this factor of the noise that is seen has reached it.
pub const REACHED: f64 = 1.3;

/// A joint that stands out of the others, and of whose excess less than this share is accounted for, has something of its
/// own that has no name.
const ACCOUNTED_ALONE: f64 = 0.5;

/// What a joint is off by, root mean square.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Left {
    /// Without what was found.
    pub(crate) before: f64,
    /// With it.
    pub(crate) after: f64,
    /// What it should be: what noise alone leaves, or what the model leaves where nothing has changed.
    pub(crate) floor: f64,
    /// The part of the reference that recordings show above their filters. The rest is noise that wanders, which is inferred
    /// from what the model leaves: a joint that reaches it does not show that its model is right.
    pub(crate) seen: f64,
}

impl Left {
    /// Whether more than the reference is left.
    pub(crate) fn has_structure(&self) -> bool {
        self.after > STRUCTURE * self.floor
    }

    /// Share of the joint's excess power that was accounted for; no less than −1, so that one joint that gets worse is
    /// not weighed without bounds.
    fn share(&self) -> f64 {
        let excess = |of: f64| (of.powi(2) - self.floor.powi(2)).max(0.0);
        let before = excess(self.before);
        if before > 0.0 {
            (1.0 - excess(self.after) / before).max(-1.0)
        } else if self.has_structure() {
            -1.0
        } else {
            1.0
        }
    }

    fn above(&self) -> f64 {
        self.after / self.floor.max(f64::MIN_POSITIVE)
    }

    /// Whether the model is seen to be right.
    fn is_right(&self) -> bool {
        self.after <= REACHED * self.seen
    }
}

/// Whether what was found accounts for the excess over the reference: over all joints together, on the mean over the
/// joints that have one, and on each joint that stands out of the others.
pub(crate) fn accounts_for(joints: &[Left]) -> bool {
    together(joints) && on_the_mean(joints) && !stands_out(joints)
}

/// Over all joints, in units of the noise that is seen.
fn together(joints: &[Left]) -> bool {
    let excess = |of: fn(&Left) -> f64| -> f64 {
        let of_joint = |joint: &Left| {
            let excess = (of(joint).powi(2) - joint.floor.powi(2)).max(0.0);
            excess / joint.seen.powi(2).max(f64::MIN_POSITIVE)
        };
        joints.iter().map(of_joint).sum()
    };
    let before = excess(|joint| joint.before);
    let accounted = if before > 0.0 { 1.0 - excess(|joint| joint.after) / before } else { 1.0 };
    let above = |factor: f64| joints.iter().filter(|joint| joint.above() > factor).count();
    let others_are_right = 2 * joints.iter().filter(|j| !j.is_right()).count() <= joints.len();
    let far = above(FAR_ABOVE) > 0 && others_are_right && accounted < ACCOUNTED_AMONG_RIGHT;
    !(above(STRUCTURE) > 0 && accounted < ACCOUNTED || far)
}

/// Over the joints that had an excess, each weighed by the logarithm of how far it was off: a joint without noise counts
/// for more than others, but does not decide alone.
fn on_the_mean(joints: &[Left]) -> bool {
    let (mut sum, mut weights) = (0.0, 0.0);
    for joint in joints.iter().filter(|j| j.before > STRUCTURE * j.floor) {
        let weight = (joint.before / joint.seen.max(f64::MIN_POSITIVE)).ln();
        sum += weight * joint.share();
        weights += weight;
    }
    weights == 0.0 || sum >= ACCOUNTED * weights || !joints.iter().any(Left::has_structure)
}

/// Whether a joint keeps far more than the others do, and most of what it had.
fn stands_out(joints: &[Left]) -> bool {
    let mut above: Vec<f64> = joints.iter().map(Left::above).collect();
    above.sort_by(f64::total_cmp);
    let usual = above.get(above.len() / 2).copied().unwrap_or(1.0).max(1.0);
    joints.iter().any(|joint| joint.above() > FAR_ABOVE * usual && joint.share() < ACCOUNTED_ALONE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of joints with a reference of 1, from (before, after).
    fn accounts(rms: &[(f64, f64)]) -> bool {
        let left =
            |(before, after): &(f64, f64)| Left { before: *before, after: *after, floor: 1.0, seen: 1.0 };
        accounts_for(&rms.iter().map(left).collect::<Vec<_>>())
    }

    #[test]
    fn what_leaves_the_noise_accounts_for_all() {
        assert!(accounts(&[(9.0, 1.1), (1.0, 1.0), (1.0, 0.9), (1.2, 1.2)]));
        assert!(accounts(&[(1.0, 1.0), (1.1, 1.1)]), "nothing was there");
        assert!(accounts(&[]), "nothing was asked");
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
        // The same errors, where most of the noise is inferred: no joint is seen to be right.
        let wandering = |(before, after): (f64, f64)| Left { before, after, floor: 1.0, seen: 0.7 };
        let joints = [(7.5, 3.2), (5.0, 1.0), (4.0, 1.1), (4.0, 0.9), (5.0, 1.0)].map(wandering);
        assert!(accounts_for(&joints));
    }

    #[test]
    fn a_joint_without_noise_does_not_decide_for_the_others() {
        assert!(!accounts(&[(1000.0, 20.0), (20.0, 19.0), (30.0, 28.0), (14.0, 12.0)]));
    }

    #[test]
    fn a_hum_on_one_joint_is_not_accounted_for_by_the_rest() {
        let hum = [(40.0, 2.0), (35.0, 2.0), (38.0, 1.8), (12.0, 12.0), (30.0, 1.5), (28.0, 2.0)];
        assert!(!accounts(&hum));
        assert!(!accounts(&[(1.0, 5.0), (1.0, 1.0), (1.0, 1.0)]), "made worse");
    }
}
