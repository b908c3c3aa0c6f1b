//! `viscous_asymmetric`: viscous friction with a slope of its own for each direction.
//!
//! # Equation
//! τ_j = F_v+,j max(q̇_j, 0) + F_v−,j min(q̇_j, 0)
//!
//! Equation (6) asks for viscous friction that is odd; this is not, so it stands outside. Use it with
//! `viscous = { model = "polynomial", powers = [] }` (or powers above 1) on the same joints.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `joints` | – | joints that have the term; all unless given |
//!
//! # Use when
//! Drives with seals, belts or preload whose friction rises faster in one direction than in the other.
//!
//! # Source
//! Armstrong-Hélouvry (1991), *Control of Machines with Friction*. A public recording of an axis whose two slopes
//! differ: Janot, Gautier, Brunot (2019), *Data set and reference models of EMPS*.

use aurt_traits::{ArmSeries, ArmTerm, Columns, ModelError, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::arm_terms::joint_selection::JointSelection;
use crate::shape::verdict;

/// Viscous friction with a slope for each direction.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViscousAsymmetric {
    /// Joints that have the term.
    #[serde(default, skip_serializing_if = "JointSelection::is_all")]
    pub joints: JointSelection,
}

register_model! {
    slot: ArmTerm,
    name: "viscous_asymmetric",
    summary: "viscous friction with a slope of its own for each direction",
    equation: "τ_j = F_v_pos max(q̇_j, 0) + F_v_neg min(q̇_j, 0)",
    use_when: "friction rises faster in one direction; with viscous `polynomial` without power 1",
    source: "Armstrong-Hélouvry (1991); Janot, Gautier, Brunot (2019)",
    example: r#"{ model = "viscous_asymmetric", joints = [0, 1] }"#,
}

#[typetag::serde(name = "viscous_asymmetric")]
impl ArmTerm for ViscousAsymmetric {
    declares_term! {
        "viscous_asymmetric",
        per joint: ["F_v_pos" in "Nm s/rad", "F_v_neg" in "Nm s/rad"],
        invariants: [EvenInLoad, ContinuousInVelocity, SignOfVelocity, Passive, Memoryless]
    }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        verdict(self.joints.complaints("viscous_asymmetric", robot_joints))
    }

    fn evaluate(&self, series: &ArmSeries<'_>, _state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let motion = series.motion;
        self.joints.write_own_rows(motion.joints(), 2, out, |_, joint, own| {
            for (n, v) in motion.velocity_rad_s(joint).iter().enumerate() {
                own.column_mut(0)[n] = v.max(0.0);
                own.column_mut(1)[n] = v.min(0.0);
            }
        });
        Ok(())
    }
}
