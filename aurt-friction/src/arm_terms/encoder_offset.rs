//! `encoder_offset`: a joint's encoder whose zero is not that of the model.
//!
//! # Equation
//! Where the joint stands at q, the recording has q + o e_j. With τ the torque of the rigid bodies, the one that acts is
//! τ(q_recorded − o e_j) = τ(q_recorded) + o (τ(q_recorded − a e_j) − τ(q_recorded)) / a for o = a, and to first order for an o near a;
//! for a = 0 the quotient is −∂τ/∂q_j. The error is (o² − o a)/2 of the holding torque: with a = 0, 5·10⁻⁵ of it at 0.01 rad,
//! 5·10⁻³ at 0.1 rad.
//!
//! # Linear only around known bodies
//! The product of angle and inertial parameter is not linear. As in `base_tilt`, the inertial values are configuration: standard-parameter
//! indices and values of a fit. Without them all columns are zero, and a calibration reports the offsets as not excited.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `joints` | – | joints whose encoders have an offset; all unless given |
//! | `around_rad` | rad | a, one for each of the joints; zeros unless given |
//! | `inertial_columns` | – | indices of standard inertial parameters, ten per link; empty unless given |
//! | `inertial_values` | as those | their values |
//!
//! # Use when
//! An encoder, a motor or a gear was exchanged, a belt or a spline has jumped a tooth, or a robot was mastered anew. On a joint
//! that turns about the direction of gravity and carries all others (a vertical first axis) the torque does not depend on the zero.
//!
//! # Source
//! Secant of the rigid-body torque in the position; for the practice, Khalil and Dombre (2002), *Modeling, Identification
//! and Control of Robots*, on the calibration of joint zeros.

use aurt_traits::{ArmSeries, ArmTerm, Columns, ModelError, Parameter, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::arm_terms::joint_selection::JointSelection;
use crate::known_bodies::{STEP_RAD, turned};

/// A joint's encoder whose zero is not that of the model.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EncoderOffset {
    /// Joints whose encoders have an offset.
    #[serde(skip_serializing_if = "JointSelection::is_all")]
    pub joints: JointSelection,
    /// The offsets for which the torque is exact, one for each joint; zeros where empty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub around_rad: Vec<f64>,
    /// Indices of the standard inertial parameters whose values are known.
    pub inertial_columns: Vec<usize>,
    /// Their values.
    pub inertial_values: Vec<f64>,
}

register_model! {
    slot: ArmTerm,
    name: "encoder_offset",
    summary: "an encoder whose zero is not that of the model",
    equation: "τ = Σ_j encoder_offset_j (τ_RBD(q − a e_j) − τ_RBD(q)) / a, −∂τ_RBD/∂q_j for a = 0, τ_RBD of a fit",
    use_when: "a joint's zero was lost after the calibration; hold the calibrated coefficients fixed",
    source: "secant in the position; Khalil and Dombre (2002)",
    example: r#"{ model = "encoder_offset", joints = [1], inertial_columns = [6, 9, 16, 19], inertial_values = [0.9, 3.0, 0.4, 2.0] }"#,
}

#[typetag::serde(name = "encoder_offset")]
impl ArmTerm for EncoderOffset {
    declares_term! {
        "encoder_offset",
        invariants: [EvenInLoad, ContinuousInVelocity, Memoryless]
    }

    declares_known_bodies! { "encoder_offset" in "rad", around: around_rad }
}

/// The torque's change per offset.
fn slope(series: &ArmSeries<'_>, standard: &[f64], joint: usize, around: f64) -> Result<Vec<f64>> {
    let [from, to] = if around.abs() < STEP_RAD { [STEP_RAD, -STEP_RAD] } else { [0.0, -around] };
    let [shown, real] = [from, to].map(|by| turned(series, standard, joint, |_| by));
    Ok(shown?.iter().zip(real?).map(|(shown, real)| (real - shown) / (from - to)).collect())
}
