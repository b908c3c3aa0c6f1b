//! `temperature`: friction that drifts with the time since the recording began, as warming lubricant does.
//!
//! # Equation
//! τ_j = (F_T,j sgn q̇_j + F_Tv,j q̇_j) · ln(1 + t / t_w), t the time since the recording began.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `joints` | – | joints that have the term; all unless given |
//! | `warming_time_s` | s | t_w, 60 unless given: later than this, equal factors of time bring equal changes |
//!
//! # Use when
//! No temperature was recorded and the same motion needs less torque late in a recording than early in it.
//!
//! # Source
//! Bittencourt and Gunnarsson (2012), *Static friction in a robot joint – modeling and identification of load
//! and temperature effects*; the logarithm of uptime stands in for the temperature, which nobody logs.

use aurt_traits::{ArmSeries, ArmTerm, Columns, ModelError, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::arm_terms::joint_selection::JointSelection;
use crate::shape::verdict;

/// Friction that drifts with uptime.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Temperature {
    /// Joints that have the term.
    #[serde(default, skip_serializing_if = "JointSelection::is_all")]
    pub joints: JointSelection,
    /// Time after which the drift becomes logarithmic, s.
    #[serde(default = "default_warming_time_s")]
    pub warming_time_s: f64,
}

const fn default_warming_time_s() -> f64 {
    60.0
}

register_model! {
    slot: ArmTerm,
    name: "temperature",
    summary: "friction that drifts with the time since the recording began",
    equation: "τ_j = (F_T sgn q̇ + F_Tv q̇) ln(1 + t/warming_time_s)",
    use_when: "the same motion needs less torque late in a recording than early in it",
    source: "Bittencourt and Gunnarsson (2012)",
    example: r#"{ model = "temperature", joints = [1], warming_time_s = 60.0 }"#,
}

#[typetag::serde(name = "temperature")]
impl ArmTerm for Temperature {
    declares_term! { "temperature", per joint: ["F_T" in "Nm", "F_Tv" in "Nm s/rad"], invariants: [] }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        let mut complaints = self.joints.complaints("temperature", robot_joints);
        if !(self.warming_time_s.is_finite() && self.warming_time_s > 0.0) {
            complaints.push(ModelError::parameter(
                "temperature",
                "warming_time_s",
                format!("must be positive, is {}", self.warming_time_s),
            ));
        }
        verdict(complaints)
    }

    fn state_len(&self, _robot_joints: usize) -> usize {
        1
    }

    /// The state is the time at which the recording began.
    fn initial_state(&self, first: &ArmSeries<'_>) -> Vec<f64> {
        vec![first.motion.time_s().first().copied().unwrap_or(0.0)]
    }

    fn evaluate(&self, series: &ArmSeries<'_>, state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let (motion, start) = (series.motion, state[0]);
        self.joints.write_own_rows(motion.joints(), 2, out, |_, joint, own| {
            for (k, (t, v)) in motion.time_s().iter().zip(motion.velocity_rad_s(joint)).enumerate() {
                let warmth = libm::log1p(((t - start) / self.warming_time_s).max(0.0));
                let sign = if *v == 0.0 { 0.0 } else { v.signum() };
                own.column_mut(0)[k] = warmth * sign;
                own.column_mut(1)[k] = warmth * v;
            }
        });
        Ok(())
    }
}
