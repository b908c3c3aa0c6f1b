//! `base_tilt`: a base that is not mounted as the model believes.
//!
//! # Equation
//! A base turned about its x axis by ρ (roll) and then about its own y axis by ϑ (pitch) sees the gravity R_y(ϑ)ᵀ R_x(ρ)ᵀ g.
//! Torque is linear in gravity, so
//! τ_j = ρ Σ_p Y_j,p(q; (h − g)/a) π_p + ϑ Σ_p Y_j,p(q; (R_y(b)ᵀ h − h)/b) π_p with h = R_x(a)ᵀ g
//! for ρ = a and ϑ = b, and to first order for angles near these, where Y(q; e) is the rigid-body regressor at rest under the
//! gravity e; for a = b = 0 the gravities are −x̂ × g and −ŷ × g, and the error is θ²/2 of the holding torque: 5·10⁻³ of it at 0.1 rad.
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
//! | `around_rad` | rad | a and b; zeros unless given |
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
//! Secant of the rigid-body regressor in gravity; for the practice, Khalil and Dombre (2002), *Modeling,
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
    /// Roll and pitch for which the torque is exact; zeros where empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub around_rad: Vec<f64>,
    /// Whether joint 0 has the columns sin q_0 and cos q_0.
    pub first_axis: bool,
}

register_model! {
    slot: ArmTerm,
    name: "base_tilt",
    summary: "a base that is not mounted as the model believes (small roll and pitch)",
    equation: "τ = roll Y(q; (R_x(a)ᵀg − g)/a) π + pitch Y(q; (R_y(b)ᵀ − 1)R_x(a)ᵀg/b) π, −x̂ × g and −ŷ × g for a = b = 0, π of a fit",
    use_when: "a robot was moved after its calibration; hold the calibrated coefficients fixed",
    source: "secant in gravity; Khalil and Dombre (2002)",
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
        let bodies = known_bodies!(self, "base_tilt");
        let mut complaints = bodies.complaints();
        complaints.extend(bodies.around_complaints("around_rad", &self.around_rad, 2));
        verdict(complaints)
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
            let around = |k: usize| self.around_rad.get(k).copied().unwrap_or(0.0);
            for (column, gravity) in
                slopes(series.rigid_body.gravity_m_s2(), [around(0), around(1)]).into_iter().enumerate()
            {
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

/// The change of gravity per roll, and per pitch beside that roll: (R_x(a)ᵀ g − g)/a and (R_y(b)ᵀ h − h)/b with h = R_x(a)ᵀ g.
fn slopes([x, y, z]: [f64; 3], [a, b]: [f64; 2]) -> [[f64; 3]; 2] {
    // sin(v)/v and (1 − cos v)/v.
    let of = |v: f64| {
        let half = libm::sin(0.5 * v);
        if v == 0.0 { [1.0, 0.0] } else { [libm::sin(v) / v, 2.0 * half * half / v] }
    };
    let ([odd, even], [odd_b, even_b]) = (of(a), of(b));
    let roll = [0.0, odd * z - even * y, -odd * y - even * z];
    let [hx, hz] = [x, z + a * roll[2]];
    [roll, [-odd_b * hz - even_b * hx, 0.0, odd_b * hx - even_b * hz]]
}
