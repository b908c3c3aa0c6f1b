//! `none`: a Coulomb level that does not depend on the load.
//!
//! # Equation
//! f_C = F_C0
//!
//! # Columns
//! | name | unit | column |
//! |---|---|---|
//! | `F_C0` | Nm | 1 |
//!
//! # Use when
//! First guess, and for joints whose load hardly changes. The name is the paper's: no dependence on the load.
//!
//! # Source
//! Madsen et al. (2022), figure 2 (a); Coulomb (1785).
//!
//! # Invariants
//! Even in load, strictly positive, bounded by one, continuous in velocity, rate-independent, memoryless.

use aurt_traits::{
    Columns, CoulombModel, Invariant, Invariants, JointModel, JointSeries, ModelError, Parameter,
    register_model,
};
use serde::{Deserialize, Serialize};

/// A constant Coulomb level, f_C = F_C0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Constant {}

register_model! {
    slot: Coulomb,
    name: "none",
    summary: "Coulomb level without load dependence",
    equation: "f_C = F_C0",
    use_when: "a first guess, and joints whose load hardly changes",
    source: "Madsen et al. (2022), figure 2 (a); Coulomb (1785)",
    example: r#"{ model = "none" }"#,
}

impl JointModel for Constant {
    fn name(&self) -> &str {
        "none"
    }

    fn columns(&self) -> Vec<Parameter> {
        vec![Parameter::new("F_C0", "Nm")]
    }

    fn invariants(&self) -> Invariants {
        Invariants::of(&[
            Invariant::EvenInLoad,
            Invariant::Positive,
            Invariant::BoundedByOne,
            Invariant::ContinuousInVelocity,
            Invariant::RateIndependent,
            Invariant::Memoryless,
        ])
    }

    fn reads_load(&self) -> bool {
        false
    }

    fn evaluate(
        &self,
        _series: &JointSeries<'_>,
        _state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), ModelError> {
        out.column_mut(0).fill(1.0);
        Ok(())
    }
}

#[typetag::serde(name = "none")]
impl CoulombModel for Constant {
    fn boxed_clone(&self) -> Box<dyn CoulombModel> {
        Box::new(*self)
    }
}
