use rayon::prelude::*;

use super::damped::{Descent, ShapeOptions, descend};
use super::problem::{Point, Problem};
use crate::CalibrationError;

#[derive(Debug, Clone)]
pub(super) struct Found {
    pub descent: Descent,
    /// For each owner, how many of the refined starts ended at the best cost.
    pub agreeing: Vec<usize>,
    /// Starts refined for each owner.
    pub starts: usize,
}

/// Costs that differ by less than this share are one minimum.
const SAME_COST: f64 = 1e-6;
/// Steps with which the surroundings of a minimum are searched, as shares of a shape's range.
const LOOK_AROUND: [f64; 3] = [0.05, 0.01, 0.002];
/// How often a minimum that has something better beside it is left again.
const MOST_ESCAPES: usize = 6;

pub(super) fn search_box(
    problem: &Problem<'_>,
    start: Point,
    options: &ShapeOptions,
) -> Result<Found, CalibrationError> {
    let alone: Vec<(Descent, usize)> = (0..problem.owners.len())
        .into_par_iter()
        .map(|owner| search_owner(problem, &start, owner, options))
        .collect::<Result<_, _>>()?;
    let mut point = start;
    let mut iterations = 0;
    for (owner, (descent, _)) in alone.iter().enumerate() {
        iterations += descent.iterations;
        let moved = problem.moved(&point, &[(owner, descent.point.units[owner].clone())])?;
        if moved.cost < point.cost {
            point = moved;
        }
    }
    let mut descent = search_nearby(problem, point, options)?;
    descent.iterations += iterations;
    Ok(Found { descent, agreeing: alone.iter().map(|(_, n)| *n).collect(), starts: options.refined.max(1) })
}

pub(super) fn search_nearby(
    problem: &Problem<'_>,
    start: Point,
    options: &ShapeOptions,
) -> Result<Descent, CalibrationError> {
    let all: Vec<usize> = (0..problem.owners.len()).collect();
    let mut descent = descend(problem, start, &all, options)?;
    for _ in 0..MOST_ESCAPES {
        let Some(better) = look_around(problem, &descent.point) else { break };
        let next = descend(problem, better, &all, options)?;
        descent = Descent { iterations: descent.iterations + next.iterations, ..next };
    }
    Ok(descent)
}

/// A point beside this one that is better by more than rounding, stepping along one shape at a time.
fn look_around(problem: &Problem<'_>, point: &Point) -> Option<Point> {
    let steps = LOOK_AROUND.iter().flat_map(|s| [*s, -*s]);
    let trials: Vec<(usize, Vec<f64>)> = steps
        .flat_map(|step| {
            point.units.iter().enumerate().flat_map(move |(owner, units)| {
                (0..units.len()).map(move |shape| {
                    let mut moved = units.clone();
                    moved[shape] = (moved[shape] + step).clamp(0.0, 1.0);
                    (owner, moved)
                })
            })
        })
        .collect();
    let tried: Vec<Point> =
        trials.into_par_iter().filter_map(|change| problem.moved(point, &[change]).ok()).collect();
    let best = tried.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost))?;
    (best.cost < point.cost * (1.0 - SAME_COST)).then_some(best)
}

/// The best of several starts for one owner, the others' shapes staying; and how many starts agree with it.
fn search_owner(
    problem: &Problem<'_>,
    start: &Point,
    owner: usize,
    options: &ShapeOptions,
) -> Result<(Descent, usize), CalibrationError> {
    let shapes = problem.owners[owner].shapes.len();
    let spread = (1..=options.points_per_shape * shapes).map(|k| halton(k, shapes));
    // A point that a model refuses is no start.
    let mut starts: Vec<Point> =
        spread.filter_map(|units| problem.moved(start, &[(owner, units)]).ok()).collect();
    starts.push(start.clone());
    starts.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    starts.truncate(options.refined.max(1));
    let mut descents = starts
        .into_iter()
        .map(|point| descend(problem, point, &[owner], options))
        .collect::<Result<Vec<_>, _>>()?;
    let iterations = descents.iter().map(|d| d.iterations).sum();
    descents.sort_by(|a, b| a.point.cost.total_cmp(&b.point.cost));
    let best = descents[0].point.cost;
    let agreeing = descents.iter().filter(|d| d.point.cost <= best * (1.0 + SAME_COST)).count();
    let best = descents.swap_remove(0);
    Ok((Descent { iterations, ..best }, agreeing))
}

/// The k-th point of Halton's sequence in the unit box: spread evenly, and the same every time.
fn halton(k: usize, dimensions: usize) -> Vec<f64> {
    const PRIMES: [usize; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];
    (0..dimensions)
        .map(|d| {
            let base = PRIMES[d % PRIMES.len()];
            let (mut rest, mut share, mut value) = (k, 1.0, 0.0);
            while rest > 0 {
                share /= base as f64;
                value += share * (rest % base) as f64;
                rest /= base;
            }
            value
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_are_spread_over_the_box() {
        let points: Vec<Vec<f64>> = (1..=16).map(|k| halton(k, 2)).collect();
        assert_eq!(points[0], [0.5, 1.0 / 3.0]);
        for quadrant in 0..4 {
            let inside =
                |p: &&Vec<f64>| (p[0] >= 0.5) == (quadrant % 2 == 1) && (p[1] >= 0.5) == (quadrant / 2 == 1);
            assert!(points.iter().filter(inside).count() >= 3, "quadrant {quadrant}");
        }
    }
}
