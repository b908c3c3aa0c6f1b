use super::declaring::*;

per_joint! {
    /// Dry friction in proportion to the transmitted torque, beside the constant level.
    LoadDependentFriction {
        /// Friction per load, Nm/Nm.
        load_coefficient: [0.0, 0.9],
    }
    "load_dependent_friction", L, Structural, Few;
    drawn: |context, random| vec![random.between(0.06, 0.15); context.joints.len()];
    scaled_within: |_robot, _joint| [f64::NEG_INFINITY, 0.45];
    installed: |setup, joint, coefficient| {
        setup.machine.joints[joint].load_coefficient = [coefficient; 2];
    }

    const SUITS: fn(&Robot, usize) -> bool = constant_level;
}
