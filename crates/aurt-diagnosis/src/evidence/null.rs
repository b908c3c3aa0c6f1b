//! What chance finds: the same search on residuals that have nothing to do with the columns.
//!
//! The residual of a model is shifted in circles against the columns, in every recording by the same share of its length.
//! It keeps its memory and its size, joints keep what ties them, and what it has to do with the columns is gone, unless
//! the motion repeats after just that time. How well the best of all hypotheses then does tells what a score is worth:
//! that many were tried is paid for. The moments of the columns stay; only their products with the residual are new.

use rayon::prelude::*;

use crate::evidence::gram::{Moments, dot};
use crate::evidence::linear::solve_signed;
use crate::evidence::problem::{PartFit, Problem, ROUNDING};
use crate::hypotheses::group::{Group, Switch};
use crate::recordings::partition::Partition;
use crate::recordings::rows::{RecordingRows, Role};

/// A residual that was shifted: its products with all columns, `[block][kind][joint]`, and its own square.
struct Shifted {
    parts: Vec<[Vec<Product>; 2]>,
    total: [Vec<Product>; 2],
}

#[derive(Debug, Clone)]
struct Product {
    right: Vec<f64>,
    square: f64,
}

/// Held-out mean squared errors under one shift: without a group, and with each.
#[derive(Debug, Clone)]
pub(crate) struct ByChance {
    /// Without, joint by joint.
    pub(crate) before: Vec<f64>,
    /// With each group, `[group][joint]`.
    pub(crate) after: Vec<Vec<f64>>,
}

/// One training part with its test part, and the nested model under each shift.
struct Fold<'a> {
    train: &'a [Vec<Moments>; 2],
    test: &'a [Vec<Moments>; 2],
    fit: PartFit,
    /// XᵀX of the nested columns over the test part, joint by joint.
    nested: Vec<Vec<f64>>,
    shifts: Vec<OfShift>,
}

/// A nested model fitted to a shifted residual.
struct OfShift {
    train: [Vec<Vec<f64>>; 2],
    test: [Vec<Vec<f64>>; 2],
    forward: Vec<f64>,
    beta: Vec<f64>,
    /// Xᵀ(e − Xβ) over the test part, joint by joint.
    gradient: Vec<Vec<f64>>,
    /// ‖e − Xβ‖² over the test part, joint by joint.
    squared: Vec<f64>,
}

/// A shift after which some joint's velocity resembles itself this much (correlation) leaves the residual where it was.
const REPEATS: f64 = 0.5;

/// Whether the motion repeats after a share of every recording's length.
fn repeats(recordings: &[RecordingRows], partition: &Partition, share: f64) -> bool {
    recordings.iter().enumerate().any(|(r, recording)| {
        let end = fitted_end(partition, r);
        let by = (share * end as f64).round() as usize;
        recording.joints.iter().any(|joint| {
            let velocity = &joint.velocity_rad_s[..end];
            let turned: Vec<f64> = velocity[by..].iter().chain(&velocity[..by]).copied().collect();
            dot(velocity, &turned).abs() > REPEATS * dot(velocity, velocity)
        })
    })
}

/// The end of the rows of a recording that fit.
fn fitted_end(partition: &Partition, recording: usize) -> usize {
    partition.fitted().filter(|p| p.0 == recording).map(|p| p.2).max().unwrap_or(0)
}

/// What the groups do by chance beside a nested model, under at most `shifts` shifts of a residual,
/// `[recording][joint][row]`: those after which the motion does not repeat.
pub(crate) fn by_chance(
    problem: &Problem,
    nested: &[Switch],
    groups: &[Group],
    weights: &[f64],
    residual: (&[RecordingRows], &Partition, &[Vec<Vec<f64>>]),
    shifts: usize,
) -> Vec<ByChance> {
    let shifted: Vec<Shifted> = (0..shifts)
        .into_par_iter()
        .map(|s| (s + 1) as f64 / (shifts + 1) as f64)
        .filter(|share| !repeats(residual.0, residual.1, *share))
        .map(|share| Shifted::new(residual, share))
        .collect();
    let shifts = shifted.len();
    let folds: Vec<Fold<'_>> = (0..problem.blocks())
        .into_par_iter()
        .map(|b| Fold::new(problem, b, nested, weights, &shifted))
        .collect();
    let rows: Vec<f64> = (0..problem.joints()).map(|j| problem.rows(j, false).max(1.0)).collect();
    let mean = |sums: Vec<f64>| sums.iter().zip(&rows).map(|(s, n)| s / n).collect::<Vec<f64>>();
    let errors: Vec<Vec<Vec<f64>>> =
        groups.par_iter().map(|group| of_group(problem, &folds, nested, group, weights, shifts)).collect();
    (0..shifts)
        .map(|s| {
            let sum = |j: usize| folds.iter().map(|fold| fold.shifts[s].squared[j]).sum();
            ByChance {
                before: mean((0..problem.joints()).map(sum).collect()),
                after: errors.iter().map(|of_shift| mean(of_shift[s].clone())).collect(),
            }
        })
        .collect()
}

