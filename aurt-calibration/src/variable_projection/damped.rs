use nalgebra::{DMatrix, DVector};

use super::problem::{Linearised, Point, Problem, Sensitivity};
use crate::CalibrationError;
use crate::linear::Cholesky;

/// Steps shorter than this share of a shape's range are no progress.
const SMALLEST_STEP: f64 = 1e-6;
/// Lower costs by less than this share are no progress.
const SMALLEST_GAIN: f64 = 1e-11;
/// Damping tried before a step is given up.
const MOST_DAMPING: f64 = 1e8;

/// Settings of the search for shape parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShapeOptions {
    /// Points of the box that are tried for every shape of a joint, beside the model's own.
    pub points_per_shape: usize,
    /// How many of them, the best, are refined.
    pub refined: usize,
    /// Most iterations of one refinement.
    pub iterations: usize,
}

impl Default for ShapeOptions {
    fn default() -> Self {
        Self { points_per_shape: 8, refined: 3, iterations: 40 }
    }
}

#[derive(Debug, Clone)]
pub(super) struct Descent {
    pub point: Point,
    pub iterations: usize,
    pub converged: bool,
}

/// Levenberg and Marquardt's method over the shapes of `owners`, within the bounds.
///
/// # Errors
/// What models report at the point that the search is at; where they refuse a trial, the step is shortened.
pub(super) fn descend(
    problem: &Problem<'_>,
    start: Point,
    owners: &[usize],
    options: &ShapeOptions,
) -> Result<Descent, CalibrationError> {
    let mut descent = Descent { point: start, iterations: 0, converged: false };
    let mut damping = 1e-3;
    while descent.iterations < options.iterations {
        descent.iterations += 1;
        let point = &descent.point;
        let coefficients = problem.coefficients(point)?;
        let sensitivities = problem.sensitivities(point, owners, &coefficients)?;
        let linearised = problem.linearised(point, &sensitivities);
        let units: Vec<f64> = sensitivities.iter().map(|s| point.units[s.shape.0][s.shape.1]).collect();
        let Some((next, longest)) =
            shorten(problem, point, &sensitivities, &linearised, &units, &mut damping)?
        else {
            descent.converged = true;
            break;
        };
        let gain = (point.cost - next.cost) / point.cost;
        descent.point = next;
        if longest < SMALLEST_STEP || gain < SMALLEST_GAIN {
            descent.converged = true;
            break;
        }
    }
    Ok(descent)
}

/// The first damped step that lowers the cost, and its largest component.
fn shorten(
    problem: &Problem<'_>,
    point: &Point,
    sensitivities: &[Sensitivity],
    linearised: &Linearised,
    units: &[f64],
    damping: &mut f64,
) -> Result<Option<(Point, f64)>, CalibrationError> {
    while *damping < MOST_DAMPING {
        let target: Vec<f64> = step(linearised, units, *damping)
            .iter()
            .zip(units)
            .map(|(step, unit)| (unit + step).clamp(0.0, 1.0))
            .collect();
        let longest = target.iter().zip(units).fold(0.0_f64, |a, (t, u)| a.max((t - u).abs()));
        if longest < 0.1 * SMALLEST_STEP {
            *damping = 1e-3;
            return Ok(None);
        }
        let trial = problem.moved(point, &changes(point, sensitivities, &target));
        if let Ok(trial) = trial
            && trial.cost < point.cost
        {
            *damping = (*damping / 5.0).max(1e-9);
            return Ok(Some((trial, longest)));
        }
        *damping *= 4.0;
    }
    *damping = 1e-3;
    Ok(None)
}

/// (GᵀG + λ diag GᵀG) δ = Gᵀg over the shapes that are not held at a bound.
fn step(linearised: &Linearised, units: &[f64], damping: f64) -> Vec<f64> {
    let n = units.len();
    let free: Vec<usize> = (0..n)
        .filter(|k| {
            let outwards = (units[*k] <= 0.0 && linearised.slope[*k] < 0.0)
                || (units[*k] >= 1.0 && linearised.slope[*k] > 0.0);
            !outwards && linearised.gram[k * n + k] > 0.0
        })
        .collect();
    let m = free.len();
    let matrix = DMatrix::from_fn(m, m, |a, b| {
        linearised.gram[free[a] * n + free[b]] * if a == b { 1.0 + damping } else { 1.0 }
    });
    let right = DVector::from_fn(m, |k, _| linearised.slope[free[k]]);
    let mut step = vec![0.0; n];
    if let Some(factor) = Cholesky::of(&matrix) {
        free.iter().zip(factor.solve(&right).iter()).for_each(|(k, value)| step[*k] = *value);
    }
    step
}

/// The owners' new shapes for the shapes of `sensitivities`.
pub(super) fn changes(
    point: &Point,
    sensitivities: &[Sensitivity],
    target: &[f64],
) -> Vec<(usize, Vec<f64>)> {
    let mut changes: Vec<(usize, Vec<f64>)> = Vec::new();
    for (sensitivity, unit) in sensitivities.iter().zip(target) {
        let (owner, shape) = sensitivity.shape;
        if changes.last().is_none_or(|(o, _)| *o != owner) {
            changes.push((owner, point.units[owner].clone()));
        }
        if let Some((_, units)) = changes.last_mut() {
            units[shape] = *unit;
        }
    }
    changes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_at_its_bound_is_held_there() {
        let linearised = Linearised { gram: vec![1.0, 0.5, 0.5, 1.0], slope: vec![0.3, -0.2] };
        let step = step(&linearised, &[1.0, 0.5], 0.0);
        assert_eq!(step[0], 0.0);
        assert!((step[1] + 0.2).abs() < 1e-15);
    }
}
