//! Viscous friction of a lubricant that gives way under shear.

use aurt_traits::reexport::typetag;
use aurt_traits::{
    Columns, Invariant, Invariants, JointModel, JointSeries, ModelError, Parameter, Scale, ShapeParameter,
    ViscousBasis, register_model,
};
use serde::{Deserialize, Serialize};

const NAME: &str = "eyring";

/// f_v(q̇) = F_v v_0 asinh(q̇ / v_0): linear with slope F_v at low speed, logarithmic above v_0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Eyring {
    /// v_0 in rad/s, where the lubricant begins to give way.
    pub transition_velocity_rad_s: f64,
}

impl JointModel for Eyring {
    fn name(&self) -> &str {
        NAME
    }

    fn columns(&self) -> Vec<Parameter> {
        vec![Parameter::new("F_v", "Nm s/rad")]
    }

    fn invariants(&self) -> Invariants {
        Invariants::of(&[
            Invariant::OddInVelocity,
            Invariant::ContinuousInVelocity,
            Invariant::SignOfVelocity,
            Invariant::Passive,
            Invariant::Memoryless,
        ])
    }

    fn shape_parameters(&self) -> Vec<ShapeParameter> {
        vec![ShapeParameter {
            name: "transition_velocity_rad_s".to_owned(),
            unit: "rad/s".to_owned(),
            value: self.transition_velocity_rad_s,
            lower: 1e-3,
            upper: 1e2,
            scale: Scale::Logarithmic,
        }]
    }

    fn set_shape(&mut self, values: &[f64]) -> Result<(), ModelError> {
        let [velocity] = values else {
            let what = format!("shape parameters of `{NAME}`");
            return Err(ModelError::Count { what, expected: 1, found: values.len() });
        };
        *self = Self { transition_velocity_rad_s: *velocity };
        self.validate().map_err(|mut complaints| complaints.remove(0))
    }

    fn validate(&self) -> Result<(), Vec<ModelError>> {
        let v = self.transition_velocity_rad_s;
        if v.is_finite() && v > 0.0 {
            return Ok(());
        }
        Err(vec![ModelError::InvalidParameter {
            model: NAME.to_owned(),
            parameter: "transition_velocity_rad_s".to_owned(),
            reason: format!("must be positive, is {v}"),
        }])
    }

    fn evaluate(
        &self,
        series: &JointSeries<'_>,
        _state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), ModelError> {
        let v_0 = self.transition_velocity_rad_s;
        for (o, v) in out.column_mut(0).iter_mut().zip(series.velocity_rad_s) {
            *o = v_0 * (v / v_0).asinh();
        }
        Ok(())
    }
}

#[typetag::serde(name = "eyring")]
impl ViscousBasis for Eyring {
    fn boxed_clone(&self) -> Box<dyn ViscousBasis> {
        Box::new(self.clone())
    }
}

register_model! {
    slot: Viscous,
    name: "eyring",
    summary: "viscous friction of a lubricant that gives way under shear",
    equation: "f_v(q̇) = F_v v_0 asinh(q̇ / v_0)",
    use_when: "friction rises ever more slowly with speed, but does not saturate",
    source: "H. Eyring, Viscosity, plasticity, and diffusion as examples of absolute reaction rates, \
             J. Chem. Phys. 4 (1936) 283",
    example: r#"{ model = "eyring", transition_velocity_rad_s = 0.5 }"#,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_linear_below_the_transition_and_logarithmic_above() {
        let model = Eyring { transition_velocity_rad_s: 1.0 };
        let velocity = [-1e-4, 0.0, 1e-4, 1e4, 1e5];
        let series = JointSeries {
            time_s: &[0.0; 5],
            position_rad: &[0.0; 5],
            velocity_rad_s: &velocity,
            acceleration_rad_s2: &[0.0; 5],
            load_torque: &[0.0; 5],
        };
        let mut out = [0.0; 5];
        model.evaluate(&series, &mut [], &mut Columns::new(&mut out, 1, 5, 5)).unwrap();
        assert_eq!(out[0], -out[2]);
        assert_eq!(out[1], 0.0);
        assert!((out[2] - 1e-4).abs() < 1e-12);
        // A factor of ten in speed adds ln 10.
        assert!((out[4] - out[3] - 10_f64.ln()).abs() < 1e-6);
    }
}