impl Shifted {
    fn new(
        (recordings, partition, residual): (&[RecordingRows], &Partition, &[Vec<Vec<f64>>]),
        share: f64,
    ) -> Self {
        let turned: Vec<Vec<Vec<f64>>> = recordings
            .iter()
            .zip(residual)
            .enumerate()
            .map(|(r, (recording, residual))| {
                let end = fitted_end(partition, r);
                let by = (share * end as f64).round() as usize;
                let of_joint = |(joint, series): (&crate::recordings::rows::JointRows, &Vec<f64>)| {
                    turned(&series[..end], &joint.counts[..end], by)
                };
                recording.joints.iter().zip(residual).map(of_joint).collect()
            })
            .collect();
        let joints = recordings.first().map_or(0, |r| r.joints.len());
        let columns = |j: usize| {
            recordings
                .first()
                .map_or(0, |r| r.joints[j].data.len().checked_div(r.joints[j].measurement.len()).unwrap_or(0))
        };
        let zero = || [0, 1].map(|_| (0..joints).map(|j| Product::zero(columns(j))).collect::<Vec<_>>());
        let mut total = zero();
        let parts = partition
            .blocks
            .iter()
            .map(|block| {
                let mut part = zero();
                for (r, start, end) in block {
                    let kind = usize::from(recordings[*r].role == Role::Target);
                    for (j, joint) in recordings[*r].joints.iter().enumerate() {
                        let y = &turned[*r][j][*start..*end];
                        let product = &mut part[kind][j];
                        for (k, sum) in product.right.iter_mut().enumerate() {
                            *sum += dot(&joint.column(k)[*start..*end], y);
                        }
                        product.square += dot(y, y);
                    }
                }
                for (sum, own) in total.iter_mut().flatten().zip(part.iter().flatten()) {
                    sum.right.iter_mut().zip(&own.right).for_each(|(s, o)| *s += o);
                    sum.square += own.square;
                }
                part
            })
            .collect();
        Self { parts, total }
    }
}

impl Product {
    fn zero(columns: usize) -> Self {
        Self { right: vec![0.0; columns], square: 0.0 }
    }
}

/// A series turned in a circle, of the same power over the rows that count.
fn turned(series: &[f64], counts: &[bool], by: usize) -> Vec<f64> {
    let n = series.len();
    let mut turned: Vec<f64> = (0..n).map(|k| if counts[k] { series[(k + by) % n] } else { 0.0 }).collect();
    let power = |of: &[f64]| dot(of, of);
    let factor = (power(series) / power(&turned)).sqrt();
    if factor.is_finite() {
        turned.iter_mut().for_each(|v| *v *= factor);
    }
    turned
}

impl<'a> Fold<'a> {
    fn new(
        problem: &'a Problem,
        block: usize,
        nested: &[Switch],
        weights: &[f64],
        shifted: &[Shifted],
    ) -> Self {
        let (train, test) = problem.fold(block);
        let fit = problem.part_fit(train, nested, nested.len(), weights);
        let only = |j: usize| (0..problem.joints()).map(|k| f64::from(u8::from(k == j))).collect::<Vec<_>>();
        let own: Vec<Vec<f64>> =
            (0..problem.joints()).map(|j| problem.cross(test, nested, nested, &only(j))).collect();
        let n = nested.len();
        let shifts = shifted
            .iter()
            .map(|s| {
                let rights = |of: &[Vec<Product>; 2]| {
                    [0, 1].map(|kind| of[kind].iter().map(|p| p.right.clone()).collect::<Vec<_>>())
                };
                let part = &s.parts[block];
                let test_right = rights(part);
                let mut train_right = rights(&s.total);
                for (rest, part) in train_right.iter_mut().flatten().zip(test_right.iter().flatten()) {
                    rest.iter_mut().zip(part).for_each(|(r, p)| *r -= p);
                }
                let mut forward = problem.right_of(&train_right, nested, weights);
                fit.forward(&mut forward);
                let mut beta = forward.clone();
                fit.backward(&mut beta);
                let mut gradient = Vec::new();
                let mut squared = Vec::new();
                for (j, own) in own.iter().enumerate() {
                    let right = problem.right_of(&test_right, nested, &only(j));
                    let image: Vec<f64> = (0..n).map(|k| dot(&own[k * n..(k + 1) * n], &beta)).collect();
                    let square = part[0][j].square + part[1][j].square;
                    squared.push((square - 2.0 * dot(&right, &beta) + dot(&image, &beta)).max(0.0));
                    gradient.push(right.iter().zip(&image).map(|(r, i)| r - i).collect());
                }
                OfShift { train: train_right, test: test_right, forward, beta, gradient, squared }
            })
            .collect();
        Self { train, test, fit, nested: own, shifts }
    }
}

