//! `absent`: no dry friction at all.
//!
//! # Equation
//! f_C = 0, as no column: equation (6) keeps its viscous part alone, whatever the hysteresis model is.
//!
//! # Use when
//! Dry friction is described outside equation (6), for instance by the arm terms `coulomb_asymmetric` or
//! `lugre_damped`, or is to be left out on purpose. A constant level is `none`, which is the paper's name for
//! "no dependence on the load", not for "no friction".
//!
//! # Source
//! The trivial case.
//!
//! # Invariants
//! Every invariant of a column holds, since there is none.

use aurt_traits::{
    Columns, CoulombModel, Invariant, Invariants, JointModel, JointSeries, ModelError, Parameter,
    register_model,
};
use serde::{Deserialize, Serialize};

/// No dry friction: zero columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Absent {}

register_model! {
    slot: Coulomb,
    name: "absent",
    summary: "no dry friction at all (no column)",
    equation: "f_C = 0",
    use_when: "dry friction is described by an arm term instead, or is left out on purpose; for a level \
               that does not depend on the load use `none`",
    source: "trivial",
    example: r#"{ model = "absent" }"#,
}

impl JointModel for Absent {
    fn name(&self) -> &str {
        "absent"
    }

    fn columns(&self) -> Vec<Parameter> {
        Vec::new()
    }

    fn invariants(&self) -> Invariants {
        Invariants::of(&Invariant::ALL)
    }

    fn reads_load(&self) -> bool {
        false
    }

    fn evaluate(
        &self,
        _series: &JointSeries<'_>,
        _state: &mut [f64],
        _out: &mut Columns<'_>,
    ) -> Result<(), ModelError> {
        Ok(())
    }
}

#[typetag::serde(name = "absent")]
impl CoulombModel for Absent {
    fn boxed_clone(&self) -> Box<dyn CoulombModel> {
        Box::new(*self)
    }
}
