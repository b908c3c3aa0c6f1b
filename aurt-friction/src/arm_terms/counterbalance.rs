//! `counterbalance`: a straight spring on a lever, as balances the shoulder of many arms.
//!
//! # Equation
//! The spring joins a point at the distance a from the joint's axis, on the link, to one at the distance b, on the
//! body before it. With φ = q − q_d its length is l(φ) = √(a² + b² − 2ab cos φ), shortest at the dead centre q_d.
//! From its energy ½ k (l − l_0)² the drive holds
//! τ = k (l − l_0) dl/dφ = k·ab sin φ − k l_0·(ab sin φ)/l.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `joint` | – | the balanced joint |
//! | `crank_m` | m | a |
//! | `anchor_m` | m | b, other than a |
//! | `dead_centre_rad` | rad | q_d, shape, −π–π |
//!
//! # Columns
//! | name | unit | column |
//! |---|---|---|
//! | `k_<j>` | Nm/m² | ab sin φ; the coefficient is the stiffness k in N/m |
//! | `k_l0_<j>` | Nm/m | −(ab sin φ)/l; the coefficient is k l_0 in N, smaller by the preload if there is one |
//!
//! # Use when
//! The arm has such a balancer. On a horizontal axis the first column repeats a first moment of the links, so k
//! shows in the second alone and asks for a wide range of q.
//!
//! # Source
//! Geometry and Hooke's law; compare Khalil and Dombre (2002), *Modeling, Identification and Control of Robots*.

use std::f64::consts::PI;

use aurt_traits::{
    ArmSeries, ArmTerm, Columns, ModelError, Parameter, Result, ShapeParameter, register_model,
};
use serde::{Deserialize, Serialize};

use crate::shape::{Shape, accepted, out_of_bounds, verdict};

const DEAD_CENTRE: Shape = Shape::linear("dead_centre_rad", "rad", -PI, PI);

/// A straight spring on a lever.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Counterbalance {
    /// The balanced joint.
    pub joint: usize,
    /// Distance a of the spring's end on the link from the joint's axis, in m.
    pub crank_m: f64,
    /// Distance b of its other end from the joint's axis, in m.
    pub anchor_m: f64,
    /// Angle q_d at which the spring is shortest, in rad.
    pub dead_centre_rad: f64,
}

register_model! {
    slot: ArmTerm,
    name: "counterbalance",
    summary: "a straight spring on a lever that balances a joint",
    equation: "τ_j = k ab sin φ − k_l0 (ab sin φ)/l, φ = q_j − dead_centre_rad, l = √(a² + b² − 2ab cos φ)",
    use_when: "the arm has a spring balancer on a lever; a spring linear in the angle is `spring`",
    source: "Hooke's law; Khalil and Dombre (2002)",
    example: r#"{ model = "counterbalance", joint = 1, crank_m = 0.1, anchor_m = 0.4, dead_centre_rad = 0.0 }"#,
}

#[typetag::serde(name = "counterbalance")]
impl ArmTerm for Counterbalance {
    declares_term! {
        "counterbalance",
        invariants: [EvenInLoad, ContinuousInVelocity, RateIndependent, Memoryless]
    }

    fn joints(&self, _robot_joints: usize) -> Vec<usize> {
        vec![self.joint]
    }

    fn columns(&self, _robot_joints: usize) -> Vec<Parameter> {
        let j = self.joint;
        vec![Parameter::new(format!("k_{j}"), "Nm/m^2"), Parameter::new(format!("k_l0_{j}"), "Nm/m")]
    }

    fn is_load(&self) -> bool {
        true
    }

    fn shape_parameters(&self) -> Vec<ShapeParameter> {
        vec![DEAD_CENTRE.at(self.dead_centre_rad)]
    }

    fn set_shape(&mut self, values: &[f64]) -> Result<(), ModelError> {
        if let [angle] = accepted("counterbalance", &self.shape_parameters(), values)?[..] {
            self.dead_centre_rad = angle;
        }
        Ok(())
    }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        let mut complaints = out_of_bounds("counterbalance", &self.shape_parameters());
        let mut complain = |parameter: &str, reason: String| {
            complaints.push(ModelError::parameter("counterbalance", parameter, reason));
        };
        if self.joint >= robot_joints {
            let last = robot_joints.saturating_sub(1);
            complain(
                "joint",
                format!("must lie between 0 and {last} (joints count from 0), is {}", self.joint),
            );
        }
        for (key, length) in [("crank_m", self.crank_m), ("anchor_m", self.anchor_m)] {
            if !(length.is_finite() && length > 0.0) {
                complain(key, format!("must be positive, is {length}"));
            }
        }
        if self.crank_m == self.anchor_m {
            complain(
                "anchor_m",
                "must differ from `crank_m`, or the spring vanishes at its dead centre".into(),
            );
        }
        verdict(complaints)
    }

    fn evaluate(&self, series: &ArmSeries<'_>, _state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let (a, b) = (self.crank_m, self.anchor_m);
        for (n, q) in series.motion.position_rad(self.joint).iter().enumerate() {
            let (sin, cos) = libm::sincos(q - self.dead_centre_rad);
            let arm = a * b * sin;
            out.column_mut(0)[n] = arm;
            out.column_mut(1)[n] = -arm / (a * a + b * b - 2.0 * a * b * cos).sqrt();
        }
        Ok(())
    }
}
