//! `drive_efficiency`: load-dependent friction that differs between driving and being driven.
//!
//! # Equation
//! τ_j = η_+,j |τ_J| sgn q̇_j where the drive does work on the load (τ_J q̇_j > 0),
//! τ_j = η_−,j |τ_J| sgn q̇_j where the load drives it (τ_J q̇_j < 0), else 0.
//!
//! # What of it is friction
//! The even part (η_+ + η_−)/2 multiplies |τ_J| sgn q̇: the load-dependent Coulomb friction of `absolute` × `sign`
//! (leave that out on the same joints). The odd part (η_+ − η_−)/2 multiplies |τ_J| sgn q̇ · sgn(τ_J q̇) = τ_J: it
//! is exactly an error of the drive's gain. Without a known load or known torque constants the two cannot be told
//! apart, and the odd part must not be read as friction.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `joints` | – | joints that have the term; all unless given |
//!
//! # Use when
//! The residual differs by the sign of power: worm and harmonic drives, counter-weighted joints. On arms that
//! hardly hold loads the columns vanish.
//!
//! # Source
//! Hamon, Gautier, Garrec (2010), *Dynamic identification of robots with a dry friction model depending on load
//! and velocity*; Bittencourt, Gunnarsson (2012).
//!
//! # Invariants
//! Of the sign of velocity, passive, rate-independent, memoryless. Not even in load: reversing it swaps the two.

use aurt_traits::{ArmSeries, ArmTerm, Columns, ModelError, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::arm_terms::joint_selection::JointSelection;
use crate::hysteresis::sign::sign_beyond;
use crate::shape::verdict;

/// Load-dependent friction by the sign of power.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DriveEfficiency {
    /// Joints that have the term.
    #[serde(default, skip_serializing_if = "JointSelection::is_all")]
    pub joints: JointSelection,
}

register_model! {
    slot: ArmTerm,
    name: "drive_efficiency",
    summary: "load-dependent friction that differs between driving and being driven",
    equation: "τ_j = driving |τ_J| sgn q̇_j for τ_J q̇_j > 0, driven |τ_J| sgn q̇_j for τ_J q̇_j < 0; half their \
               difference is a gain error",
    use_when: "the residual differs by the sign of power; in place of coulomb `absolute`",
    source: "Hamon, Gautier, Garrec (2010); Bittencourt, Gunnarsson (2012)",
    example: r#"{ model = "drive_efficiency", joints = [0, 1] }"#,
}

#[typetag::serde(name = "drive_efficiency")]
impl ArmTerm for DriveEfficiency {
    declares_term! {
        "drive_efficiency",
        per joint: ["driving" in "1", "driven" in "1"],
        invariants: [SignOfVelocity, Passive, RateIndependent, Memoryless]
    }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        verdict(self.joints.complaints("drive_efficiency", robot_joints))
    }

    fn evaluate(&self, series: &ArmSeries<'_>, _state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let motion = series.motion;
        self.joints.write_own_rows(motion.joints(), 2, out, |_, joint, own| {
            let loads = series.load_torque(joint);
            for (n, (v, load)) in motion.velocity_rad_s(joint).iter().zip(loads).enumerate() {
                let friction = load.abs() * sign_beyond(*v, 0.0);
                let drives = (*load > 0.0) == (*v > 0.0);
                own.column_mut(0)[n] = if drives { friction } else { 0.0 };
                own.column_mut(1)[n] = if drives { 0.0 } else { friction };
            }
        });
        Ok(())
    }
}
