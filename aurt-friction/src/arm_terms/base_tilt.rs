//! `base_tilt`: a base that is not mounted as the model believes.
//!
//! # Equation
//! A base turned by a small rotation θ = ρ x̂ + ϑ ŷ (roll, pitch, about the base frame's axes) sees the gravity
//! g − θ × g. Torque is linear in gravity, so
//! τ_j = ρ Σ_p Y_j,p(q; −x̂ × g) π_p + ϑ Σ_p Y_j,p(q; −ŷ × g) π_p,
//! where Y(q; e) is the rigid-body regressor at rest under the gravity e. The error is of second order,
//! θ²/2 of the holding torque: 5·10⁻⁵ of it at 0.01 rad, 5·10⁻³ at 0.1 rad.
//!
//! # Linear only around known bodies
//! Angle times inertial parameter is no linear term. The inertial values π_p are therefore configuration: those of
//! a fit, as standard-parameter indices and values (base parameters at the indices of their kept columns serve as
//! well as standard ones; torques are the same).
//! Without them both columns are zero, and a calibration reports roll and pitch as not excited.
//!
//! Base parameters found under a gravity along the first axis lack the first moments about that axis, which a tilt
//! makes visible on joint 0; `first_axis` adds them as two free columns.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `inertial_columns` | – | indices of standard inertial parameters, ten per link; empty unless given |
//! | `inertial_values` | as those | their values |
//! | `first_axis` | – | whether joint 0 has the columns sin q_0 and cos q_0; false unless given |
//!
//! # Columns
//! | name | unit | column |
//! |---|---|---|
//! | `roll` | rad | torque per roll, on all joints |
//! | `pitch` | rad | torque per pitch, on all joints |
//! | `sin_q0`, `cos_q0` | Nm | sin q_0 and cos q_0 on joint 0, with `first_axis` |
//!
//! # Use when
//! A robot was moved after its calibration, or its mounting angle is known to some degrees only. A tilt about the
//! direction of gravity itself does nothing.
//!
//! # Source
//! Linearisation of the rigid-body regressor in gravity; for the practice, Khalil and Dombre (2002), *Modeling,
//! Identification and Control of Robots*.

use aurt_traits::{ArmSeries, ArmTerm, Columns, ModelError, Motion, Parameter, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::known_bodies::torque;
use crate::shape::verdict;

/// A base that is not mounted as the model believes.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct BaseTilt {
    /// Indices of the standard inertial parameters whose values are known.
    pub inertial_columns: Vec<usize>,
    /// Their values.
    pub inertial_values: Vec<f64>,
    /// Whether joint 0 has the columns sin q_0 and cos q_0.
    pub first_axis: bool,
}

register_model! {
    slot: ArmTerm,
    name: "base_tilt",
    summary: "a base that is not mounted as the model believes (small roll and pitch)",
    equation: "τ = roll Y(q; −x̂ × g) π + pitch Y(q; −ŷ × g) π, Y the rigid-body regressor at rest, π of a fit",
    use_when: "a robot was moved after its calibration; hold the calibrated coefficients fixed",
    source: "linearisation in gravity; Khalil and Dombre (2002)",
    example: r#"{ model = "base_tilt", inertial_columns = [6, 9, 16, 19], inertial_values = [0.9, 3.0, 0.4, 2.0], first_axis = false }"#,
}

#[typetag::serde(name = "base_tilt")]
impl ArmTerm for BaseTilt {
    declares_term! {
        "base_tilt",
        invariants: [EvenInLoad, ContinuousInVelocity, RateIndependent, Memoryless]
    }

    declares_known_bodies! {}

    fn columns(&self, _robot_joints: usize) -> Vec<Parameter> {
        let mut columns = vec![Parameter::new("roll", "rad"), Parameter::new("pitch", "rad")];
        if self.first_axis {
            columns.extend([Parameter::new("sin_q0", "Nm"), Parameter::new("cos_q0", "Nm")]);
        }
        columns
    }

    fn acts_on(&self, column: usize, joint: usize, _robot_joints: usize) -> bool {
        column < 2 || joint == 0
    }

    fn validate(&self, _robot_joints: usize) -> Result<(), Vec<ModelError>> {
        verdict(known_bodies!(self, "base_tilt").complaints())
    }

    fn evaluate(&self, series: &ArmSeries<'_>, state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let (motion, standard) =
            (series.motion, known_bodies!(self, "base_tilt").standard(state[0] as usize)?);
        let (joints, samples) = (motion.joints(), motion.samples());
        let per_joint = self.columns(joints).len();
        for column in 0..out.columns() {
            out.column_mut(column).fill(0.0);
        }
        if samples > 0 && !self.inertial_columns.is_empty() {
            let position = (0..joints).flat_map(|j| motion.position_rad(j)).copied().collect();
            let rest = vec![0.0; joints * samples];
            let at_rest = Motion::new(joints, motion.time_s().to_vec(), position, rest.clone(), rest)?;
            let [x, y, z] = series.rigid_body.gravity_m_s2();
            for (column, gravity) in [[0.0, z, -y], [-z, 0.0, x]].into_iter().enumerate() {
                let holding = torque(&*series.rigid_body.with_gravity(gravity), at_rest.view(), &standard);
                for (joint, values) in holding.chunks_exact(samples).enumerate() {
                    out.column_mut(joint * per_joint + column).copy_from_slice(values);
                }
            }
        }
        if self.first_axis {
            for (n, q) in motion.position_rad(0).iter().enumerate() {
                let (sin, cos) = libm::sincos(*q);
                out.column_mut(2)[n] = sin;
                out.column_mut(3)[n] = cos;
            }
        }
        Ok(())
    }
}
