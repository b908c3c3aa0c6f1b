//! Shapes of a law, by variable projection.
//!
//! For given shapes θ the coefficients follow by least squares, so that only V(θ) = ½ Σ_j n_eff,j log MSE_j is searched
//! (Golub and Pereyra 1973), the likelihood with the joints' variances at their best, in the units of a score. The columns
//! of one law change with θ; all other moments stay. The search begins at the best of the starts that the law has on these
//! joints. Along each shape in turn: steps until the error rises, then the vertex of the parabola through the lowest three;
//! steps shrink from one cycle to the next. The curvature of V at the minimum gives the deviations. Of two laws with the same shapes the
//! one with the lower V is taken when deviations are, which is at the end: it changes no search.
//!
//! [`aurt_calibration`]'s search over shapes fits whole models from recordings; it knows no switches that act in some
//! recordings only, no signs, and no shapes of arm terms that do not declare them (a coupling's ratio, an order of
//! ripple), and every step of it evaluates the whole model.

use aurt_traits::ArmTerm;
use rayon::prelude::*;

use crate::evidence::gram::Moments;
use crate::evidence::total::free_first;
use crate::hypotheses::group::{Group, Switch};
use crate::recordings::partition::Part;
use crate::recordings::rows::Role;
use crate::recordings::term_rows::term_rows;
use crate::search::ground::{Beside, Recorded};
use crate::vocabulary::shape::Shape;
use crate::vocabulary::{Addition, Proposal};

/// Cycles through all shapes; steps shrink by [`SHRINK`] from one to the next, to a fiftieth of the first: less than
/// the deviation of any shape that is worth a name.
const CYCLES: usize = 3;
const SHRINK: f64 = 0.3;

/// Steps in one direction before it is another start's business.
const FARTHEST: usize = 4;

/// A cycle that lowers V by less than this is the last; one is a likelihood ratio that nobody would act on.
const LEAST_GAIN: f64 = 0.05;

/// Steps, in units of a shape's own, at which the curvature is taken.
const CURVATURE_STEP: f64 = 0.1;

/// The estimation of the shapes of one law.
pub(crate) struct Estimate<'a, 'b> {
    ground: &'a mut Recorded<'b>,
    group: &'a Group,
    beside: &'a Beside<'a>,
    shapes: Vec<Shape>,
    /// Moments of everything, of which those of the law are taken anew.
    trial: [Vec<Moments>; 2],
    /// Joints with the local columns of the law, and of the others in the model.
    places: Vec<(usize, Vec<usize>, Vec<usize>)>,
    weights: Vec<f64>,
}

impl<'a, 'b> Estimate<'a, 'b> {
    pub(crate) fn new(
        ground: &'a mut Recorded<'b>,
        group: &'a Group,
        beside: &'a Beside<'a>,
    ) -> Option<Self> {
        let candidate = &ground.candidates[group.candidate];
        let shapes = candidate.proposal.shapes.clone();
        let local = |joint: usize, column: usize| ground.layout.rows[joint].iter().position(|c| *c == column);
        let places = group
            .joints
            .iter()
            .map(|j| {
                let own: Vec<usize> = candidate.columns.iter().filter_map(|c| local(*j, *c)).collect();
                let others = beside.switches.iter().filter_map(|s| local(*j, s.column));
                (*j, own, others.collect())
            })
            .collect();
        let trial = ground.problem.total().clone();
        let mut estimate = Self { ground, group, beside, shapes, trial, places, weights: Vec::new() };
        let errors = estimate.errors(&group.switches)?;
        estimate.weights = (0..errors.len())
            .map(|j| {
                let variance = errors[j] / estimate.ground.problem.rows(j, false).max(1.0);
                1.0 / variance.max(beside.floor[j]).max(f64::MIN_POSITIVE)
            })
            .collect();
        Some(estimate)
    }

