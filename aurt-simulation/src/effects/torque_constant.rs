use super::declaring::*;

per_joint! {
    /// The drive's torque constant is (1 + e) times the stated one: measured torques are too small by 1/(1 + e).
    TorqueConstant {
        /// e.
        gain_error: [-0.9, 9.0],
    }
    "torque_constant", D, Either, Few;
    drawn: |context, random| context.joints.iter().map(|_| random.sign() * random.between(0.05, 0.12)).collect();
    scaled_within: |_robot, _joint| [-0.5, 1.0];
    installed: |setup, joint, error| {
        setup.instrument.channels[joint].gain_error = error;
    }
}
