//! What can be added to recordings.

use aurt_traits::MeasurementUnit;

use crate::effects::{Family, Presence, kind};
use crate::error::SimulationError;

/// What is known of an effect that can be added.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    /// Identifier.
    pub identifier: &'static str,
    /// Family.
    pub family: Family,
    /// In which recordings it can be.
    pub presence: Presence,
    /// Whether the vocabulary has it.
    pub in_vocabulary: bool,
    /// Whether it acts on the arm as a whole and names no joint.
    pub whole_arm: bool,
    /// Whether its law joins torques of several joints, so that measurements in A without torque constants do not do.
    pub needs_torque: bool,
}

/// Effects of the vocabulary. Backlash is not among them: what it does is done to the motion.
const KNOWN: [(&str, bool, bool); 24] = [
    ("coulomb", false, false),
    ("coulomb_asymmetry", false, false),
    ("stribeck", false, false),
    ("viscous", false, false),
    ("viscous_nonlinear", false, false),
    ("viscous_asymmetry", false, false),
    ("presliding_hysteresis", false, false),
    ("load_dependent_friction", false, false),
    ("drive_efficiency", false, false),
    ("temperature_dependent_friction", false, false),
    ("friction_level_changed", false, false),
    ("joint_coupling_friction", false, true),
    ("rotor_inertia", false, false),
    ("payload", true, true),
    ("base_tilt", true, true),
    ("spring", false, false),
    ("torque_ripple", false, false),
    ("joint_elasticity", false, true),
    ("torque_constant", false, false),
    ("current_offset", false, false),
    ("time_delay", true, false),
    ("saturation", false, false),
    ("external_contact", true, true),
    ("dropped_samples", true, false),
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
        if let Some((name, whole_arm, needs_torque)) = KNOWN.iter().find(|(name, ..)| *name == identifier) {
            let known = kind(name)?;
            return Ok(Self {
                identifier: name,
                family: known.family,
                presence: known.presence,
                in_vocabulary: true,
                whole_arm: *whole_arm,
                needs_torque: *needs_torque,
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
        let known = KNOWN.iter().map(|k| k.0).chain(UNKNOWN.iter().map(|k| k.0)).map(str::to_owned).collect();
        let meant = match kind(identifier) {
            Err(SimulationError::UnknownEffect { meant, .. }) => meant,
            _ => None,
        };
        Err(SimulationError::UnknownEffect { name: identifier.to_owned(), meant, known })
    }

    /// Whether it can be added to measurements of this unit.
    #[must_use]
    pub fn fits(&self, unit: MeasurementUnit) -> bool {
        !self.needs_torque || unit == MeasurementUnit::NewtonMetre
    }
}

/// Identifiers of the vocabulary that can be added to recordings measured in `unit`.
#[must_use]
pub fn injectable(unit: MeasurementUnit) -> Vec<&'static str> {
    let fits = |needs_torque: bool| !needs_torque || unit == MeasurementUnit::NewtonMetre;
    KNOWN.iter().filter(|(.., needs)| fits(*needs)).map(|k| k.0).collect()
}

/// Identifiers outside the vocabulary that can be added.
#[must_use]
pub fn unknown_injectable() -> Vec<&'static str> {
    UNKNOWN.iter().map(|k| k.0).collect()
}