    /// Searches; whether the shapes have moved, or the law has changed.
    pub(crate) fn run(mut self) -> bool {
        let start = self.values();
        let Some((mut values, mut least)) = self.lowest(&start) else { return false };
        let mut swapped = false;
        if self.beside.deviations && self.proposal().other_law.is_some() {
            self.proposal().swap_laws();
            let other = self.lowest(&values).filter(|(_, v)| *v < least);
            swapped = other.is_some();
            match other {
                Some(other) => (values, least) = other,
                None => self.proposal().swap_laws(),
            }
        }
        let deviations =
            if self.beside.deviations { self.deviations(&values, least) } else { vec![None; values.len()] };
        let found = self.put(&values, true).is_some();
        let (settled, moved) =
            if found { (values.clone(), swapped || values != start) } else { (start.clone(), false) };
        if !found {
            // The start can be evaluated, with the law that it has.
            if swapped {
                self.proposal().swap_laws();
            }
            let _ = self.put(&start, true);
        }
        let candidate = &mut self.ground.candidates[self.group.candidate];
        candidate.proposal.reshaped(&settled, &deviations);
        for (joint, own, _) in &self.places {
            self.ground.problem.renew(self.ground.rows, self.ground.partition, *joint, own);
        }
        moved
    }

    /// The lowest point that a search from some values and the law's starts finds, and V there; none if V has no value at the first.
    fn lowest(&mut self, start: &[f64]) -> Option<(Vec<f64>, f64)> {
        let mut values = start.to_vec();
        let mut least = self.objective(&values)?;
        let mut usual = (values.clone(), f64::INFINITY);
        for other in self.starts() {
            let Some(v) = self.objective(&other) else { continue };
            if v < least {
                (values, least) = (other.clone(), v);
            }
            if v < usual.1 {
                usual = (other, v);
            }
        }
        let mut shrunk = 1.0;
        for _ in 0..CYCLES {
            let before = least;
            for k in 0..self.shapes.len() {
                (values[k], least) = self.along(k, &values, shrunk * self.shapes[k].step, least);
            }
            if before - least < LEAST_GAIN {
                break;
            }
            shrunk *= SHRINK;
        }
        // A usual value gives way to evidence on which an effect would be claimed.
        let least_score = self.ground.question.selection.score;
        if self.shapes.iter().all(|s| s.usual) && usual.1 - least < least_score {
            return Some(usual);
        }
        Some((values, least))
    }

    fn proposal(&mut self) -> &mut Proposal {
        &mut self.ground.candidates[self.group.candidate].proposal
    }

    fn values(&self) -> Vec<f64> {
        let proposal = &self.ground.candidates[self.group.candidate].proposal;
        let Addition::Term(term) = &proposal.addition else { return Vec::new() };
        self.shapes.iter().map(|s| s.value(term).unwrap_or(s.bounds[0])).collect()
    }

    /// Where the search for the same law on the same joints begins; of what a joint can have several, each is its own.
    fn starts(&self) -> Vec<Vec<f64>> {
        let candidates = &*self.ground.candidates;
        let own = &candidates[self.group.candidate];
        if self.group.effect.is_repeatable {
            return vec![own.proposal.starts.clone()];
        }
        let same = candidates.iter().filter(|c| {
            c.effect == own.effect
                && c.proposal.joints == own.proposal.joints
                && c.proposal.shapes == own.proposal.shapes
        });
        same.map(|c| c.proposal.starts.clone()).collect()
    }

    /// The lowest point along a shape, and V there.
    fn along(&mut self, k: usize, from: &[f64], step: f64, least: f64) -> (f64, f64) {
        let shape = self.shapes[k].clone();
        let mut known: Vec<(f64, f64)> = vec![(from[k], least)];
        let mut at = |value: f64, known: &mut Vec<(f64, f64)>| {
            let mut values = from.to_vec();
            values[k] = value;
            let v = self.objective(&values).unwrap_or(f64::INFINITY);
            known.push((value, v));
            v
        };
        let up = at(shape.moved(from[k], step), &mut known);
        let direction = if up < least { step } else { -step };
        let (mut here, mut lowest) = if up < least { (known[1].0, up) } else { (from[k], least) };
        for _ in 0..FARTHEST {
            let next = shape.moved(here, direction);
            if next == here {
                break;
            }
            let v = at(next, &mut known);
            if v >= lowest {
                break;
            }
            (here, lowest) = (next, v);
        }
        // The vertex of the parabola through the lowest and its neighbours.
        let place = |value: f64| shape.distance(from[k], value);
        known.sort_by(|a, b| place(a.0).total_cmp(&place(b.0)));
        let lowest_at = known.iter().position(|(value, _)| *value == here).unwrap_or(0);
        if lowest_at > 0 && lowest_at + 1 < known.len() {
            let [a, b, c] = [known[lowest_at - 1], known[lowest_at], known[lowest_at + 1]];
            if let Some(vertex) = vertex([a, b, c].map(|(value, v)| (place(value), v))) {
                let value = shape.moved(from[k], vertex);
                let v = at(value, &mut known);
                if v < lowest {
                    (here, lowest) = (value, v);
                }
            }
        }
        (here, lowest)
    }

