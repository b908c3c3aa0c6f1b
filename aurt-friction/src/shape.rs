//! Bounds of shape parameters: how models describe them, refuse values outside, and take new ones.

use aurt_traits::{ModelError, Scale, ShapeParameter};

/// A shape parameter without its value.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shape {
    /// Configuration key.
    pub(crate) name: &'static str,
    /// Unit.
    pub(crate) unit: &'static str,
    /// Smallest sensible value.
    pub(crate) lower: f64,
    /// Largest sensible value.
    pub(crate) upper: f64,
    /// How to step through it.
    pub(crate) scale: Scale,
}

impl Shape {
    pub(crate) const fn logarithmic(name: &'static str, unit: &'static str, lower: f64, upper: f64) -> Self {
        Self { name, unit, lower, upper, scale: Scale::Logarithmic }
    }

    pub(crate) const fn linear(name: &'static str, unit: &'static str, lower: f64, upper: f64) -> Self {
        Self { name, unit, lower, upper, scale: Scale::Linear }
    }

    /// The parameter at its present value.
    pub(crate) fn at(self, value: f64) -> ShapeParameter {
        let Self { name, unit, lower, upper, scale } = self;
        ShapeParameter { name: name.into(), unit: unit.into(), value, lower, upper, scale }
    }
}

/// A complaint for every parameter whose value lies outside its bounds.
pub(crate) fn out_of_bounds(model: &str, parameters: &[ShapeParameter]) -> Vec<ModelError> {
    parameters
        .iter()
        .filter(|p| !(p.lower..=p.upper).contains(&p.value))
        .map(|p| {
            ModelError::parameter(
                model,
                &p.name,
                format!("must lie between {} and {} {}, is {}", p.lower, p.upper, p.unit, p.value),
            )
        })
        .collect()
}

/// The values if each fits its parameter. A search in logarithms meets a bound only up to rounding, so an excess
/// of that size is taken for the bound.
pub(crate) fn accepted(
    model: &str,
    parameters: &[ShapeParameter],
    values: &[f64],
) -> Result<Vec<f64>, ModelError> {
    const ROUNDING: f64 = 1e-9;
    if values.len() != parameters.len() {
        return Err(ModelError::count(
            format!("shape parameters of `{model}`"),
            parameters.len(),
            values.len(),
        ));
    }
    let trial: Vec<ShapeParameter> = parameters
        .iter()
        .zip(values)
        .map(|(p, value)| {
            let clamped = value.clamp(p.lower, p.upper);
            let excess = (value - clamped).abs();
            let value = if excess <= ROUNDING * clamped.abs() { clamped } else { *value };
            ShapeParameter { value, ..p.clone() }
        })
        .collect();
    match out_of_bounds(model, &trial).into_iter().next() {
        Some(complaint) => Err(complaint),
        None => Ok(trial.into_iter().map(|p| p.value).collect()),
    }
}

/// `Ok` if there is no complaint.
pub(crate) fn verdict(complaints: Vec<ModelError>) -> Result<(), Vec<ModelError>> {
    if complaints.is_empty() { Ok(()) } else { Err(complaints) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_hold_up_to_rounding() {
        let parameters = [Shape::logarithmic("v", "rad/s", 1e-3, 1.0).at(0.1)];
        assert_eq!(accepted("m", &parameters, &[1.0 + 1e-14]).unwrap(), [1.0]);
        assert!(accepted("m", &parameters, &[1.001]).is_err());
        assert!(accepted("m", &parameters, &[f64::NAN]).is_err());
        assert!(accepted("m", &parameters, &[]).is_err());
    }
}
