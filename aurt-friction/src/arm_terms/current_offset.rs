//! `current_offset`: a constant that the instrument adds to a joint's measurement.
//!
//! # Equation
//! τ_j = o_j
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `joints` | – | joints that have the term; all unless given |
//!
//! # Use when
//! A current sensor's zero drifts. While a joint moves, an offset and unequal Coulomb levels for the two
//! directions (`coulomb_asymmetric`) are the same thing; only rest tells them apart.
//!
//! # Source
//! Khalil and Dombre (2002), *Modeling, Identification and Control of Robots*.

use aurt_traits::{ArmSeries, ArmTerm, Columns, ModelError, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::arm_terms::joint_selection::JointSelection;
use crate::shape::verdict;

/// A constant offset of the measurement.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CurrentOffset {
    /// Joints that have the term.
    #[serde(default, skip_serializing_if = "JointSelection::is_all")]
    pub joints: JointSelection,
}

register_model! {
    slot: ArmTerm,
    name: "current_offset",
    summary: "a constant in a joint's measurement",
    equation: "τ_j = offset_j",
    use_when: "the zero of a current sensor drifts; while moving it equals unequal Coulomb levels",
    source: "Khalil and Dombre (2002)",
    example: r#"{ model = "current_offset", joints = [0, 1] }"#,
}

#[typetag::serde(name = "current_offset")]
impl ArmTerm for CurrentOffset {
    declares_term! {
        "current_offset",
        per joint: ["offset" in "Nm"],
        invariants: [EvenInLoad, BoundedByOne, ContinuousInVelocity, RateIndependent, Memoryless]
    }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        verdict(self.joints.complaints("current_offset", robot_joints))
    }

    fn evaluate(&self, series: &ArmSeries<'_>, _state: &mut [f64], out: &mut Columns<'_>) -> Result {
        self.joints.write_own_rows(series.motion.joints(), 1, out, |_, _, own| own.column_mut(0).fill(1.0));
        Ok(())
    }
}
