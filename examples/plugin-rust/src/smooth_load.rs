//! A Coulomb level that grows with the load, without a kink at zero load.

use aurt_traits::reexport::typetag;
use aurt_traits::{
    Columns, CoulombModel, Invariant, Invariants, JointModel, JointSeries, ModelError, Parameter,
    register_model,
};
use serde::{Deserialize, Serialize};

const NAME: &str = "smooth_load";

/// f_C(τ_J) = F_C0 + F_C1 (√(τ_J² + τ_0²) − τ_0).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SmoothLoad {
    /// τ_0, below which the level hardly depends on the load, in the unit of the load torque.
    pub rounding: f64,
}

impl JointModel for SmoothLoad {
    fn name(&self) -> &str {
        NAME
    }

    fn columns(&self) -> Vec<Parameter> {
        vec![Parameter::new("F_C0", "Nm"), Parameter::new("F_C1", "1")]
    }

    fn invariants(&self) -> Invariants {
        Invariants::of(&[Invariant::EvenInLoad, Invariant::Positive, Invariant::Memoryless])
    }

    fn validate(&self) -> Result<(), Vec<ModelError>> {
        if self.rounding.is_finite() && self.rounding > 0.0 {
            return Ok(());
        }
        Err(vec![ModelError::InvalidParameter {
            model: NAME.to_owned(),
            parameter: "rounding".to_owned(),
            reason: format!("must be positive, is {}", self.rounding),
        }])
    }

    fn evaluate(
        &self,
        series: &JointSeries<'_>,
        _state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), ModelError> {
        out.column_mut(0).fill(1.0);
        for (o, load) in out.column_mut(1).iter_mut().zip(series.load_torque) {
            *o = load.hypot(self.rounding) - self.rounding;
        }
        Ok(())
    }
}

#[typetag::serde(name = "smooth_load")]
impl CoulombModel for SmoothLoad {
    fn boxed_clone(&self) -> Box<dyn CoulombModel> {
        Box::new(self.clone())
    }
}

register_model! {
    slot: Coulomb,
    name: "smooth_load",
    summary: "a level that grows with the load, without a kink at zero load",
    equation: "f_C(τ_J) = F_C0 + F_C1 (√(τ_J² + τ_0²) − τ_0)",
    use_when: "friction grows with the magnitude of the load and passes smoothly through zero load",
    source: "the usual smooth approximation of |τ_J|",
    example: r#"{ model = "smooth_load", rounding = 2.0 }"#,
}
