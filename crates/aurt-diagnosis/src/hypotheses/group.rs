//! Hypotheses over the columns of candidates.

use crate::hypotheses::effects::find;
use crate::hypotheses::registered::REGISTERED;

/// A coefficient that a hypothesis may use: a column of the robot model, in all recordings or in the target
/// recordings alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Switch {
    /// Column of the robot model.
    pub column: usize,
    /// Whether the coefficient acts in the target recordings only.
    pub target_only: bool,
    /// Whether physics forbids a negative value.
    pub nonnegative: bool,
}

/// A hypothesis: coefficients that enter or leave the model together.
#[derive(Debug, Clone)]
pub struct Group {
    /// Identifier of the effect.
    pub effect: &'static str,
    /// Joints whose physics it is.
    pub joints: Vec<usize>,
    /// Index of the candidate that it comes from.
    pub candidate: usize,
    /// Its coefficients.
    pub switches: Vec<Switch>,
    /// Those of them that are not what the effect is named for.
    pub accessory: Vec<Switch>,
}

impl Group {
    /// Whether it ties two joints together, and is not of the whole arm.
    pub(crate) fn is_tie(&self) -> bool {
        self.joints.len() == 2 && !find(self.effect).is_some_and(|e| e.whole_arm())
    }

    /// Whether the effect is taken to act in the target recordings only.
    #[must_use]
    pub fn target_only(&self) -> bool {
        self.switches.first().is_some_and(|s| s.target_only)
    }
}

/// Effects that are one force beside a Coulomb level: F₊ ≠ F₋ is a constant while the joint moves.
pub(crate) fn same_force(a: &str, b: &str) -> bool {
    matches!((a, b), ("current_offset", "coulomb_asymmetry") | ("coulomb_asymmetry", "current_offset"))
}

/// Effects whose change from one recording to the next is what real robots do.
pub(crate) fn is_friction(effect: &str) -> bool {
    kind(effect) == "friction" || effect == "load_dependent_friction"
}

/// Effects that describe the same force at the same place: a second one needs stronger evidence.
pub(crate) fn kind(effect: &str) -> &'static str {
    match effect {
        "coulomb"
        | "stribeck"
        | "coulomb_asymmetry"
        | "presliding_hysteresis"
        | "friction_level_changed"
        | "viscous"
        | "viscous_nonlinear"
        | "viscous_asymmetry"
        | "temperature_dependent_friction"
        | REGISTERED => "friction",
        "load_dependent_friction" | "drive_efficiency" | "torque_constant" => "load",
        "rotor_inertia" | "joint_elasticity" | "time_delay" => "acceleration",
        "spring" | "torque_ripple" | "base_tilt" => "position",
        _ => "other",
    }
}
