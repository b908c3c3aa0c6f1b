//! `absolute`: a Coulomb level that grows in proportion to the load's magnitude.
//!
//! # Equation
//! f_C(τ_J) = F_C0 + F_C1 |τ_J|
//!
//! # Columns
//! | name | unit | column |
//! |---|---|---|
//! | `F_C0` | Nm | 1 |
//! | `F_C1` | 1 | \|τ_J\| |
//!
//! # Use when
//! The usual choice for geared joints that carry gravity: tooth friction is proportional to the tooth force.
//! F_C1 of harmonic drives lies at 0.06–0.15. If friction differs between driving and being driven, add the arm
//! term `drive_efficiency`.
//!
//! # Source
//! Madsen et al. (2022), figure 2 (c); Hamon, Gautier, Garrec (2010), *Dynamic identification of robots with a
//! dry friction model depending on load and velocity*.
//!
//! # Invariants
//! Even in load, strictly positive, continuous in velocity, rate-independent, memoryless.

use aurt_traits::{
    Columns, CoulombModel, Invariant, Invariants, JointModel, JointSeries, ModelError, Parameter,
    register_model,
};
use serde::{Deserialize, Serialize};

/// A Coulomb level with proportional load dependence, f_C = F_C0 + F_C1 |τ_J|.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Absolute {}

register_model! {
    slot: Coulomb,
    name: "absolute",
    summary: "Coulomb level with load dependence in proportion to |τ_J|",
    equation: "f_C = F_C0 + F_C1 |τ_J|",
    use_when: "geared joints that carry gravity; the usual choice",
    source: "Madsen et al. (2022), figure 2 (c); Hamon, Gautier, Garrec (2010)",
    example: r#"{ model = "absolute" }"#,
}

impl JointModel for Absolute {
    fn name(&self) -> &str {
        "absolute"
    }

    fn columns(&self) -> Vec<Parameter> {
        vec![Parameter::new("F_C0", "Nm"), Parameter::new("F_C1", "1")]
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
            *o = load.abs();
        }
        Ok(())
    }
}

#[typetag::serde(name = "absolute")]
impl CoulombModel for Absolute {
    fn boxed_clone(&self) -> Box<dyn CoulombModel> {
        Box::new(*self)
    }
}
