//! What can be added to recordings.

use aurt_traits::MeasurementUnit;

use crate::effects::{Family, Presence, kind};
use crate::error::SimulationError;

/// What is known of an effect that can be added.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    pub identifier: &'static str,
    pub family: Family,
    pub presence: Presence,
    /// Whether the vocabulary has it.
    pub in_vocabulary: bool,
    /// Whether it acts on the arm as a whole and names no joint.
    pub whole_arm: bool,
    /// Whether its law joins torques of several joints, so that measurements in A without torque constants do not do.
    pub needs_torque: bool,
}

/// Effects of the vocabulary. Backlash is not among them: what it does is done to the motion.
const KNOWN: [&str; 25] = [
    "coulomb",
    "coulomb_asymmetry",
    "stribeck",
    "viscous",
    "viscous_nonlinear",
    "viscous_asymmetry",
    "presliding_hysteresis",
    "load_dependent_friction",
    "drive_efficiency",
    "temperature_dependent_friction",
    "friction_level_changed",
    "joint_coupling_friction",
    "rotor_inertia",
    "payload",
    "base_tilt",
    "encoder_offset",
    "spring",
    "torque_ripple",
    "joint_elasticity",
    "torque_constant",
    "current_offset",
    "time_delay",
    "saturation",
    "external_contact",
    "dropped_samples",
];

/// Those whose laws join torques of several joints.
const OF_SEVERAL_JOINTS: [&str; 6] = [
    "joint_coupling_friction",
    "payload",
    "base_tilt",
    "encoder_offset",
    "joint_elasticity",
    "external_contact",
];

/// Effects outside the vocabulary.
const UNKNOWN: [(&str, Family); 4] = [
    ("periodic_disturbance", Family::X),
    ("cross_angle_friction", Family::C),
    ("sticking_window", Family::F),
    ("position_damper", Family::V),
];

impl Kind {
    /// What is known of an identifier.
    ///
    /// # Errors
    /// [`SimulationError::UnknownEffect`] with what can be added.
    pub fn named(identifier: &str) -> Result<Self, SimulationError> {
        if let Some(name) = KNOWN.into_iter().find(|name| *name == identifier) {
            let known = kind(name)?;
            return Ok(Self {
                identifier: name,
                family: known.family,
                presence: known.presence,
                in_vocabulary: true,
                whole_arm: known.whole_arm(),
                needs_torque: OF_SEVERAL_JOINTS.contains(&name),
            });
        }
        if let Some((name, family)) = UNKNOWN.iter().find(|(name, _)| *name == identifier) {
            return Ok(Self {
                identifier: name,
                family: *family,
                presence: Presence::Either,
                in_vocabulary: false,
                whole_arm: false,
                needs_torque: false,
            });
        }
        let known = KNOWN.into_iter().chain(UNKNOWN.map(|(name, _)| name)).map(str::to_owned).collect();
        let meant = match kind(identifier) {
            Err(SimulationError::UnknownEffect { meant, .. }) => meant,
            _ => None,
        };
        Err(SimulationError::UnknownEffect { name: identifier.to_owned(), meant, known })
    }

    /// Whether it can be added to measurements of this unit.
    pub fn fits(&self, unit: MeasurementUnit) -> bool {
        !self.needs_torque || unit == MeasurementUnit::NewtonMetre
    }
}

/// Identifiers of the vocabulary that can be added to recordings measured in `unit`.
pub fn injectable(unit: MeasurementUnit) -> Vec<&'static str> {
    let fits = |name: &&str| unit == MeasurementUnit::NewtonMetre || !OF_SEVERAL_JOINTS.contains(name);
    KNOWN.into_iter().filter(fits).collect()
}

/// Identifiers outside the vocabulary that can be added.
pub fn unknown_injectable() -> Vec<&'static str> {
    UNKNOWN.iter().map(|k| k.0).collect()
}
