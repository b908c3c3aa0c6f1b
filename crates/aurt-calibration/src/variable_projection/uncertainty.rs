use aurt_traits::{Scale, ShapeParameter};

use super::{
    owner::{Owner, value},
    problem::{Point, Problem},
    report::FittedShape,
    search::Found,
};
use crate::{CalibrationError, Estimator, uncertainty::NORMAL_95, wls::estimate};

/// A shape this close to an end of its range lies at the bound.
const AT_BOUND: f64 = 1e-6;

/// The shapes with their precision, and the covariance of the coefficients with shapes uncertain too.
pub(super) struct Precision {
    pub shapes: Vec<FittedShape>,
    /// Column-major, over the model's coefficients.
    pub covariance: Vec<f64>,
}

/// Solves the problem with a column for every shape that is free, (∂W/∂θ) ζ, around the minimum.
///
/// # Errors
/// What models report.
pub(super) fn precision(
    problem: &Problem<'_>,
    point: &Point,
    found: &Found,
    begin: &[Owner],
    coefficients: &[f64],
    (estimator, bandwidth): (Estimator, f64),
) -> Result<Precision, CalibrationError> {
    let n = problem.model.parameters().len();
    let owners: Vec<usize> = (0..problem.owners.len()).collect();
    let mut free = problem.sensitivities(point, &owners, coefficients)?;
    free.retain(|s| !at_bound(point.units[s.shape.0][s.shape.1]));
    let system = problem.system(point, &free);
    let solution = estimate(&system, estimator)?.solution;
    let total = n + free.len();
    let mut covariance = vec![0.0; n * n];
    for column in 0..n {
        covariance[column * n..(column + 1) * n]
            .copy_from_slice(&solution.covariance[column * total..column * total + n]);
    }
    let mut shapes = Vec::new();
    for (o, owner) in problem.owners.iter().enumerate() {
        for (i, shape) in owner.shapes.iter().enumerate() {
            let unit = point.units[o][i];
            let deviation = free
                .iter()
                .position(|s| s.shape == (o, i))
                .map(|k| n + k)
                .filter(|k| solution.excited[*k])
                .map(|k| (solution.covariance[k * total + k] * bandwidth).sqrt());
            let estimate = shape.value;
            shapes.push(FittedShape {
                group: owner.group,
                model: owner.models[i].clone(),
                name: shape.name.clone(),
                unit: shape.unit.clone(),
                start: begin[o].shapes[i].value,
                value: estimate,
                std_dev: deviation.map(|d| d * slope(shape, estimate)),
                interval_95: deviation.map(|d| {
                    [-1.0, 1.0].map(|side| value(shape, (unit + side * NORMAL_95 * d).clamp(0.0, 1.0)))
                }),
                lower: shape.lower,
                upper: shape.upper,
                scale: shape.scale,
                at_bound: at_bound(unit),
                agreeing_starts: found.agreeing[o],
            });
        }
    }
    Ok(Precision { shapes, covariance })
}

fn at_bound(unit: f64) -> bool {
    !(AT_BOUND..=1.0 - AT_BOUND).contains(&unit)
}

/// Change of a shape's value by its share of the range.
fn slope(shape: &ShapeParameter, value: f64) -> f64 {
    match shape.scale {
        Scale::Linear => shape.upper - shape.lower,
        Scale::Logarithmic => value * libm::log(shape.upper / shape.lower),
    }
}
