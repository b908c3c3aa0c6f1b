//! What chance finds: the same search on residuals that have nothing to do with the columns.
//!
//! The residual of a model is circularly shifted against the columns, in every recording by the same share of its length.
//! It keeps its memory and its size, joints keep what ties them, and what it has to do with the columns is gone, unless
//! the motion repeats after just that time. Where it does after most shifts, as short excitations do, pieces of a second get
//! signs at random as well, the same for all joints: what the residual has to do with the columns is then gone from their
//! sum, and its memory up to a second stays. The best score of all hypotheses then gives the significance of a score,
//! corrected for the number of hypotheses. The moments of the columns stay; only their products with the residual are new.

use aurt_calibration::products_of_columns;
use rayon::prelude::*;

use crate::evidence::gram::{Moments, dot};
use crate::evidence::linear::solve_signed;
use crate::evidence::nested::Test;
use crate::evidence::problem::{PartFit, Place, Problem, Products};
use crate::hypotheses::group::{Group, Switch};
use crate::recordings::partition::Partition;
use crate::recordings::rows::{JointRows, RecordingRows, Role};

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
    /// The nested columns over the test part, joint by joint.
    tests: Vec<Test>,
    shifts: Vec<OfShift>,
}

/// A nested model fitted to a shifted residual.
struct OfShift {
    train: [Vec<Vec<f64>>; 2],
    test: [Vec<Vec<f64>>; 2],
    forward: Vec<f64>,
    joints: Vec<OfJoint>,
}

/// What it means for a joint: of the nested columns that the joint has …
struct OfJoint {
    /// … the coefficients, …
    beta: Vec<f64>,
    /// … Xᵀ(e − Xβ) over the test part, …
    gradient: Vec<f64>,
    /// … and ‖e − Xβ‖² there.
    squared: f64,
}

/// A shift after which some joint's velocity resembles itself this much (correlation) leaves the residual where it was.
const REPEATS: f64 = 0.5;

/// Pieces that get a sign each, s: long against the memory of the filters, of which f_dyn = 10 Hz makes a tenth of it.
const PIECE_S: f64 = 1.0;

/// How the residual is separated from the columns.
#[derive(Debug, Clone, PartialEq)]
struct Surrogates {
    /// Shifts, as shares of each recording's length.
    shares: Vec<f64>,
    /// Whether pieces get signs, too.
    signed: bool,
}

impl Surrogates {
    /// The shifts after which the motion does not repeat, or, where these are fewer than half of those asked for, all with
    /// signs.
    fn of(recordings: &[RecordingRows], partition: &Partition, count: usize) -> Self {
        let all: Vec<f64> = (0..count).map(|s| (s + 1) as f64 / (count + 1) as f64).collect();
        let apart: Vec<f64> =
            all.par_iter().copied().filter(|share| !repeats(recordings, partition, *share)).collect();
        let signed = 2 * apart.len() < count;
        Self { shares: if signed { all } else { apart }, signed }
    }
}

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

/// What the groups do by chance beside a nested model, under at most `count` surrogates of a residual,
/// `[recording][joint][row]`.
pub(crate) fn by_chance(
    problem: &Problem,
    nested: &[Switch],
    groups: &[Group],
    weights: &[f64],
    residual: (&[RecordingRows], &Partition, &[Vec<Vec<f64>>]),
    count: usize,
) -> Vec<ByChance> {
    let surrogates = Surrogates::of(residual.0, residual.1, count);
    let shifts = surrogates.shares.len();
    let shifted = Shifted::all(residual, &surrogates);
    let places = problem.places(nested);
    let folds: Vec<Fold<'_>> = (0..problem.blocks())
        .into_par_iter()
        .map(|b| Fold::new(problem, b, (nested, &places), weights, &shifted))
        .collect();
    let rows: Vec<f64> = (0..problem.joints()).map(|j| problem.rows(j, false).max(1.0)).collect();
    let mean = |sums: Vec<f64>| sums.iter().zip(&rows).map(|(s, n)| s / n).collect::<Vec<f64>>();
    let errors: Vec<Vec<Vec<f64>>> =
        groups.par_iter().map(|group| of_group(problem, &folds, &places, group, weights, shifts)).collect();
    (0..shifts)
        .map(|s| {
            let sum = |j: usize| folds.iter().map(|fold| fold.shifts[s].joints[j].squared).sum();
            ByChance {
                before: mean((0..problem.joints()).map(sum).collect()),
                after: errors.iter().map(|of_shift| mean(of_shift[s].clone())).collect(),
            }
        })
        .collect()
}

