//! `joint_compliance`: a joint that gives way under its load, in proportion to it.
//!
//! # Equation
//! The encoder of the motor shows q, the link stands at q + δ e_j with δ = −c τ_j(q + δ e_j), where τ is the torque of the rigid
//! bodies alone (loads of other terms, as of a counterbalance, do not bend the joint), τ_j the load of the joint, and c = 1/K the
//! compliance of gear, bearing and shaft. The torque that acts is τ(q + δ e_j) = τ(q) + c (τ(q + δ e_j) − τ(q)) / a for c = a, and
//! to first order for a c near a; for a = 0 the quotient is −τ_j ∂τ/∂q_j. A load of 100 Nm that changes by 100 Nm/rad, on
//! 10⁴ Nm/rad, changes by 1 Nm.
//!
//! Velocity and acceleration are those of the motor: M_j δ̈ is left out, the share (ω/ω₀)² of the load's part of frequency ω on a resonance
//! of ω₀. As in `base_tilt`, inertial values are configuration, standard-parameter indices and values of a fit; without them all
//! columns are zero.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `joints` | – | joints that give way; all unless given |
//! | `around_rad_nm` | rad/Nm | a, one for each of the joints; zeros unless given |
//! | `inertial_columns` | – | indices of standard inertial parameters, ten per link; empty unless given |
//! | `inertial_values` | as those | their values |
//!
//! # Use when
//! Gears, belts or bearings are soft beside the loads that they carry and the arm moves slowly: strain-wave gears under long levers, cable
//! drives, large arms. A joint that turns about the direction of gravity and carries all others does not show it.
//!
//! # Source
//! Spong (1987), *Modeling and control of elastic joint robots*, at rest; for the practice, Dumas et al. (2011), *Joint stiffness
//! identification of six-revolute industrial serial robots*.

use aurt_traits::{ArmSeries, ArmTerm, Columns, ModelError, Parameter, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::arm_terms::joint_selection::JointSelection;
use crate::known_bodies::{STEP_RAD, torque, turned};

/// A joint that gives way under its load.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct JointCompliance {
    /// Joints that give way.
    #[serde(skip_serializing_if = "JointSelection::is_all")]
    pub joints: JointSelection,
    /// The compliances for which the torque is exact, one for each joint; zeros where empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub around_rad_nm: Vec<f64>,
    /// Indices of the standard inertial parameters whose values are known.
    pub inertial_columns: Vec<usize>,
    /// Their values.
    pub inertial_values: Vec<f64>,
}

/// Evaluations of the deflection under the load that it changes. Each leaves the share c ∂τ_j/∂q_j of the error of the one before, which is
/// below one of any arm that stands.
const ROUNDS: usize = 3;

/// Below it the quotient is the slope: a load of 100 Nm turns the joint by 10⁻⁷ rad, and rounding takes ε/(a τ_j) ≈ 2·10⁻⁹ of the quotient.
const RIGID_RAD_NM: f64 = 1e-9;
register_model! {
    slot: ArmTerm,
    name: "joint_compliance",
    summary: "a joint that gives way under its load",
    equation: "τ = Σ_j joint_compliance_j (τ_RBD(q + δ e_j) − τ_RBD(q)) / a, δ = −a τ_RBD,j, −τ_RBD,j ∂τ_RBD/∂q_j for a = 0, τ_RBD of a fit",
    use_when: "gears are soft beside the loads and the arm moves far below their resonances; the bodies are those of a fit",
    source: "Spong (1987) at rest; Dumas et al. (2011)",
    example: r#"{ model = "joint_compliance", joints = [1], inertial_columns = [6, 9, 16, 19], inertial_values = [0.9, 3.0, 0.4, 2.0] }"#,
}

#[typetag::serde(name = "joint_compliance")]
impl ArmTerm for JointCompliance {
    declares_term! {
        "joint_compliance",
        invariants: [EvenInLoad, ContinuousInVelocity, Memoryless]
    }

    declares_known_bodies! { "joint_compliance" in "rad/Nm", around: around_rad_nm }
}

/// The torque's change per compliance.
fn slope(series: &ArmSeries<'_>, standard: &[f64], joint: usize, around: f64) -> Result<Vec<f64>> {
    let shown = torque(series.rigid_body, series.motion, standard);
    let samples = series.motion.samples();
    let own = joint * samples..(joint + 1) * samples;
    if around.abs() < RIGID_RAD_NM {
        let [ahead, behind] = [STEP_RAD, -STEP_RAD].map(|by| turned(series, standard, joint, |_| by));
        let slopes = ahead?.into_iter().zip(behind?).map(|(a, b)| (a - b) / (2.0 * STEP_RAD));
        return Ok(slopes.enumerate().map(|(k, slope)| -slope * shown[own.start + k % samples]).collect());
    }
    let mut moved = shown.clone();
    for _ in 0..ROUNDS {
        let load = moved[own.clone()].to_vec();
        moved = turned(series, standard, joint, |k| -around * load[k])?;
    }
    Ok(moved.iter().zip(shown).map(|(moved, shown)| (moved - shown) / around).collect())
}
