//! What an extension of a model leaves on blocks of time that it was not fitted to.

use std::sync::OnceLock;

use rayon::prelude::*;

use crate::evidence::gram::{Moments, dot};
use crate::evidence::linear::solve_signed;
use crate::evidence::problem::{PartFit, Place, Problem, Products};
use crate::evidence::total::free_first;
use crate::hypotheses::group::Switch;

/// A model fitted to every training part (all blocks but one), ready to be extended by further groups. Coefficients
/// that may not be negative are not in any part of the fit.
///
/// Hundreds of groups extend one model. What they have in common is kept: the factors of the fit, which signed
/// coefficients are above zero, and the products of its columns over the test parts.
#[derive(Debug)]
pub struct NestedFit {
    /// Those of any sign, then those that may not be negative.
    switches: Vec<Switch>,
    /// Number of the former.
    free: usize,
    weights: Vec<f64>,
    places: Vec<Vec<Place>>,
    folds: Vec<Fold>,
    /// Fitted to everything, and judged on that.
    whole: OnceLock<Fold>,
}

/// Moments of some blocks, `[kind][joint]`.
type Part = [Vec<Moments>; 2];

/// A training part and its test part.
#[derive(Debug)]
struct Fold {
    fit: PartFit,
    /// Which signed coefficients are above zero without any group.
    likely: Vec<bool>,
    /// Joint by joint.
    tests: Vec<Test>,
}

/// Second moments of a joint's rows over a test part: of the model's columns that it has, and of its measurement.
#[derive(Debug)]
pub(super) struct Test {
    gram: Vec<f64>,
    right: Vec<f64>,
    square: f64,
}

impl Problem {
    /// Fits `switches` to every training part.
    pub fn nest(&self, switches: &[Switch], weights: &[f64]) -> NestedFit {
        let (switches, free) = free_first(switches);
        let places = self.places(&switches);
        let fold = |b| Fold::new(self, self.fold(b), (&switches, free), &places, weights);
        let folds = (0..self.blocks()).into_par_iter().map(fold).collect();
        NestedFit { weights: weights.to_vec(), free, places, folds, switches, whole: OnceLock::new() }
    }

    /// Cross-validated squared error of each joint, `[kind][joint]`, of the nested model extended by `group`.
    pub fn held_out(&self, fit: &NestedFit, group: &[Switch]) -> [Vec<f64>; 2] {
        let all: Vec<Switch> = fit.switches.iter().chain(group).copied().collect();
        let mut sums = [vec![0.0; self.joints()], vec![0.0; self.joints()]];
        for (b, fold) in fit.folds.iter().enumerate() {
            let (train, test) = self.fold(b);
            let beta = self.extend_from(train, (&fold.fit, &fold.likely), &fit.places, group, &fit.weights);
            let errors = self.squared_errors(test, &all, &beta);
            for (sum, error) in sums.iter_mut().flatten().zip(errors.iter().flatten()) {
                *sum += error;
            }
        }
        sums
    }

    /// The same over recordings of both kinds.
    pub fn held_out_in_all(&self, fit: &NestedFit, group: &[Switch]) -> Vec<f64> {
        let mut sums = vec![0.0; self.joints()];
        for block in self.held_out_by_block(fit, group) {
            sums.iter_mut().zip(block).for_each(|(sum, error)| *sum += error);
        }
        sums
    }

    /// The same block by block, `[block][joint]`.
    pub(crate) fn held_out_by_block(&self, fit: &NestedFit, group: &[Switch]) -> Vec<Vec<f64>> {
        let own = self.places(group);
        let of_block = |(b, fold): (usize, &Fold)| {
            let mut sums = vec![0.0; self.joints()];
            self.add_errors(fit, (fold, self.fold(b)), (group, &own), &mut sums);
            sums
        };
        fit.folds.iter().enumerate().map(of_block).collect()
    }

