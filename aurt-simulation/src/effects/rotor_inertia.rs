use super::declaring::*;

per_joint! {
    /// A rotor behind the gear, beside those that the robot has.
    RotorInertia {
        /// Inertia on the joint's side, kg m².
        inertia_kg_m2: [0.0, 1e3],
    }
    "rotor_inertia", I, Structural, Few;
    drawn: |context, _random| context.noises(0.7);
    scaled_within: |_robot, _joint| [f64::NEG_INFINITY, 6.0];
    installed: |setup, joint, inertia| {
        setup.machine.robot.drives[joint].rotor_inertia_kg_m2 += inertia;
        setup.machine.nominal.drives[joint].rotor_inertia_kg_m2 += inertia;
    }

    const ROTORS: Option<Rotors> = Some(Rotors::InLinks);
}
