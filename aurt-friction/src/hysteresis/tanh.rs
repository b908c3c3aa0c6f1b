//! `tanh`: the sign of velocity, smoothed.
//!
//! # Equation
//! H = tanh(q̇/v_T)
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `velocity_rad_s` | rad/s | v_T, shape, 10⁻⁴–1, searched in logarithms; 0.01 unless given |
//!
//! # Use when
//! A simulation or a controller needs a friction law without a step, or a filter has smeared the sign in the
//! recording. It is no presliding: at rest it always gives zero, whatever the way there was.
//!
//! # Source
//! Andersson, Söderberg, Björklund (2007), *Friction models for sliding dry, boundary and mixed lubricated
//! contacts*.

use aurt_traits::{Columns, JointModel, JointSeries, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::shape::Shape;

const VELOCITY: Shape = Shape::logarithmic("velocity_rad_s", "rad/s", 1e-4, 1.0);

/// A smoothed sign of velocity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Tanh {
    /// Transition velocity v_T in rad/s.
    pub velocity_rad_s: f64,
}

impl Default for Tanh {
    fn default() -> Self {
        Self { velocity_rad_s: 0.01 }
    }
}

register_model! {
    slot: Hysteresis,
    model: Tanh,
    name: "tanh",
    summary: "the sign of velocity, smoothed over a transition velocity",
    equation: "H = tanh(q̇/velocity_rad_s)",
    use_when: "a friction law without a step is needed; it has no memory and so no presliding",
    source: "Andersson, Söderberg, Björklund (2007)",
    example: r#"{ model = "tanh", velocity_rad_s = 0.01 }"#,
}

impl JointModel for Tanh {
    declares! {
        columns: ["tanh" in "1"],
        invariants: [BoundedByOne, OddInVelocity, ContinuousInVelocity, SignOfVelocity, Passive, Memoryless],
        reads_load: false,
        shape: [velocity_rad_s in VELOCITY],
        validate: within_bounds,
    }

    fn evaluate(&self, series: &JointSeries<'_>, _state: &mut [f64], out: &mut Columns<'_>) -> Result {
        for (o, v) in out.column_mut(0).iter_mut().zip(series.velocity_rad_s) {
            *o = libm::tanh(v / self.velocity_rad_s);
        }
        Ok(())
    }
}
