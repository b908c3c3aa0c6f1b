//! Shape parameters: what the law of an effect is not linear in.

use serde_json::{Value, json};

/// How a shape parameter is stepped through.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// In equal steps.
    Linear,
    /// In equal ratios; the sign stays.
    Logarithmic,
}

/// A shape parameter of a proposal: the proposal has a value to start from, the recordings decide.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Its name among a finding's parameters.
    pub name: &'static str,
    /// Where it stands in the configuration of the term (a JSON pointer).
    pub pointer: &'static str,
    /// Smallest and largest size.
    pub bounds: [f64; 2],
    /// How it is stepped through.
    pub scale: Scale,
    /// First step of the search: a difference, or the logarithm of a ratio.
    pub step: f64,
    /// True where its starts are the values of most machines: they are kept unless another is better by the least score of an effect.
    pub usual: bool,
}

impl Shape {
    /// A positive or negative quantity that is stepped through in equal ratios.
    pub(crate) const fn logarithmic(
        name: &'static str,
        pointer: &'static str,
        bounds: [f64; 2],
        step: f64,
    ) -> Self {
        Self { name, pointer, bounds, scale: Scale::Logarithmic, step, usual: false }
    }

    /// A quantity that is stepped through in equal differences.
    pub(crate) const fn linear(
        name: &'static str,
        pointer: &'static str,
        bounds: [f64; 2],
        step: f64,
    ) -> Self {
        Self { name, pointer, bounds, scale: Scale::Linear, step, usual: false }
    }

    /// The same, with starts that machines usually have.
    pub(crate) const fn with_usual_starts(self) -> Self {
        Self { usual: true, ..self }
    }

    pub(crate) fn value(&self, configuration: &Value) -> Option<f64> {
        configuration.pointer(self.pointer).and_then(Value::as_f64)
    }

    /// Puts a value into a configuration.
    pub(crate) fn set(&self, configuration: &mut Value, value: f64) {
        if let Some(place) = configuration.pointer_mut(self.pointer) {
            *place = json!(value);
        }
    }

    /// The value some steps away from another, within the bounds.
    pub(crate) fn moved(&self, value: f64, by: f64) -> f64 {
        let [low, high] = self.bounds;
        match self.scale {
            Scale::Linear => (value + by).clamp(low, high),
            Scale::Logarithmic => (value.abs() * by.exp()).clamp(low, high) * value.signum(),
        }
    }

    /// How far apart two values are, in the units of `step`.
    pub(crate) fn distance(&self, from: f64, to: f64) -> f64 {
        match self.scale {
            Scale::Linear => to - from,
            Scale::Logarithmic => (to / from).abs().ln(),
        }
    }

    /// The deviation of the value, from that in units of `step`.
    pub(crate) fn deviation(&self, value: f64, of_coordinate: f64) -> f64 {
        match self.scale {
            Scale::Linear => of_coordinate,
            Scale::Logarithmic => of_coordinate * value.abs(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_stays_within_bounds_and_keeps_the_sign() {
        let ratio = Shape::logarithmic("ratio", "/ratio", [0.05, 5.0], 0.3);
        assert!((ratio.moved(-2.0, 2f64.ln()) + 4.0).abs() < 1e-12);
        assert_eq!(ratio.moved(-2.0, 9.0), -5.0);
        assert!((ratio.distance(-2.0, -4.0) - 2f64.ln()).abs() < 1e-12);
        let order = Shape::linear("order", "/cycles", [1.0, 240.0], 0.1);
        assert_eq!((order.moved(3.0, -9.0), order.distance(3.0, 2.5)), (1.0, -0.5));
    }

    #[test]
    fn values_stand_in_the_configuration() {
        let shape = Shape::logarithmic("v", "/coulomb/v", [0.001, 1.0], 0.3);
        let mut term = json!({"model": "joint_friction", "coulomb": {"v": 0.05}});
        shape.set(&mut term, 0.02);
        assert_eq!(shape.value(&term), Some(0.02));
        assert_eq!(shape.value(&json!({})), None);
    }
}
