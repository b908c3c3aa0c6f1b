use aurt_traits::{ColumnGroup, MeasurementUnit};

use super::owner::{Owner, value};
use super::problem::{Point, Problem};
use super::report::FittedShape;
use super::search::Found;
use crate::uncertainty::NORMAL_95;
use crate::{CalibrationError, Estimator, estimate};

/// A shape this close to an end of its range lies at the bound.
const AT_BOUND: f64 = 1e-6;

/// The shapes with their precision, and the covariance of the coefficients with shapes uncertain too.
pub(super) struct Precision {
    pub shapes: Vec<FittedShape>,
    /// Column-major, over the model's coefficients.
    pub covariance: Vec<f64>,
}

/// Solves the problem with a column for every shape that is free, (∂W/∂θ) ζ, around the minimum.
pub(super) fn precision(
    problem: &Problem<'_>,
    point: &Point,
    found: &Found,
    begin: &[Owner],
    coefficients: &[f64],
    (unit, estimator, bandwidth): (MeasurementUnit, Estimator, f64),
) -> Result<Precision, CalibrationError> {
    let n = problem.model.parameters().len();
    let owners: Vec<usize> = (0..problem.owners.len()).collect();
    // A shape at its bound is uncertain as well, and the others with it.
    let free = problem.sensitivities(point, &owners, coefficients)?;
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
        let bodies = problem.model.rigid_body();
        let slides = matches!(owner.group, ColumnGroup::JointDynamics(joint) if bodies.slides(joint));
        for (i, shape) in owner.shapes.iter().enumerate() {
            let at = point.units[o][i];
            let deviation = free
                .iter()
                .position(|s| s.shape == (o, i))
                .map(|k| n + k)
                .filter(|k| solution.excited[*k] && !at_bound(at))
                .map(|k| (solution.covariance[k * total + k] * bandwidth).sqrt());
            let estimate = shape.value;
            let mut fitted = FittedShape {
                group: owner.group,
                model: owner.models[i].clone(),
                name: shape.name.clone(),
                unit: unit.express_of_joint(&shape.unit, slides),
                start: begin[o].shapes[i].value,
                value: estimate,
                std_dev: None,
                shift_by_position_noise: None,
                interval_95: deviation.map(|d| {
                    [-1.0, 1.0].map(|side| value(shape, (at + side * NORMAL_95 * d).clamp(0.0, 1.0)))
                }),
                lower: shape.lower,
                upper: shape.upper,
                scale: shape.scale,
                at_bound: at_bound(at),
                agreeing_starts: found.agreeing[o],
            };
            fitted.std_dev = deviation.map(|d| d * fitted.slope());
            shapes.push(fitted);
        }
    }
    Ok(Precision { shapes, covariance })
}

pub(super) fn at_bound(unit: f64) -> bool {
    !(AT_BOUND..=1.0 - AT_BOUND).contains(&unit)
}
