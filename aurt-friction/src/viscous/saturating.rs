//! `saturating`: viscous friction that levels off.
//!
//! # Equation
//! f_v(q̇) = F_vs tanh(q̇/v_s) (+ F_v1 q̇)
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `saturation_velocity_rad_s` | rad/s | v_s, shape, 0.05–20, searched in logarithms; 1 unless given |
//! | `linear` | – | whether a linear column stands beside; false unless given |
//!
//! # Columns
//! | name | unit | column |
//! |---|---|---|
//! | `F_vs` | Nm | tanh(q̇/v_s); the slope at rest is F_vs/v_s |
//! | `F_v1` | Nm s/rad | q̇, with `linear` |
//!
//! # Use when
//! Friction is concave against velocity, as on harmonic drives whose lubricant shears thin, and predictions may
//! leave the calibrated velocities: it stays bounded where polynomials do not. A v_s at its upper bound means that
//! friction is linear; one at its lower bound, that the column repeats the Coulomb level. With `linear`, both
//! columns are alike unless the recording reaches well beyond v_s.
//!
//! # Source
//! Makkar, Dixon, Sawyer, Hu (2005), *A new continuously differentiable friction model for control systems
//! design*, for the hyperbolic tangent; Bittencourt, Gunnarsson (2012), *Static friction in a robot joint –
//! modeling and identification of load and temperature effects*, for friction that is curved against velocity.

use aurt_traits::{Columns, JointModel, JointSeries, Parameter, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::shape::Shape;

const SATURATION_VELOCITY: Shape = Shape::logarithmic("saturation_velocity_rad_s", "rad/s", 0.05, 20.0);

/// Viscous friction that levels off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Saturating {
    /// Velocity v_s at which friction has levelled off to tanh 1 = 76 %, in rad/s.
    pub saturation_velocity_rad_s: f64,
    /// Whether a linear column stands beside.
    pub linear: bool,
}

impl Default for Saturating {
    fn default() -> Self {
        Self { saturation_velocity_rad_s: 1.0, linear: false }
    }
}

register_model! {
    slot: Viscous,
    model: Saturating,
    name: "saturating",
    summary: "viscous friction that levels off, as on harmonic drives",
    equation: "f_v = F_vs tanh(q̇/saturation_velocity_rad_s), with `linear` + F_v1 q̇",
    use_when: "friction is concave against velocity, or predictions may leave the calibrated velocities",
    source: "Makkar, Dixon, Sawyer, Hu (2005); Bittencourt, Gunnarsson (2012)",
    example: r#"{ model = "saturating", saturation_velocity_rad_s = 1.0, linear = false }"#,
}

impl JointModel for Saturating {
    declares! {
        invariants: [OddInVelocity, ContinuousInVelocity, SignOfVelocity, Passive, Memoryless],
        reads_load: false,
        shape: [saturation_velocity_rad_s in SATURATION_VELOCITY],
        validate: within_bounds,
    }

    fn columns(&self) -> Vec<Parameter> {
        let mut columns = vec![Parameter::new("F_vs", "Nm")];
        if self.linear {
            columns.push(Parameter::new("F_v1", "Nm s/rad"));
        }
        columns
    }

    fn evaluate(&self, series: &JointSeries<'_>, _state: &mut [f64], out: &mut Columns<'_>) -> Result {
        for (o, v) in out.column_mut(0).iter_mut().zip(series.velocity_rad_s) {
            *o = libm::tanh(v / self.saturation_velocity_rad_s);
        }
        if self.linear {
            out.column_mut(1).copy_from_slice(series.velocity_rad_s);
        }
        Ok(())
    }
}
