//! `torque_ripple`: torque that repeats with the joint's angle.
//!
//! # Equation
//! τ_j = Σ_k (A_k sin(k N q_j) + B_k cos(k N q_j)), amplitude √(A_k² + B_k²)
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `cycles_per_revolution` | 1 | N, periods of the first order per turn of the joint |
//! | `orders` | – | the k, distinct and positive; `[1]` unless given |
//! | `joints` | – | joints that have the term; all unless given |
//!
//! Harmonic drives ripple at N = twice the gear ratio (the wave generator passes a tooth pair twice per turn),
//! cogging of a motor with p poles at the gear ratio times p. N need not be an integer.
//!
//! # Columns
//! | name | unit | column |
//! |---|---|---|
//! | `sin<k>_<j>` | Nm | sin(k N q_j) in row j |
//! | `cos<k>_<j>` | Nm | cos(k N q_j) in row j |
//!
//! # Use when
//! Lines stand in the residual's spectrum against q, above the low-pass of the preprocessing: k N |q̇|/2π must stay
//! below its cut-off, or the evidence is filtered away and what is left is aliasing.
//!
//! # Source
//! Tuttle and Seering (1996), *A nonlinear model of a harmonic drive gear transmission*; Hung and Ding (1993) for
//! cogging.

use aurt_traits::{ArmSeries, ArmTerm, Columns, ModelError, Parameter, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::arm_terms::joint_selection::JointSelection;
use crate::shape::verdict;

/// Torque that repeats with the joint's angle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TorqueRipple {
    /// Periods N of the first order per turn of the joint.
    pub cycles_per_revolution: f64,
    /// The orders k.
    #[serde(default = "first_order")]
    pub orders: Vec<u32>,
    /// Joints that have the term.
    #[serde(default, skip_serializing_if = "JointSelection::is_all")]
    pub joints: JointSelection,
}

fn first_order() -> Vec<u32> {
    vec![1]
}

register_model! {
    slot: ArmTerm,
    name: "torque_ripple",
    summary: "torque that repeats with the joint's angle (gear mesh, cogging)",
    equation: "τ_j = Σ_k A_k sin(k N q_j) + B_k cos(k N q_j), N = cycles_per_revolution",
    use_when: "lines stand in the residual's spectrum against q, below the low-pass of the preprocessing",
    source: "Tuttle and Seering (1996); Hung and Ding (1993)",
    example: r#"{ model = "torque_ripple", cycles_per_revolution = 2.0, orders = [1, 2], joints = [0, 1] }"#,
}

#[typetag::serde(name = "torque_ripple")]
impl ArmTerm for TorqueRipple {
    declares_term! {
        "torque_ripple",
        invariants: [EvenInLoad, BoundedByOne, ContinuousInVelocity, RateIndependent, Memoryless]
    }

    fn joints(&self, robot_joints: usize) -> Vec<usize> {
        self.joints.resolve(robot_joints)
    }

    fn columns(&self, robot_joints: usize) -> Vec<Parameter> {
        let names: Vec<String> =
            self.orders.iter().flat_map(|k| [format!("sin{k}"), format!("cos{k}")]).collect();
        let symbols: Vec<(&str, &str)> = names.iter().map(|name| (name.as_str(), "Nm")).collect();
        self.joints.columns(robot_joints, &symbols)
    }

    fn acts_on(&self, column: usize, joint: usize, robot_joints: usize) -> bool {
        self.joints.owns(robot_joints, 2 * self.orders.len(), column, joint)
    }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        let mut complaints = self.joints.complaints("torque_ripple", robot_joints);
        let mut complain = |parameter: &str, reason: String| {
            complaints.push(ModelError::parameter("torque_ripple", parameter, reason));
        };
        let cycles = self.cycles_per_revolution;
        if !(cycles.is_finite() && cycles > 0.0) {
            complain("cycles_per_revolution", format!("must be positive, is {cycles}"));
        }
        if self.orders.is_empty() {
            complain("orders", "must not be empty".into());
        }
        for (i, order) in self.orders.iter().enumerate() {
            if *order == 0 {
                complain("orders", "must be positive; order 0 is `current_offset`".into());
            }
            if self.orders[..i].contains(order) {
                complain("orders", format!("must be distinct, contain {order} twice"));
            }
        }
        verdict(complaints)
    }

    fn evaluate(&self, series: &ArmSeries<'_>, _state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let motion = series.motion;
        self.joints.write_own_rows(motion.joints(), 2 * self.orders.len(), out, |_, joint, own| {
            for (i, order) in self.orders.iter().enumerate() {
                let cycles = f64::from(*order) * self.cycles_per_revolution;
                for (n, q) in motion.position_rad(joint).iter().enumerate() {
                    let (sin, cos) = libm::sincos(cycles * q);
                    own.column_mut(2 * i)[n] = sin;
                    own.column_mut(2 * i + 1)[n] = cos;
                }
            }
        });
        Ok(())
    }
}
