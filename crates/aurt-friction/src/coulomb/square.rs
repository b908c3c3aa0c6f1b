//! `square`: a Coulomb level that grows with the square of the load.
//!
//! # Equation
//! f_C(τ_J) = F_C0 + F_C1 τ_J²
//!
//! # Columns
//! | name | unit | column |
//! |---|---|---|
//! | `F_C0` | Nm | 1 |
//! | `F_C1` | 1/Nm | τ_J² |
//!
//! # Use when
//! The load changes over a wide range and the joint's friction rises faster than in proportion to it. Outside
//! the calibrated load range the square extrapolates badly; `absolute` is the safer choice there.
//!
//! # Source
//! Madsen et al. (2022), figure 2 (b) and equation (7).
//!
//! # Invariants
//! Even in load, strictly positive, continuous in velocity, rate-independent, memoryless.

use aurt_traits::{
    Columns, CoulombModel, Invariant, Invariants, JointModel, JointSeries, ModelError, Parameter,
    register_model,
};
use serde::{Deserialize, Serialize};

/// A Coulomb level with square load dependence, f_C = F_C0 + F_C1 τ_J².
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Square {}

register_model! {
    slot: Coulomb,
    name: "square",
    summary: "Coulomb level with square load dependence",
    equation: "f_C = F_C0 + F_C1 τ_J²",
    use_when: "the load varies widely and friction rises faster than in proportion; `absolute` extrapolates \
               more safely",
    source: "Madsen et al. (2022), figure 2 (b) and equation (7)",
    example: r#"{ model = "square" }"#,
}

impl JointModel for Square {
    fn name(&self) -> &str {
        "square"
    }

    fn columns(&self) -> Vec<Parameter> {
        vec![Parameter::new("F_C0", "Nm"), Parameter::new("F_C1", "1/Nm")]
    }

    fn invariants(&self) -> Invariants {
        Invariants::of(&[
            Invariant::EvenInLoad,
            Invariant::Positive,
            Invariant::ContinuousInVelocity,
            Invariant::RateIndependent,
            Invariant::Memoryless,
        ])
    }

    fn evaluate(
        &self,
        series: &JointSeries<'_>,
        _state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), ModelError> {
        out.column_mut(0).fill(1.0);
        for (o, load) in out.column_mut(1).iter_mut().zip(series.load_torque) {
            *o = load * load;
        }
        Ok(())
    }
}

#[typetag::serde(name = "square")]
impl CoulombModel for Square {
    fn boxed_clone(&self) -> Box<dyn CoulombModel> {
        Box::new(*self)
    }
}