impl Shifted {
    /// The surrogates of a residual.
    fn all(
        (recordings, partition, residual): (&[RecordingRows], &Partition, &[Vec<Vec<f64>>]),
        Surrogates { shares, signed }: &Surrogates,
    ) -> Vec<Self> {
        // The shifted series of a joint, one after the other.
        let turned: Vec<Vec<Vec<f64>>> = recordings
            .par_iter()
            .zip(residual)
            .enumerate()
            .map(|(r, (recording, residual))| {
                let end = fitted_end(partition, r);
                let of_joint = |(joint, series): (&JointRows, &Vec<f64>)| {
                    let of_share = |(s, share): (usize, &f64)| {
                        let by = (share * end as f64).round() as usize;
                        let mut turned = turned(&series[..end], &joint.counts[..end], by);
                        let piece = (PIECE_S * recording.rate_hz).max(1.0) as usize;
                        for (k, piece) in turned.chunks_mut(piece).enumerate().filter(|_| *signed) {
                            if is_turned_over([s, r, k]) {
                                piece.iter_mut().for_each(|v| *v = -*v);
                            }
                        }
                        turned
                    };
                    shares.iter().enumerate().flat_map(of_share).collect()
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
        // `[block][shift]`.
        let blocks: Vec<Vec<[Vec<Product>; 2]>> = partition
            .blocks
            .par_iter()
            .map(|block| {
                let mut parts: Vec<_> = shares.iter().map(|_| zero()).collect();
                for (r, start, end) in block {
                    let kind = usize::from(recordings[*r].role == Role::Target);
                    let length = fitted_end(partition, *r);
                    for (j, joint) in recordings[*r].joints.iter().enumerate() {
                        let (rows, count) = (joint.measurement.len(), columns(j));
                        let products = products_of_columns(
                            (joint.data.get(*start..).unwrap_or_default(), rows, count),
                            (turned[*r][j].get(*start..).unwrap_or_default(), length, shares.len()),
                            end - start,
                        );
                        for (s, part) in parts.iter_mut().enumerate() {
                            let sums = part[kind][j].right.iter_mut();
                            sums.zip(&products[s * count..]).for_each(|(sum, product)| *sum += product);
                            let own = &turned[*r][j][s * length + start..s * length + end];
                            part[kind][j].square += dot(own, own);
                        }
                    }
                }
                parts
            })
            .collect();
        (0..shares.len())
            .map(|s| {
                let parts: Vec<_> = blocks.iter().map(|block| block[s].clone()).collect();
                let mut total = zero();
                for part in &parts {
                    for (sum, own) in total.iter_mut().flatten().zip(part.iter().flatten()) {
                        sum.right.iter_mut().zip(&own.right).for_each(|(s, o)| *s += o);
                        sum.square += own.square;
                    }
                }
                Self { parts, total }
            })
            .collect()
    }
}

impl Product {
    fn zero(columns: usize) -> Self {
        Self { right: vec![0.0; columns], square: 0.0 }
    }
}

/// Whether a piece of a recording has the other sign under a shift: a bit of a hash (the finaliser of SplitMix64; Steele,
/// Lea, Flood 2014), so that results repeat.
fn is_turned_over(place: [usize; 3]) -> bool {
    let mixed = place.iter().fold(0x9e37_79b9_7f4a_7c15_u64, |state, part| {
        let z = state.wrapping_add(*part as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    });
    mixed & 1 == 1
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

/// The product of a column with a shifted residual.
fn measured(rights: &[Vec<Vec<f64>>; 2], joint: usize, column: Place) -> f64 {
    let calibration = if column.target_only { 0.0 } else { rights[0][joint][column.local] };
    calibration + rights[1][joint][column.local]
}

impl<'a> Fold<'a> {
    fn new(
        problem: &'a Problem,
        block: usize,
        (nested, places): (&[Switch], &[Vec<Place>]),
        weights: &[f64],
        shifted: &[Shifted],
    ) -> Self {
        let (train, test) = problem.fold(block);
        let fit = problem.part_fit(train, nested, nested.len(), weights);
        let tests: Vec<Test> = (0..problem.joints()).map(|j| Test::of(test, j, &places[j])).collect();
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
                let joints = tests
                    .iter()
                    .zip(places)
                    .enumerate()
                    .map(|(j, (own, places))| {
                        let beta: Vec<f64> = places.iter().map(|p| beta[p.at]).collect();
                        let image = own.image(&beta);
                        let right = places.iter().map(|p| measured(&test_right, j, *p));
                        let gradient: Vec<f64> = right.zip(&image).map(|(r, i)| r - i).collect();
                        let square = part[0][j].square + part[1][j].square;
                        // −2 rᵀβ + βᵀGβ = −(2 (r − Gβ) + Gβ)ᵀβ.
                        let squared = square - 2.0 * dot(&gradient, &beta) - dot(&image, &beta);
                        OfJoint { beta, gradient, squared: squared.max(0.0) }
                    })
                    .collect();
                OfShift { train: train_right, test: test_right, forward, joints }
            })
            .collect();
        Self { train, test, fit, tests, shifts }
    }
}

/// A group's columns over the rows of one joint in a test part.
struct Tested {
    /// What the nested model makes of them, its columns one after the other.
    taken: Vec<f64>,
    /// Their products with the nested columns.
    beside: Vec<f64>,
    /// The Gram matrix of what is free.
    free: Vec<f64>,
}

/// Squared errors with a group, `[shift][joint]`, over all test parts.
fn of_group(
    problem: &Problem,
    folds: &[Fold<'_>],
    places: &[Vec<Place>],
    group: &Group,
    weights: &[f64],
    shifts: usize,
) -> Vec<Vec<f64>> {
    let own = problem.places(&group.switches);
    let (g, joints) = (group.switches.len(), problem.joints());
    let nonnegative: Vec<bool> = group.switches.iter().map(|s| s.nonnegative).collect();
    let mut sums = vec![vec![0.0; joints]; shifts];
    for fold in folds {
        // The group's columns less what the nested model makes of them on the training part.
        let n = fold.fit.free();
        let (projected, schur, _) =
            problem.extended(fold.train, &fold.fit, places, (n, 0), &group.switches, weights);
        let mut absorbed = projected.clone();
        absorbed.chunks_exact_mut(n.max(1)).for_each(|c| fold.fit.backward(c));
        // A joint that has none of the group's columns, and none of those that share with them, is left as it is.
        let touched = |j: &usize| {
            let taken = || places[*j].iter().any(|p| (0..g).any(|b| absorbed[b * n + p.at] != 0.0));
            !own[*j].is_empty() || taken()
        };
        let (touched, apart): (Vec<usize>, Vec<usize>) = (0..joints).partition(touched);
        let of_joint = |j: &usize| (*j, Tested::new(fold, *j, (&places[*j], &own[*j]), &absorbed, g));
        let tested: Vec<(usize, Tested)> = touched.iter().map(of_joint).collect();
        for (sum, shift) in sums.iter_mut().zip(&fold.shifts) {
            let mut right: Vec<f64> =
                (0..g).map(|k| -dot(&projected[k * n..(k + 1) * n], &shift.forward)).collect();
            for (j, own) in own.iter().enumerate() {
                own.iter().for_each(|p| right[p.at] += weights[j] * measured(&shift.train, j, *p));
            }
            let extension = solve_signed(&schur, &right, &nonnegative);
            apart.iter().for_each(|j| sum[*j] += shift.joints[*j].squared);
            for (j, tested) in &tested {
                let (j, of) = (*j, &shift.joints[*j]);
                let mut inner = vec![0.0; g];
                own[j].iter().for_each(|p| inner[p.at] = measured(&shift.test, j, *p));
                let mut change = 0.0;
                for (b, inner) in inner.iter().enumerate() {
                    let at = b * of.beta.len()..(b + 1) * of.beta.len();
                    let inner = inner
                        - dot(&tested.beside[at.clone()], &of.beta)
                        - dot(&tested.taken[at], &of.gradient);
                    let quadratic = dot(&tested.free[b * g..(b + 1) * g], &extension);
                    change += extension[b] * (quadratic - 2.0 * inner);
                }
                sum[j] += (of.squared + change).max(0.0);
            }
        }
    }
    sums
}

impl Tested {
    fn new(
        fold: &Fold<'_>,
        joint: usize,
        (nested, own): (&[Place], &[Place]),
        absorbed: &[f64],
        g: usize,
    ) -> Self {
        let (n, all) = (nested.len(), fold.fit.free());
        let taken: Vec<f64> =
            (0..g).flat_map(|b| nested.iter().map(move |p| absorbed[b * all + p.at])).collect();
        let mut beside = vec![0.0; n * g];
        let mut free = vec![0.0; g * g];
        for column in own {
            let with = Products::of(fold.test, joint, *column);
            let out = beside[column.at * n..].iter_mut();
            out.zip(nested).for_each(|(o, p)| *o = with.column(*p));
            own.iter().for_each(|p| free[column.at * g + p.at] = with.column(*p));
        }
        let of = |k: usize| k * n..(k + 1) * n;
        for b in 0..g {
            let mut left = fold.tests[joint].image(&taken[of(b)]);
            left.iter_mut().zip(&beside[of(b)]).for_each(|(l, o)| *l -= o);
            for a in 0..g {
                free[b * g + a] += dot(&taken[of(a)], &left) - dot(&taken[of(b)], &beside[of(a)]);
            }
        }
        Self { taken, beside, free }
    }
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
