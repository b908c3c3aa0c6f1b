//! `power_law`: viscous friction in proportion to a power of velocity.
//!
//! # Equation
//! f_v(q̇) = F_vp sgn(q̇) |q̇/(1 rad/s)|^n
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `exponent` | – | n, shape, 1.2–4, searched in logarithms; 2 unless given |
//!
//! # Columns
//! | name | unit | column |
//! |---|---|---|
//! | `F_vp` | Nm | sgn(q̇) \|q̇\|^n; the friction at 1 rad/s |
//!
//! # Use when
//! Friction grows faster than velocity, as of churned oil and air, or, with a negative coefficient beside a linear column, more slowly.
//! One column for what polynomials need several for. Friction that levels off is `saturating`, which stays bounded; an exponent
//! below 1 would repeat the Coulomb level.
//!
//! # Source
//! Olsson, Åström, Canudas de Wit, Gäfvert, Lischinsky (1998), *Friction models and friction compensation*, section 2.1.

use aurt_traits::{Columns, JointModel, JointSeries, Parameter, Result, register_model};
use serde::{Deserialize, Serialize};

use crate::shape::Shape;

const EXPONENT: Shape = Shape::logarithmic("exponent", "1", 1.2, 4.0);

/// Viscous friction in proportion to a power of velocity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PowerLaw {
    /// Exponent n of the velocity.
    pub exponent: f64,
}

impl Default for PowerLaw {
    fn default() -> Self {
        Self { exponent: 2.0 }
    }
}

register_model! {
    slot: Viscous,
    model: PowerLaw,
    name: "power_law",
    summary: "viscous friction in proportion to a power of velocity",
    equation: "f_v = F_vp sgn(q̇) |q̇|^exponent",
    use_when: "friction grows faster than velocity, in one column",
    source: "Olsson, Åström, Canudas de Wit, Gäfvert, Lischinsky (1998)",
    example: r#"{ model = "power_law", exponent = 2.0 }"#,
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
