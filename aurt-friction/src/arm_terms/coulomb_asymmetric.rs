//! `coulomb_asymmetric`: dry friction with a level of its own for each direction.
//!
//! # Equation
//! τ_j = F_C+,j for q̇_j > v_0, −F_C−,j for q̇_j < −v_0, else 0
//!
//! Equation (6) asks for a level that is even; this one is not, so it stands outside. Use it with
//! `coulomb = { model = "absent" }` on the same joints: beside `constant` there would be three coefficients for two
//! levels.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `joints` | – | joints that have the term; all unless given |
//! | `rest_velocity_rad_s` | rad/s | v_0, as for `sign`; 0 unless given |
//!
//! # Use when
//! Friction differs by direction and the recording rests for a while: while a joint moves, the difference of the
//! two levels and an offset of the current sensor (`current_offset`) are the same thing.
//!
//! # Source
//! Armstrong-Hélouvry (1991), *Control of Machines with Friction*.

use aurt_traits::{ArmSeries, ArmTerm, Columns, Invariant, Invariants, ModelError, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::arm_terms::joint_selection::JointSelection;
use crate::hysteresis::sign::{rest_complaint, sign_beyond};
use crate::shape::verdict;

/// Dry friction with a level for each direction.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoulombAsymmetric {
    /// Joints that have the term.
    #[serde(default, skip_serializing_if = "JointSelection::is_all")]
    pub joints: JointSelection,
    /// Velocity up to which a joint rests, in rad/s.
    #[serde(default)]
    pub rest_velocity_rad_s: f64,
}

register_model! {
    slot: ArmTerm,
    name: "coulomb_asymmetric",
    summary: "dry friction with a level of its own for each direction",
    equation: "τ_j = F_C_pos for q̇_j > rest_velocity_rad_s, −F_C_neg for q̇_j < −rest_velocity_rad_s, else 0",
    use_when: "friction differs by direction; with coulomb `absent`, and rest in the recording",
    source: "Armstrong-Hélouvry (1991)",
    example: r#"{ model = "coulomb_asymmetric", joints = [0, 1], rest_velocity_rad_s = 0.0 }"#,
}

#[typetag::serde(name = "coulomb_asymmetric")]
impl ArmTerm for CoulombAsymmetric {
    declares_term! { "coulomb_asymmetric", per joint: ["F_C_pos" in "Nm", "F_C_neg" in "Nm"] }

    fn invariants(&self) -> Invariants {
        Invariants::of(&[
            Invariant::EvenInLoad,
            Invariant::BoundedByOne,
            Invariant::SignOfVelocity,
            Invariant::Passive,
            Invariant::Memoryless,
        ])
        .with(Invariant::RateIndependent, self.rest_velocity_rad_s == 0.0)
    }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        let mut complaints = self.joints.complaints("coulomb_asymmetric", robot_joints);
        complaints.extend(rest_complaint("coulomb_asymmetric", self.rest_velocity_rad_s));
        verdict(complaints)
    }

    fn evaluate(&self, series: &ArmSeries<'_>, _state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let motion = series.motion;
        self.joints.write_own_rows(motion.joints(), 2, out, |_, joint, own| {
            for (n, v) in motion.velocity_rad_s(joint).iter().enumerate() {
                let sign = sign_beyond(*v, self.rest_velocity_rad_s);
                own.column_mut(0)[n] = sign.max(0.0);
                own.column_mut(1)[n] = sign.min(0.0);
            }
        });
        Ok(())
    }
}
