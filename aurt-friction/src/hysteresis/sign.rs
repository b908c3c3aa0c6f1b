//! `sign`: dry friction that follows the sign of velocity.
//!
//! # Equation
//! H = sgn(q̇) for |q̇| > v_0, else 0; with v_0 = 0 that is sgn(q̇) with sgn(0) = 0.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `rest_velocity_rad_s` | rad/s | v_0, below which the joint counts as resting; 0 unless given |
//!
//! The default is the paper's model. A resting joint's velocity is rounding noise, and so is its sign: where rest
//! is a part of the recording, a threshold well below the slowest motion keeps that noise out of the regressor.
//! The threshold is a treatment of data and no physics, so it is not searched for.
//!
//! # Use when
//! First guess. Around reversals the friction of real joints builds up over 10⁻³–10⁻¹ rad: `maxwell_slip`.
//!
//! # Source
//! Madsen et al. (2022), section III-B.2; Coulomb (1785).

use aurt_traits::{
    Columns, Invariant, Invariants, JointModel, JointSeries, ModelError, Result, register_model,
};
use serde::{Deserialize, Serialize};

use crate::shape::verdict;

/// The sign of velocity, zero at rest.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sign {
    /// Velocity up to which the joint rests and H = 0, in rad/s.
    #[serde(default)]
    pub rest_velocity_rad_s: f64,
}

register_model! {
    slot: Hysteresis,
    model: Sign,
    name: "sign",
    summary: "the sign of velocity, zero at rest",
    equation: "H = sgn(q̇) for |q̇| > rest_velocity_rad_s (default 0), else 0",
    use_when: "a first guess; `maxwell_slip` where recordings are rich in reversals",
    source: "Madsen et al. (2022), section III-B.2; Coulomb (1785)",
    example: r#"{ model = "sign" }"#,
}

impl JointModel for Sign {
    declares! { columns: ["sgn" in "1"], reads_load: false }

    fn invariants(&self) -> Invariants {
        Invariants::of(&[
            Invariant::BoundedByOne,
            Invariant::OddInVelocity,
            Invariant::SignOfVelocity,
            Invariant::Passive,
            Invariant::Memoryless,
        ])
        .with(Invariant::RateIndependent, self.rest_velocity_rad_s == 0.0)
    }

    fn validate(&self) -> Result<(), Vec<ModelError>> {
        verdict(rest_complaint(Self::NAME, self.rest_velocity_rad_s).into_iter().collect())
    }

    fn evaluate(&self, series: &JointSeries<'_>, _state: &mut [f64], out: &mut Columns<'_>) -> Result {
        for (o, v) in out.column_mut(0).iter_mut().zip(series.velocity_rad_s) {
            *o = sign_beyond(*v, self.rest_velocity_rad_s);
        }
        Ok(())
    }
}

/// sgn(v), or 0 where |v| ≤ `rest`.
#[inline]
pub(crate) fn sign_beyond(v: f64, rest: f64) -> f64 {
    if v.abs() > rest { v.signum() } else { 0.0 }
}

/// The complaint about a rest velocity that is none, in the name of `model`.
pub(crate) fn rest_complaint(model: &str, rest_velocity_rad_s: f64) -> Option<ModelError> {
    let sensible = rest_velocity_rad_s.is_finite() && rest_velocity_rad_s >= 0.0;
    (!sensible).then(|| {
        ModelError::parameter(
            model,
            "rest_velocity_rad_s",
            format!("must be zero or positive, is {rest_velocity_rad_s}"),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::sign_beyond;

    #[test]
    fn rest_is_zero_on_both_sides_of_zero() {
        assert_eq!(sign_beyond(0.0, 0.0), 0.0);
        assert_eq!(sign_beyond(-0.0, 0.0), 0.0);
        assert_eq!(sign_beyond(1e-300, 0.0), 1.0);
        assert_eq!(sign_beyond(-0.02, 0.03), 0.0);
        assert_eq!(sign_beyond(-0.04, 0.03), -1.0);
    }
}
