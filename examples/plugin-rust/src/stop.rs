//! Presliding as a spring that slips at a threshold.

use aurt_traits::reexport::typetag;
use aurt_traits::{
    Columns, HysteresisModel, Invariant, Invariants, JointModel, JointSeries, ModelError, Parameter, Scale,
    ShapeParameter, register_model,
};
use serde::{Deserialize, Serialize};

const NAME: &str = "stop";

/// H(z) = z, where z follows q / δ and is held between −1 and 1: a spring that is stretched over the distance δ and
/// then slips (the stop operator of Prandtl and Ishlinskii, one Maxwell-slip element).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stop {
    /// δ in rad.
    pub distance_rad: f64,
}

impl JointModel for Stop {
    fn name(&self) -> &str {
        NAME
    }

    fn columns(&self) -> Vec<Parameter> {
        vec![Parameter::new("z", "1")]
    }

    fn invariants(&self) -> Invariants {
        Invariants::of(&[
            Invariant::BoundedByOne,
            Invariant::OddInVelocity,
            Invariant::Passive,
            Invariant::RateIndependent,
        ])
    }

    fn shape_parameters(&self) -> Vec<ShapeParameter> {
        vec![ShapeParameter {
            name: "distance_rad".to_owned(),
            unit: "rad".to_owned(),
            value: self.distance_rad,
            lower: 1e-6,
            upper: 1.0,
            scale: Scale::Logarithmic,
        }]
    }

    fn set_shape(&mut self, values: &[f64]) -> Result<(), ModelError> {
        let [distance_rad] = *values else {
            let what = format!("shape parameters of `{NAME}`");
            return Err(ModelError::Count { what, expected: 1, found: values.len() });
        };
        *self = Self { distance_rad };
        self.validate().map_err(|mut complaints| complaints.remove(0))
    }

    fn validate(&self) -> Result<(), Vec<ModelError>> {
        if self.distance_rad.is_finite() && self.distance_rad > 0.0 {
            return Ok(());
        }
        Err(vec![ModelError::InvalidParameter {
            model: NAME.to_owned(),
            parameter: "distance_rad".to_owned(),
            reason: format!("must be positive, is {}", self.distance_rad),
        }])
    }

    /// The deflection z and the position of the previous sample.
    fn state_len(&self) -> usize {
        2
    }

    /// A relaxed spring where the series begins.
    fn initial_state(&self, first: &JointSeries<'_>) -> Vec<f64> {
        vec![0.0, first.position_rad.first().copied().unwrap_or_default()]
    }

    fn evaluate(
        &self,
        series: &JointSeries<'_>,
        state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), ModelError> {
        let [z, previous] = state else {
            let what = format!("state variables of `{NAME}`");
            return Err(ModelError::Count { what, expected: 2, found: state.len() });
        };
        for (o, q) in out.column_mut(0).iter_mut().zip(series.position_rad) {
            // Exact at any rate, as long as the joint does not turn back between two samples.
            *z = (*z + (q - *previous) / self.distance_rad).clamp(-1.0, 1.0);
            *previous = *q;
            *o = *z;
        }
        Ok(())
    }
}

#[typetag::serde(name = "stop")]
impl HysteresisModel for Stop {
    fn boxed_clone(&self) -> Box<dyn HysteresisModel> {
        Box::new(self.clone())
    }
}

register_model! {
    slot: Hysteresis,
    name: "stop",
    summary: "presliding as one spring that slips at a threshold",
    equation: "H = z, dz = dq / δ within −1 ≤ z ≤ 1",
    use_when: "after a reversal, torque rises over a distance and not at once",
    source: "A. Visintin, Differential Models of Hysteresis, Springer 1994, chapter III",
    example: r#"{ model = "stop", distance_rad = 0.01 }"#,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(positions: &[f64], state: &mut [f64]) -> Vec<f64> {
        let n = positions.len();
        let zeros = vec![0.0; n];
        let series = JointSeries {
            time_s: &zeros,
            position_rad: positions,
            velocity_rad_s: &zeros,
            acceleration_rad_s2: &zeros,
            load_torque: &zeros,
        };
        let mut out = vec![0.0; n];
        Stop { distance_rad: 0.5 }.evaluate(&series, state, &mut Columns::new(&mut out, 1, n, n)).unwrap();
        out
    }

    #[test]
    fn it_stretches_and_slips() {
        assert_eq!(run(&[0.0, 0.25, 1.0, 0.75, 0.25], &mut [0.0, 0.0]), [0.0, 0.5, 1.0, 0.5, -0.5]);
    }

    #[test]
    fn a_series_may_be_split() {
        let positions = [0.0, 0.3, 0.9, 0.2, 0.5, -0.4];
        let mut state = [0.0, 0.0];
        let halves = [run(&positions[..2], &mut state), run(&positions[2..], &mut state)].concat();
        assert_eq!(halves, run(&positions, &mut [0.0, 0.0]));
    }
}
