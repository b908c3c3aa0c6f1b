//! Whether what was found accounts for what is missing.

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
