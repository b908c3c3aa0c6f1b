//! `lugre`: elastic bristles under a Stribeck level.
//!
//! # Equation
//! With H = σ_0 z/F_S, the bristle force relative to break-away,
//! dH/dt = (q̇ − |q̇| H/g(q̇))/p, g(q̇) = r + (1 − r) e^(−|q̇/v_S|^δ), p = F_S/σ_0, r = F_C/F_S.
//!
//! Its coefficient is the break-away level F_S, so that |H| ≤ 1; while sliding |H| falls to r. The model's bristle
//! damping σ_1 would exceed that bound and is therefore zero here; with σ_1 it is the arm term `lugre_damped`.
//! The viscous term σ_2 q̇ is the viscous slot's.
//!
//! Between two samples velocity is taken as constant (displacement over duration), and then the solution is
//! exact: H_k = s g + (H_(k−1) − s g) e^(−|Δq|/(p g)) with s = sgn Δq. For a velocity that varies, the error is
//! that of g taken at the step's mean velocity, of second order in the time step.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `presliding_rad` | rad | p = F_S/σ_0, shape, 10⁻⁵–0.5, searched in logarithms; 0.01 unless given |
//! | `stribeck_velocity_rad_s` | rad/s | v_S, shape, 0.001–1, searched in logarithms; 0.05 unless given |
//! | `coulomb_ratio` | 1 | r, shape, 0.05–1; 0.8 unless given |
//! | `stribeck_exponent` | 1 | δ, 0.5–3, not searched for; 2 unless given |
//!
//! # State
//! H, time and position of the previous sample; H = 0 at the first sample of a series.
//!
//! # Use when
//! Presliding and the Stribeck effect occur together and three shape parameters are affordable. Without the
//! Stribeck effect (r = 1) it is `dahl`.
//!
//! # Source
//! Canudas de Wit, Olsson, Åström, Lischinsky (1995), *A new model for control of systems with friction*.
//!
//! # Invariants
//! Bounded by one, odd, continuous; passive, for H q̇ − d/dt (p H²/2) = |q̇| H²/g ≥ 0.

use aurt_traits::{Columns, JointModel, JointSeries, ModelError, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::hysteresis::dahl::{PRESLIDING, relax};
use crate::path_step::PathStep;
use crate::shape::{out_of_bounds, verdict};
use crate::stribeck_curve::{COULOMB_RATIO, Decay, STRIBECK_EXPONENT, STRIBECK_VELOCITY, StribeckCurve};

/// The LuGre model without bristle damping.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LuGre {
    /// Presliding distance p = F_S/σ_0 in rad.
    pub presliding_rad: f64,
    /// Stribeck velocity v_S in rad/s.
    pub stribeck_velocity_rad_s: f64,
    /// Ratio r = F_C/F_S of sliding to break-away.
    pub coulomb_ratio: f64,
    /// Stribeck exponent δ.
    pub stribeck_exponent: f64,
}

impl Default for LuGre {
    fn default() -> Self {
        Self {
            presliding_rad: 0.01,
            stribeck_velocity_rad_s: 0.05,
            coulomb_ratio: 0.8,
            stribeck_exponent: 2.0,
        }
    }
}

impl LuGre {
    /// The level g(q̇), relative to break-away.
    pub(crate) const fn curve(&self) -> StribeckCurve {
        StribeckCurve {
            coulomb_ratio: self.coulomb_ratio,
            decay: Decay::exponential(self.stribeck_velocity_rad_s, self.stribeck_exponent),
        }
    }

    /// Number of state variables: H, time, position.
    pub(crate) const STATE_LEN: usize = 3;

    /// Moves `state` to the next sample (time, position, velocity) and returns its H.
    #[inline]
    pub(crate) fn step(&self, state: &mut [f64; Self::STATE_LEN], sample: (f64, f64, f64)) -> f64 {
        let [h, time, position] = state;
        let step = PathStep::advance(time, position, sample);
        let level = self.curve().level(step.velocity_rad_s);
        *h = relax(*h, step.displacement_rad, self.presliding_rad, level);
        *h
    }

    /// Every complaint about the configuration, in the name of `model`.
    pub(crate) fn complaints(&self, model: &str) -> Vec<ModelError> {
        let mut parameters = self.shape_parameters();
        parameters.push(STRIBECK_EXPONENT.at(self.stribeck_exponent));
        out_of_bounds(model, &parameters)
    }
}

register_model! {
    slot: Hysteresis,
    model: LuGre,
    name: "lugre",
    summary: "elastic bristles under a Stribeck level, without bristle damping",
    equation: "dH/dt = (q̇ − |q̇| H/g(q̇))/presliding_rad, g = r + (1 − r) exp(−|q̇/v_S|^δ), r = coulomb_ratio",
    use_when: "presliding and Stribeck effect together; with bristle damping use the arm term `lugre_damped`",
    source: "Canudas de Wit, Olsson, Åström, Lischinsky (1995)",
    example: r#"{ model = "lugre", presliding_rad = 0.01, stribeck_velocity_rad_s = 0.05, coulomb_ratio = 0.8, stribeck_exponent = 2.0 }"#,
}

impl JointModel for LuGre {
    declares! {
        columns: ["lugre" in "1"],
        invariants: [BoundedByOne, OddInVelocity, ContinuousInVelocity, Passive],
        reads_load: false,
        shape: [presliding_rad in PRESLIDING, stribeck_velocity_rad_s in STRIBECK_VELOCITY, coulomb_ratio in COULOMB_RATIO],
    }

    fn validate(&self) -> Result<(), Vec<ModelError>> {
        verdict(self.complaints(Self::NAME))
    }

    fn state_len(&self) -> usize {
        Self::STATE_LEN
    }

    fn initial_state(&self, first: &JointSeries<'_>) -> Vec<f64> {
        vec![0.0, first.time_s[0], first.position_rad[0]]
    }

    fn evaluate(&self, series: &JointSeries<'_>, state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let mut now = [state[0], state[1], state[2]];
        for (n, o) in out.column_mut(0).iter_mut().enumerate() {
            let sample = (series.time_s[n], series.position_rad[n], series.velocity_rad_s[n]);
            *o = self.step(&mut now, sample);
        }
        state.copy_from_slice(&now);
        Ok(())
    }
}
