//! `dahl`: friction that approaches its level exponentially in the distance travelled.
//!
//! # Equation
//! dH/dq = (1 − H sgn q̇)/p, where p = F_C/σ is the presliding distance and σ the stiffness at rest.
//!
//! Between two samples the path is taken as monotone, and then the solution is exact:
//! H_k = s + (H_(k−1) − s) e^(−|Δq|/p) with s = sgn Δq. Only positions enter, no times.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `presliding_rad` | rad | p, shape, 10⁻⁵–0.5, searched in logarithms; 0.01 unless given |
//!
//! # State
//! H and the previous position; H = 0 at the first sample of a series.
//!
//! # Use when
//! Presliding is to be described with one parameter. Loops inside loops do not close (Dahl's model drifts under
//! small oscillation); where that matters, and for a description that is linear in all its parameters, use
//! `maxwell_slip`.
//!
//! # Source
//! Dahl (1968), *A solid friction model*, Aerospace Corporation TOR-0158; with exponent one.

use aurt_traits::{Columns, JointModel, JointSeries, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::shape::Shape;

/// Presliding distance, the level divided by the stiffness at rest.
pub(crate) const PRESLIDING: Shape = Shape::logarithmic("presliding_rad", "rad", 1e-5, 0.5);

/// Dahl's friction model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Dahl {
    /// Presliding distance p = F_C/σ in rad.
    pub presliding_rad: f64,
}

impl Default for Dahl {
    fn default() -> Self {
        Self { presliding_rad: 0.01 }
    }
}

register_model! {
    slot: Hysteresis,
    model: Dahl,
    name: "dahl",
    summary: "presliding as an exponential approach over one distance",
    equation: "dH/dq = (1 − H sgn q̇)/presliding_rad, exact along the sampled path",
    use_when: "presliding with one shape parameter; `maxwell_slip` where inner loops matter",
    source: "Dahl (1968)",
    example: r#"{ model = "dahl", presliding_rad = 0.01 }"#,
}

impl JointModel for Dahl {
    declares! {
        columns: ["dahl" in "1"],
        invariants: [BoundedByOne, OddInVelocity, ContinuousInVelocity, Passive, RateIndependent],
        reads_load: false,
        shape: [presliding_rad in PRESLIDING],
        validate: within_bounds,
    }

    fn state_len(&self) -> usize {
        2
    }

    fn initial_state(&self, first: &JointSeries<'_>) -> Vec<f64> {
        vec![0.0, first.position_rad[0]]
    }

    fn evaluate(&self, series: &JointSeries<'_>, state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let (mut h, mut position) = (state[0], state[1]);
        for (o, q) in out.column_mut(0).iter_mut().zip(series.position_rad) {
            h = relax(h, q - position, self.presliding_rad, 1.0);
            position = *q;
            *o = h;
        }
        (state[0], state[1]) = (h, position);
        Ok(())
    }
}

/// The solution of dH/dq = (1 − H s/g)/p after the displacement `dq`, s its sign: H approaches s·g over p·g.
#[inline]
pub(crate) fn relax(h: f64, dq: f64, presliding: f64, level: f64) -> f64 {
    // `exp_m1` keeps the digits of the small steps that a high sampling rate makes.
    let share = -libm::expm1(-dq.abs() / (presliding * level));
    (h + (level.copysign(dq) - h) * share).clamp(-1.0, 1.0)
}
