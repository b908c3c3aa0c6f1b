//! `rotor_inertia`: the motors' rotors, as they appear behind their gears.
//!
//! # Equation
//! τ_j = I_a,j q̈_j, where I_a is the rotor's inertia times the square of the gear ratio.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `joints` | – | joints that have the term; all unless given |
//!
//! # Use when
//! Always on geared arms, except for joints where the link's own inertia about the axis takes it up exactly: the
//! first joint of every arm, and the second of common ones with a vertical first axis. There it only lowers the
//! rank. Gyroscopic torques of the rotors on other joints are left out, as usual at gear ratios around 100.
//!
//! # Source
//! Khalil and Dombre (2002), *Modeling, Identification and Control of Robots*.
//!
//! # Invariants
//! Memoryless. The term is no load: the rotor sits before the gear.

use aurt_traits::{ArmSeries, ArmTerm, Columns, ModelError, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::arm_terms::joint_selection::JointSelection;
use crate::shape::verdict;

/// Inertia of the rotors.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RotorInertia {
    /// Joints that have the term.
    #[serde(default, skip_serializing_if = "JointSelection::is_all")]
    pub joints: JointSelection,
}

register_model! {
    slot: ArmTerm,
    name: "rotor_inertia",
    summary: "inertia of the motors' rotors",
    equation: "τ_j = I_a,j q̈_j",
    use_when: "geared arms; not for joints whose link takes it up exactly (0 and 1 of common arms)",
    source: "Khalil and Dombre (2002)",
    example: r#"{ model = "rotor_inertia", joints = [2, 3, 4, 5] }"#,
}

#[typetag::serde(name = "rotor_inertia")]
impl ArmTerm for RotorInertia {
    declares_term! { "rotor_inertia", per joint: ["I_a" in "kg m^2"], invariants: [Memoryless] }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        verdict(self.joints.complaints("rotor_inertia", robot_joints))
    }

    fn evaluate(&self, series: &ArmSeries<'_>, _state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let motion = series.motion;
        self.joints.write_own_rows(motion.joints(), 1, out, |_, joint, own| {
            own.column_mut(0).copy_from_slice(motion.acceleration_rad_s2(joint));
        });
        Ok(())
    }
}
