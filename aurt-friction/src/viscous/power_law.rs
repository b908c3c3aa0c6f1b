//! `power_law`: viscous friction of a lubricant that shears thin or thick.
//!
//! # Equation
//! f_v(q̇) = F_vp sgn(q̇) |q̇/(1 rad/s)|^n
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `exponent` | – | n, shape, 0.2–4, searched in logarithms; 0.5 unless given |
//!
//! # Columns
//! | name | unit | column |
//! |---|---|---|
//! | `F_vp` | Nm | sgn(q̇) \|q̇\|^n; the friction at 1 rad/s |
//!
//! # Use when
//! Friction is curved against velocity: below 1 as of grease in a harmonic drive, which shears thin, and above 1 as of churned oil
//! and air. One law for both, where polynomials need several columns and turn back beyond the calibrated velocities. An
//! exponent at its lower bound means that the column repeats the Coulomb level.
//!
//! # Source
//! Olsson, Åström, Canudas de Wit, Gäfvert, Lischinsky (1998), *Friction models and friction compensation*, section 2.1; Ostwald
//! (1925), *Über die Geschwindigkeitsfunktion der Viskosität disperser Systeme*, for fluids that shear thin.
//!
//! # Invariants
//! Odd, continuous, of the sign of velocity, passive, memoryless.

use aurt_traits::{Columns, JointModel, JointSeries, Parameter, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::shape::Shape;

const EXPONENT: Shape = Shape::logarithmic("exponent", "-", 0.2, 4.0);

/// Viscous friction in proportion to a power of velocity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PowerLaw {
    /// Exponent n of the velocity.
    pub exponent: f64,
}

impl Default for PowerLaw {
    fn default() -> Self {
        Self { exponent: 0.5 }
    }
}

register_model! {
    slot: Viscous,
    model: PowerLaw,
    name: "power_law",
    summary: "viscous friction of a lubricant that shears thin or thick",
    equation: "f_v = F_vp sgn(q̇) |q̇|^exponent",
    use_when: "friction is curved against velocity, in one column",
    source: "Olsson, Åström, Canudas de Wit, Gäfvert, Lischinsky (1998)",
    example: r#"{ model = "power_law", exponent = 0.5 }"#,
}

impl JointModel for PowerLaw {
    declares! {
        invariants: [OddInVelocity, ContinuousInVelocity, SignOfVelocity, Passive, Memoryless],
        reads_load: false,
        shape: [exponent in EXPONENT],
        validate: within_bounds,
    }

    fn columns(&self) -> Vec<Parameter> {
        vec![Parameter::new("F_vp", "Nm")]
    }

    fn evaluate(&self, series: &JointSeries<'_>, _state: &mut [f64], out: &mut Columns<'_>) -> Result {
        for (o, v) in out.column_mut(0).iter_mut().zip(series.velocity_rad_s) {
            *o = libm::copysign(libm::pow(libm::fabs(*v), self.exponent), *v);
        }
        Ok(())
    }
}