/// Squared errors with a group, `[shift][joint]`, over all test parts.
fn of_group(
    problem: &Problem,
    folds: &[Fold<'_>],
    nested: &[Switch],
    group: &Group,
    weights: &[f64],
    shifts: usize,
) -> Vec<Vec<f64>> {
    let own = &group.switches;
    let (n, g, joints) = (nested.len(), own.len(), problem.joints());
    let nonnegative: Vec<bool> = own.iter().map(|s| s.nonnegative).collect();
    let mut sums = vec![vec![0.0; joints]; shifts];
    for fold in folds {
        // The group's columns less what the nested model makes of them on the training part.
        let mut projected = problem.cross(fold.train, nested, own, weights);
        projected.chunks_exact_mut(n.max(1)).for_each(|c| fold.fit.forward(c));
        let mut absorbed = projected.clone();
        absorbed.chunks_exact_mut(n.max(1)).for_each(|c| fold.fit.backward(c));
        let of = |k: usize| &projected[k * n..(k + 1) * n];
        let taken = |k: usize| &absorbed[k * n..(k + 1) * n];
        let whole = problem.cross(fold.train, own, own, weights);
        let mut schur = vec![0.0; g * g];
        for b in 0..g {
            for a in 0..g {
                schur[b * g + a] = whole[b * g + a] - dot(of(a), of(b));
            }
        }
        // What the nested model absorbs, its own columns among it, leaves rounding.
        for k in 0..g {
            if schur[k * g + k] <= ROUNDING * whole[k * g + k] {
                schur[k * g + k] = 0.0;
            }
        }
        // Over the test part, joint by joint: products with the nested columns, and the Gram matrix of what is free.
        let tested: Vec<(Vec<f64>, Vec<f64>)> = (0..joints)
            .map(|j| {
                let only: Vec<f64> = (0..joints).map(|k| f64::from(u8::from(k == j))).collect();
                let beside = problem.cross(fold.test, nested, own, &only);
                let mut free = problem.cross(fold.test, own, own, &only);
                let gram = &fold.nested[j];
                for b in 0..g {
                    let image: Vec<f64> = (0..n).map(|k| dot(&gram[k * n..(k + 1) * n], taken(b))).collect();
                    for a in 0..g {
                        free[b * g + a] += dot(taken(a), &image)
                            - dot(taken(a), &beside[b * n..(b + 1) * n])
                            - dot(taken(b), &beside[a * n..(a + 1) * n]);
                    }
                }
                (beside, free)
            })
            .collect();
        for (sum, shift) in sums.iter_mut().zip(&fold.shifts) {
            let mut right = problem.right_of(&shift.train, own, weights);
            right.iter_mut().enumerate().for_each(|(k, r)| *r -= dot(of(k), &shift.forward));
            let extension = solve_signed(&schur, &right, &nonnegative);
            for (j, (beside, free)) in tested.iter().enumerate() {
                let only: Vec<f64> = (0..joints).map(|k| f64::from(u8::from(k == j))).collect();
                let measured = problem.right_of(&shift.test, own, &only);
                let mut change = 0.0;
                for b in 0..g {
                    let inner = measured[b]
                        - dot(&beside[b * n..(b + 1) * n], &shift.beta)
                        - dot(taken(b), &shift.gradient[j]);
                    let quadratic = dot(&free[b * g..(b + 1) * g], &extension);
                    change += extension[b] * (quadratic - 2.0 * inner);
                }
                sum[j] += (shift.squared[j] + change).max(0.0);
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::turned;

    #[test]
    fn a_turned_series_keeps_its_power_and_leaves_out_what_does_not_count() {
        let counts = [true, true, false, true];
        let series = turned(&[1.0, 2.0, 0.0, 2.0], &counts, 1);
        assert_eq!(series[2], 0.0);
        assert!((series.iter().map(|v| v * v).sum::<f64>() - 9.0).abs() < 1e-12, "{series:?}");
        assert!((series[0] / series[3] - 2.0).abs() < 1e-12, "{series:?}");
    }
}
