use super::declaring::*;
use crate::plant::LinearViscous;

per_joint! {
    /// Viscous friction of its own slope; the experiment has none on these joints.
    Viscous {
        /// Slope instead of the robot's own, Nm s/rad.
        viscous_nm_s: [0.0, 1e4],
    }
    "viscous", V, Structural, Few;
    drawn: |context, _random| context.noises(2.0);
    scaled_within: |robot, joint| [1e-3, 3.0 * robot.drives[joint].viscous_nm_s.max(0.1)];
    installed: |setup, joint, slope| {
        setup.machine.joints[joint].viscous = Box::new(LinearViscous(slope));
        setup.machine.nominal.drives[joint].viscous_nm_s = slope;
    }

    const HIDDEN: Hidden = Hidden::Viscous;
}
