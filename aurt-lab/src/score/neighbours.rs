/// The effects that are commonly confused with one another, each pair once: what shows in the same coordinate, or
/// contains the other as a special case.
const PAIRS: [(&str, &str); 28] = [
    ("backlash", "joint_elasticity"),
    ("backlash", "presliding_hysteresis"),
    ("base_tilt", "payload"),
    ("coulomb", "coulomb_asymmetry"),
    ("coulomb", "friction_level_changed"),
    ("coulomb", "load_dependent_friction"),
    ("coulomb", "presliding_hysteresis"),
    ("coulomb", "stribeck"),
    ("coulomb_asymmetry", "current_offset"),
    ("coulomb_asymmetry", "viscous_asymmetry"),
    ("current_offset", "viscous_asymmetry"),
    ("drive_efficiency", "load_dependent_friction"),
    ("drive_efficiency", "torque_constant"),
    ("friction_level_changed", "temperature_dependent_friction"),
    ("friction_level_changed", "viscous"),
    ("friction_level_changed", "viscous_nonlinear"),
    ("joint_elasticity", "rotor_inertia"),
    ("joint_elasticity", "time_delay"),
    ("load_dependent_friction", "torque_constant"),
    ("payload", "torque_constant"),
    ("presliding_hysteresis", "stribeck"),
    ("presliding_hysteresis", "time_delay"),
    ("rotor_inertia", "time_delay"),
    ("spring", "torque_ripple"),
    ("temperature_dependent_friction", "viscous_nonlinear"),
    ("viscous", "viscous_asymmetry"),
    ("viscous", "viscous_nonlinear"),
    ("viscous_asymmetry", "viscous_nonlinear"),
];

/// The declared neighbours of an effect.
///
/// ```
/// use aurt_lab::score::neighbours;
/// assert_eq!(neighbours("spring"), ["torque_ripple"]);
/// assert!(neighbours("external_contact").is_empty());
/// ```
pub fn neighbours(effect: &str) -> Vec<&'static str> {
    PAIRS
        .iter()
        .filter_map(|(a, b)| {
            if *a == effect {
                Some(*b)
            } else if *b == effect {
                Some(*a)
            } else {
                None
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_of_the_vocabulary_and_stand_once() {
        for (k, (a, b)) in PAIRS.iter().enumerate() {
            assert!(a < b, "{a} {b}");
            assert!(!PAIRS[..k].contains(&(a, b)), "{a} {b} stands twice");
            for name in [a, b] {
                assert!(crate::effects::kind(name).is_ok(), "{name}");
            }
        }
    }
}