    /// Standard deviations, from the curvature of V in all shapes together; none at a bound, or where V is flat.
    fn deviations(&mut self, values: &[f64], least: f64) -> Vec<Option<f64>> {
        let n = values.len();
        let steps: Vec<f64> = self.shapes.iter().map(|s| CURVATURE_STEP * s.step).collect();
        let mut at = |moves: &[(usize, f64)]| {
            let mut moved = values.to_vec();
            for (k, by) in moves {
                moved[*k] = self.shapes[*k].moved(moved[*k], *by);
            }
            self.objective(&moved).unwrap_or(f64::NAN)
        };
        let mut hessian = vec![0.0; n * n];
        for a in 0..n {
            let (h, plus, minus) = (steps[a], at(&[(a, steps[a])]), at(&[(a, -steps[a])]));
            hessian[a * n + a] = (plus - 2.0 * least + minus) / (h * h);
            for b in 0..a {
                let g = steps[b];
                let corners = at(&[(a, h), (b, g)]) - at(&[(a, h), (b, -g)]) - at(&[(a, -h), (b, g)])
                    + at(&[(a, -h), (b, -g)]);
                hessian[a * n + b] = corners / (4.0 * h * g);
                hessian[b * n + a] = hessian[a * n + b];
            }
        }
        inverse_diagonal(&hessian, n)
            .into_iter()
            .enumerate()
            .map(|(k, variance)| {
                let shape = &self.shapes[k];
                let inside = shape.bounds[0] < values[k].abs() && values[k].abs() < shape.bounds[1];
                let deviation = variance.filter(|_| inside)?.sqrt();
                Some(shape.deviation(values[k], deviation))
            })
            .collect()
    }

    /// V at shapes.
    fn objective(&mut self, values: &[f64]) -> Option<f64> {
        self.put(values, false)?;
        let errors = self.errors(&self.group.switches)?;
        let v = self.likelihood(&errors);
        v.is_finite().then_some(v)
    }

    /// V of squared errors.
    fn likelihood(&self, errors: &[f64]) -> f64 {
        let of_joint = |(j, error): (usize, f64)| {
            let rows = self.ground.problem.rows(j, false).max(1.0);
            let variance = (error / rows).max(self.beside.floor[j]).max(f64::MIN_POSITIVE);
            0.5 * self.beside.shares[j] * rows * variance.ln()
        };
        errors.iter().copied().enumerate().map(of_joint).sum()
    }

    /// Writes the law's columns into the rows: of those that fit, or of all.
    fn put(&mut self, values: &[f64], all: bool) -> Option<()> {
        let ground = &mut *self.ground;
        let Addition::Term(configuration) = &ground.candidates[self.group.candidate].proposal.addition else {
            return None;
        };
        let mut configuration = configuration.clone();
        for (shape, value) in self.shapes.iter().zip(values) {
            shape.set(&mut configuration, *value);
        }
        let term = ground.registry.build_from_json::<dyn ArmTerm>(&configuration).ok()?;
        let body = ground.question.model.rigid_body();
        let joints = term.joints(ground.layout.rows.len());
        let columns = &ground.candidates[self.group.candidate].columns;
        let written: Vec<Option<()>> = ground
            .rows
            .par_iter_mut()
            .zip(ground.question.recordings)
            .filter(|(rows, _)| all || rows.role != Role::Validation)
            .map(|(rows, recording)| {
                let series = term_rows(&*term, &**body, &recording.data.data).ok()?;
                for (joint, columns_of_joint) in joints.iter().zip(series) {
                    let own = &mut rows.joints[*joint];
                    let length = own.measurement.len();
                    for (column, values) in columns.iter().zip(columns_of_joint) {
                        let Some(k) = ground.layout.rows[*joint].iter().position(|c| c == column) else {
                            continue;
                        };
                        let place = own.data[k * length..(k + 1) * length].iter_mut();
                        for ((o, value), counts) in place.zip(values).zip(&own.counts) {
                            *o = if *counts { value } else { 0.0 };
                        }
                    }
                }
                Some(())
            })
            .collect();
        if written.iter().any(Option::is_none) {
            return None;
        }
        let fitted: Vec<Part> = ground.partition.fitted().collect();
        let rows = &*ground.rows;
        for (joint, own, others) in &self.places {
            for (kind, moments) in self.trial.iter_mut().enumerate() {
                let of_kind = |(r, _, _): &&Part| usize::from(rows[*r].role == Role::Target) == kind;
                let parts: Vec<Part> = fitted.iter().filter(of_kind).copied().collect();
                moments[*joint].renew(rows, &parts, *joint, own, others);
            }
        }
        Some(())
    }