    /// Σ_j weight_j Σ d² on each test part, with d the difference of the predictions of the nested model extended by one group and by
    /// another.
    pub(crate) fn apart_by_block(
        &self,
        fit: &NestedFit,
        one: &[Switch],
        other: &[Switch],
        weights: &[f64],
    ) -> Vec<f64> {
        let all: Vec<Switch> = fit.switches.iter().chain(one).chain(other).copied().collect();
        let nested = fit.switches.len();
        let of_block = |(b, fold): (usize, &Fold)| {
            let (train, test) = self.fold(b);
            let extended =
                |group| self.extend_from(train, (&fold.fit, &fold.likely), &fit.places, group, &fit.weights);
            let (of_one, of_other) = (extended(one), extended(other));
            let common = of_one[..nested].iter().zip(&of_other[..nested]).map(|(a, b)| a - b);
            let opposite = of_other[nested..].iter().map(|value| -value);
            let difference: Vec<f64> =
                common.chain(of_one[nested..].iter().copied()).chain(opposite).collect();
            self.quadratic(test, &all, &difference, weights).max(0.0)
        };
        fit.folds.iter().enumerate().map(of_block).collect()
    }

    /// The squared errors of each joint over the rows to which the nested model extended by `group` is fitted.
    pub fn in_sample(&self, fit: &NestedFit, group: &[Switch]) -> Vec<f64> {
        let all = (self.total(), self.total());
        let whole = fit
            .whole
            .get_or_init(|| Fold::new(self, all, (&fit.switches, fit.free), &fit.places, &fit.weights));
        let mut sums = vec![0.0; self.joints()];
        self.add_errors(fit, (whole, all), (group, &self.places(group)), &mut sums);
        sums
    }

    fn add_errors(
        &self,
        fit: &NestedFit,
        (fold, (train, test)): (&Fold, (&Part, &Part)),
        (group, own): (&[Switch], &[Vec<Place>]),
        sums: &mut [f64],
    ) {
        let beta = self.extend_from(train, (&fold.fit, &fold.likely), &fit.places, group, &fit.weights);
        let (nested, extension) = beta.split_at(fit.switches.len());
        for (j, sum) in sums.iter_mut().enumerate() {
            let places = &fit.places[j];
            let values: Vec<f64> = places.iter().map(|p| nested[p.at]).collect();
            let mut error = fold.tests[j].squared_error(&values);
            for column in &own[j] {
                let with = Products::of(test, j, *column);
                let nested: f64 = places.iter().zip(&values).map(|(p, v)| v * with.column(*p)).sum();
                let group: f64 = own[j].iter().map(|p| extension[p.at] * with.column(*p)).sum();
                error += extension[column.at] * (group + 2.0 * (nested - with.measurement()));
            }
            *sum += error.max(0.0);
        }
    }
}

impl Fold {
    fn new(
        problem: &Problem,
        (train, test): (&Part, &Part),
        (switches, free): (&[Switch], usize),
        places: &[Vec<Place>],
        weights: &[f64],
    ) -> Self {
        let fit = problem.part_fit(train, switches, free, weights);
        let signed = solve_signed(&fit.schur, &fit.right, &vec![true; switches.len() - free]);
        Self {
            likely: signed.iter().map(|value| *value > 0.0).collect(),
            tests: places.iter().enumerate().map(|(j, places)| Test::of(test, j, places)).collect(),
            fit,
        }
    }
}

impl Test {
    pub(super) fn of(part: &Part, joint: usize, places: &[Place]) -> Self {
        let products: Vec<Products<'_>> = places.iter().map(|p| Products::of(part, joint, *p)).collect();
        Self {
            gram: products.iter().flat_map(|with| places.iter().map(|p| with.column(*p))).collect(),
            right: products.iter().map(Products::measurement).collect(),
            square: part[0][joint].square + part[1][joint].square,
        }
    }

    /// XᵀXβ.
    pub(super) fn image(&self, beta: &[f64]) -> Vec<f64> {
        self.gram.chunks_exact(beta.len().max(1)).map(|column| dot(column, beta)).collect()
    }

    /// ‖y − Xβ‖².
    fn squared_error(&self, beta: &[f64]) -> f64 {
        let n = beta.len();
        let mut error = self.square;
        for (k, value) in beta.iter().enumerate() {
            let column = &self.gram[k * n..(k + 1) * n];
            error += value * (2.0 * (dot(&column[..k], &beta[..k]) - self.right[k]) + column[k] * value);
        }
        error
    }
}
