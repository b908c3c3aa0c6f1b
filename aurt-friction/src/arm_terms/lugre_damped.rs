//! `lugre_damped`: the LuGre model with its bristle damping.
//!
//! # Equation
//! τ_j = F_S H + σ_1 ż with H as in the hysteresis model `lugre` and ż = q̇ − |q̇| H/g(q̇), the bristles' velocity
//! (z = p H). Linear in F_S = σ_0 p and σ_1. The damping exceeds |H| ≤ 1, so the model stands outside equation
//! (6): use it with `coulomb = { model = "absent" }` on the same joints.
//!
//! H is exact for a velocity that is constant between samples; ż is formed with the sample's velocity.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `joints` | – | joints that have the term, with common shape; all unless given |
//! | `presliding_rad` | rad | p = F_S/σ_0, shape, 10⁻⁵–0.5, searched in logarithms; 0.01 unless given |
//! | `stribeck_velocity_rad_s` | rad/s | v_S, shape, 0.001–1, searched in logarithms; 0.05 unless given |
//! | `coulomb_ratio` | 1 | r = F_C/F_S, shape, 0.05–1; 0.8 unless given |
//! | `stribeck_exponent` | 1 | δ, 0.5–3, not searched for; 2 unless given |
//!
//! # State
//! Per joint H, time and position of the previous sample; H = 0 at the first sample of a series.
//!
//! # Use when
//! The recording resolves the oscillation that follows a break-away (some 100 Hz and more). Otherwise `lugre`.
//!
//! # Source
//! Canudas de Wit, Olsson, Åström, Lischinsky (1995), *A new model for control of systems with friction*.
//!
//! # Invariants
//! Even in load, odd. Passivity is not declared: it depends on σ_1 (Barabanov and Ortega 2000).

use aurt_traits::{
    ArmSeries, ArmTerm, Columns, JointModel, ModelError, Result, ShapeParameter, register_model,
};
use serde::{Deserialize, Serialize};

use crate::arm_terms::joint_selection::JointSelection;
use crate::hysteresis::lugre::LuGre;
use crate::shape::{accepted, verdict};

/// The LuGre model with bristle damping.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LuGreDamped {
    /// Joints that have the term.
    #[serde(skip_serializing_if = "JointSelection::is_all")]
    pub joints: JointSelection,
    /// Presliding distance p = F_S/σ_0 in rad.
    pub presliding_rad: f64,
    /// Stribeck velocity v_S in rad/s.
    pub stribeck_velocity_rad_s: f64,
    /// Ratio r = F_C/F_S of sliding to break-away.
    pub coulomb_ratio: f64,
    /// Stribeck exponent δ.
    pub stribeck_exponent: f64,
}

impl Default for LuGreDamped {
    fn default() -> Self {
        let LuGre { presliding_rad, stribeck_velocity_rad_s, coulomb_ratio, stribeck_exponent } =
            LuGre::default();
        let joints = JointSelection::all();
        Self { joints, presliding_rad, stribeck_velocity_rad_s, coulomb_ratio, stribeck_exponent }
    }
}

impl LuGreDamped {
    const fn bristles(&self) -> LuGre {
        LuGre {
            presliding_rad: self.presliding_rad,
            stribeck_velocity_rad_s: self.stribeck_velocity_rad_s,
            coulomb_ratio: self.coulomb_ratio,
            stribeck_exponent: self.stribeck_exponent,
        }
    }
}

register_model! {
    slot: ArmTerm,
    name: "lugre_damped",
    summary: "the LuGre model with its bristle damping",
    equation: "τ_j = F_S H + sigma1 ż, H as in `lugre`, ż = q̇ − |q̇| H/g(q̇)",
    use_when: "the recording resolves the oscillation after a break-away; with coulomb `absent`",
    source: "Canudas de Wit, Olsson, Åström, Lischinsky (1995)",
    example: r#"{ model = "lugre_damped", joints = [0], presliding_rad = 0.01, stribeck_velocity_rad_s = 0.05, coulomb_ratio = 0.8, stribeck_exponent = 2.0 }"#,
}

#[typetag::serde(name = "lugre_damped")]
impl ArmTerm for LuGreDamped {
    declares_term! {
        "lugre_damped",
        per joint: ["F_S" in "Nm", "sigma1" in "Nm s/rad"],
        invariants: [EvenInLoad, OddInVelocity]
    }

    fn shape_parameters(&self) -> Vec<ShapeParameter> {
        self.bristles().shape_parameters()
    }

    fn set_shape(&mut self, values: &[f64]) -> Result<(), ModelError> {
        if let [distance, velocity, ratio] = accepted("lugre_damped", &self.shape_parameters(), values)?[..] {
            self.presliding_rad = distance;
            self.stribeck_velocity_rad_s = velocity;
            self.coulomb_ratio = ratio;
        }
        Ok(())
    }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        let mut complaints = self.joints.complaints("lugre_damped", robot_joints);
        complaints.extend(self.bristles().complaints("lugre_damped"));
        verdict(complaints)
    }

    fn state_len(&self, robot_joints: usize) -> usize {
        LuGre::STATE_LEN * self.joints.resolve(robot_joints).len()
    }

    fn initial_state(&self, first: &ArmSeries<'_>) -> Vec<f64> {
        let motion = first.motion;
        self.joints
            .resolve(motion.joints())
            .into_iter()
            .flat_map(|joint| [0.0, motion.time_s()[0], motion.position_rad(joint)[0]])
            .collect()
    }

    fn evaluate(&self, series: &ArmSeries<'_>, state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let (motion, bristles) = (series.motion, self.bristles());
        let (curve, time) = (bristles.curve(), motion.time_s());
        let states = state.as_chunks_mut::<{ LuGre::STATE_LEN }>().0;
        self.joints.write_own_rows(motion.joints(), 2, out, |i, joint, own| {
            let (position, velocity) = (motion.position_rad(joint), motion.velocity_rad_s(joint));
            for n in 0..motion.samples() {
                let h = bristles.step(&mut states[i], (time[n], position[n], velocity[n]));
                own.column_mut(0)[n] = h;
                own.column_mut(1)[n] = velocity[n] - velocity[n].abs() * h / curve.level(velocity[n]);
            }
        });
        Ok(())
    }
}
