//! `spring`: a spring across a joint, linear in its angle.
//!
//! # Equation
//! τ_j = k_j (q_j − q_0,j), the torque that the drive spends on holding the spring.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `joints` | – | joints that have the term; all unless given |
//! | `rest_rad` | rad | q_0, if it is known; then the term has one column per joint |
//!
//! # Columns
//! | name | unit | column |
//! |---|---|---|
//! | `k_<j>` | Nm/rad | q_j, or q_j − q_0 with `rest_rad`, in row j |
//! | `k_q0_<j>` | Nm | −1 in row j, without `rest_rad`; q_0 is this coefficient divided by k |
//!
//! # Use when
//! Cables and hoses that twist with a joint, gravity balancers with a linear characteristic; a spring with a lever
//! is `counterbalance`. `k_q0` is a constant, so it and an offset of the current sensor (`current_offset`) are the
//! same; and over a small range of q a spring looks like a first moment of the links.
//!
//! # Source
//! Hooke (1678).

use aurt_traits::{ArmSeries, ArmTerm, Columns, ModelError, Parameter, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::arm_terms::joint_selection::JointSelection;
use crate::shape::verdict;

/// A linear spring across each joint.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spring {
    /// Joints that have the term.
    #[serde(default, skip_serializing_if = "JointSelection::is_all")]
    pub joints: JointSelection,
    /// Angle q_0 at which the spring is relaxed, in rad, if it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest_rad: Option<f64>,
}

impl Spring {
    const fn per_joint(&self) -> usize {
        if self.rest_rad.is_some() { 1 } else { 2 }
    }
}

register_model! {
    slot: ArmTerm,
    name: "spring",
    summary: "a spring across a joint, linear in its angle",
    equation: "τ_j = k q_j − k_q0, or k (q_j − rest_rad)",
    use_when: "cables, hoses, linear balancers; a spring with a lever is `counterbalance`",
    source: "Hooke (1678)",
    example: r#"{ model = "spring", joints = [1] }"#,
}

#[typetag::serde(name = "spring")]
impl ArmTerm for Spring {
    declares_term! { "spring", invariants: [EvenInLoad, ContinuousInVelocity, RateIndependent, Memoryless] }

    fn joints(&self, robot_joints: usize) -> Vec<usize> {
        self.joints.resolve(robot_joints)
    }

    fn columns(&self, robot_joints: usize) -> Vec<Parameter> {
        self.joints.columns(robot_joints, &[("k", "Nm/rad"), ("k_q0", "Nm")][..self.per_joint()])
    }

    fn acts_on(&self, column: usize, joint: usize, robot_joints: usize) -> bool {
        self.joints.owns(robot_joints, self.per_joint(), column, joint)
    }

    fn is_load(&self) -> bool {
        true
    }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        let mut complaints = self.joints.complaints("spring", robot_joints);
        if let Some(rest) = self.rest_rad.filter(|rest| !rest.is_finite()) {
            complaints.push(ModelError::parameter(
                "spring",
                "rest_rad",
                format!("must be an angle, is {rest}"),
            ));
        }
        verdict(complaints)
    }

    fn evaluate(&self, series: &ArmSeries<'_>, _state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let (motion, rest) = (series.motion, self.rest_rad.unwrap_or(0.0));
        self.joints.write_own_rows(motion.joints(), self.per_joint(), out, |_, joint, own| {
            for (o, q) in own.column_mut(0).iter_mut().zip(motion.position_rad(joint)) {
                *o = q - rest;
            }
            if self.rest_rad.is_none() {
                own.column_mut(1).fill(-1.0);
            }
        });
        Ok(())
    }
}
