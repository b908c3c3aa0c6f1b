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
//! # Columns
//! | name | unit | column |
//! |---|---|---|
//! | `offset_<j>` | Nm | 1 in row j |
//!
//! # Use when
//! A current sensor's zero drifts. While a joint moves, an offset and unequal Coulomb levels for the two
//! directions (`coulomb_asymmetric`) are the same thing; only rest tells them apart.
//!
//! # Source
//! Khalil and Dombre (2002), *Modeling, Identification and Control of Robots*.
//!
//! # Invariants
//! Even in load, bounded by one, rate-independent, memoryless.

use aurt_traits::{
    ArmSeries, ArmTerm, Columns, Invariant, Invariants, ModelError, Parameter, register_model,
};
use serde::{Deserialize, Serialize};

use crate::{arm_terms::joint_selection::JointSelection, shape::verdict};

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
    fn name(&self) -> &str {
        "current_offset"
    }

    fn boxed_clone(&self) -> Box<dyn ArmTerm> {
        Box::new(self.clone())
    }

    fn joints(&self, robot_joints: usize) -> Vec<usize> {
        self.joints.resolve(robot_joints)
    }

    fn columns(&self, robot_joints: usize) -> Vec<Parameter> {
        self.joints.columns(robot_joints, &[("offset", "Nm")])
    }

    fn acts_on(&self, column: usize, joint: usize, robot_joints: usize) -> bool {
        self.joints.owns(robot_joints, 1, column, joint)
    }

    fn invariants(&self) -> Invariants {
        Invariants::of(&[
            Invariant::EvenInLoad,
            Invariant::BoundedByOne,
            Invariant::ContinuousInVelocity,
            Invariant::RateIndependent,
            Invariant::Memoryless,
        ])
    }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        verdict(self.joints.complaints("current_offset", robot_joints))
    }

    fn evaluate(
        &self,
        series: &ArmSeries<'_>,
        _state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), ModelError> {
        self.joints.write_own_rows(series.motion.joints(), 1, out, |_, _, own| own.column_mut(0).fill(1.0));
        Ok(())
    }
}
