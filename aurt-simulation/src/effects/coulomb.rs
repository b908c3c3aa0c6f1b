use super::declaring::*;

per_joint! {
    /// Coulomb friction of its own level; the experiment has none on these joints.
    Coulomb {
        /// Level instead of the robot's own, Nm.
        coulomb_nm: [0.0, 1e4],
    }
    "coulomb", F, Structural, Few;
    drawn: |context, _random| context.noises(1.2);
    scaled_within: |robot, joint| [1e-3, 2.0 * robot.drives[joint].coulomb_nm.max(0.1)];
    installed: |setup, joint, level| {
        setup.machine.joints[joint].coulomb_nm = [level; 2];
        setup.machine.nominal.drives[joint].coulomb_nm = level;
    }

    const SUITS: fn(&Robot, usize) -> bool = constant_level;
    const HIDDEN: Hidden = Hidden::Coulomb;
}