    /// Squared error of each joint with the law or without, at the shapes whose columns are in place.
    fn errors(&self, law: &[Switch]) -> Option<Vec<f64>> {
        let problem = &self.ground.problem;
        let among = |s: &&Switch| !self.group.switches.contains(s);
        let others: Vec<Switch> = self.beside.switches.iter().filter(among).copied().collect();
        let (ordered, free) = free_first(&others);
        let ones = vec![1.0; problem.joints()];
        let weights = if self.weights.is_empty() { &ones } else { &self.weights };
        let fit = problem.part_fit(&self.trial, &ordered, free, weights);
        let beta = problem.extend(&self.trial, &fit, (&ordered, free), law, weights);
        let all: Vec<Switch> = ordered.iter().chain(law).copied().collect();
        let [calibration, target] = problem.squared_errors(&self.trial, &all, &beta);
        let sums: Vec<f64> = calibration.iter().zip(&target).map(|(a, b)| a + b).collect();
        sums.iter().all(|s| s.is_finite()).then_some(sums)
    }
}

/// Where the parabola through three points is lowest, if it has a minimum between the outer two.
fn vertex([a, b, c]: [(f64, f64); 3]) -> Option<f64> {
    let (left, right) = (b.0 - a.0, c.0 - b.0);
    let (falls, rises) = ((a.1 - b.1) / left, (c.1 - b.1) / right);
    let curvature = (falls + rises) / (left + right);
    let at = b.0 - 0.5 * (rises * left - falls * right) / (left + right) / curvature;
    (curvature > 0.0 && at.is_finite() && at > a.0 && at < c.0).then_some(at)
}

/// Diagonal of the inverse of a symmetric matrix of one or two rows; none where that is not positive definite.
fn inverse_diagonal(matrix: &[f64], n: usize) -> Vec<Option<f64>> {
    match n {
        1 => vec![(matrix[0] > 0.0).then(|| 1.0 / matrix[0])],
        2 => {
            let determinant = matrix[0] * matrix[3] - matrix[1] * matrix[2];
            let definite = determinant > 0.0 && matrix[0] > 0.0;
            [matrix[3], matrix[0]].map(|m| definite.then(|| m / determinant)).to_vec()
        }
        _ => (0..n).map(|k| (matrix[k * n + k] > 0.0).then(|| 1.0 / matrix[k * n + k])).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vertex_of_a_parabola_is_its_minimum() {
        let parabola = |x: f64| (x, 3.0 * (x - 0.4).powi(2) + 1.0);
        let found = vertex([parabola(-1.0), parabola(0.5), parabola(0.9)]).unwrap();
        assert!((found - 0.4).abs() < 1e-12, "{found}");
        let hill = |x: f64| (x, -x * x);
        assert_eq!(vertex([hill(-1.0), hill(0.1), hill(1.0)]), None);
    }

    #[test]
    fn shapes_that_depend_on_each_other_are_less_certain() {
        let variance = inverse_diagonal(&[2.0, 1.0, 1.0, 2.0], 2);
        assert!((variance[0].unwrap() - 2.0 / 3.0).abs() < 1e-12);
        assert_eq!(inverse_diagonal(&[1.0, 2.0, 2.0, 1.0], 2), [None, None]);
    }
}
