use super::{
    problem::{Linearised, Point, Problem, Sensitivity},
    search::ShapeOptions,
};
use crate::CalibrationError;

/// Steps shorter than this share of a shape's range are no progress.
const SMALLEST_STEP: f64 = 1e-6;
/// Lower costs by less than this share are no progress.
const SMALLEST_GAIN: f64 = 1e-11;
/// Damping tried before a step is given up.
const MOST_DAMPING: f64 = 1e8;

/// Where a descent ended.
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
    let mut matrix: Vec<f64> =
        free.iter().flat_map(|a| free.iter().map(move |b| linearised.gram[a * n + b])).collect();
    for k in 0..m {
        matrix[k * m + k] *= 1.0 + damping;
    }
    let right: Vec<f64> = free.iter().map(|k| linearised.slope[*k]).collect();
    let mut step = vec![0.0; n];
    if let Some(solution) = cholesky_solve(matrix, right) {
        free.iter().zip(solution).for_each(|(k, value)| step[*k] = value);
    }
    step
}

/// The solution of a symmetric positive definite system; nothing if it is not.
fn cholesky_solve(mut matrix: Vec<f64>, mut right: Vec<f64>) -> Option<Vec<f64>> {
    let n = right.len();
    for k in 0..n {
        for row in k..n {
            let sum: f64 = (0..k).map(|i| matrix[i * n + row] * matrix[i * n + k]).sum();
            matrix[k * n + row] -= sum;
        }
        let pivot = matrix[k * n + k];
        if !(pivot.is_finite() && pivot > 0.0) {
            return None;
        }
        let root = pivot.sqrt();
        matrix[k * n + k..(k + 1) * n].iter_mut().for_each(|v| *v /= root);
    }
    for k in 0..n {
        let sum: f64 = (0..k).map(|i| matrix[i * n + k] * right[i]).sum();
        right[k] = (right[k] - sum) / matrix[k * n + k];
    }
    for k in (0..n).rev() {
        let sum: f64 = (k + 1..n).map(|i| matrix[k * n + i] * right[i]).sum();
        right[k] = (right[k] - sum) / matrix[k * n + k];
    }
    Some(right)
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
    fn a_positive_definite_system_is_solved_and_another_refused() {
        let solution = cholesky_solve(vec![4.0, 2.0, 2.0, 3.0], vec![10.0, 8.0]).unwrap();
        assert!((solution[0] - 1.75).abs() < 1e-14 && (solution[1] - 1.5).abs() < 1e-14);
        assert_eq!(cholesky_solve(vec![1.0, 2.0, 2.0, 1.0], vec![1.0, 1.0]), None);
    }

    #[test]
    fn a_shape_at_its_bound_is_held_there() {
        let linearised = Linearised { gram: vec![1.0, 0.5, 0.5, 1.0], slope: vec![0.3, -0.2] };
        let step = step(&linearised, &[1.0, 0.5], 0.0);
        assert_eq!(step[0], 0.0);
        assert!((step[1] + 0.2).abs() < 1e-15);
    }
}
