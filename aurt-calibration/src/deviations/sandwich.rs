use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::autoregression::{Autocovariance, Autoregression};
use super::clusters::factors;
use crate::rows::{JointRows, Observed, Piece};
use crate::{CalibrationError, JointFactor};

/// Recordings are cut into stretches until there are about this many clusters.
const CLUSTERS: usize = 8;
const SHORTEST: usize = 40;

pub(crate) type RowWeight<'a> = &'a (dyn Fn(usize, f64) -> f64 + Sync);

/// A fit whose covariance is sought.
#[derive(Clone, Copy)]
pub(crate) struct Sandwich<'a> {
    pub rows: Observed<'a>,
    pub coefficients: &'a [f64],
    /// The fit's weights, 1/σ_j.
    pub weights: &'a [f64],
    /// (WᵀΩ⁻¹W)⁻¹ with these weights, column-major.
    pub bread: &'a [f64],
    /// For estimates with weights by row.
    pub row_weight: Option<RowWeight<'a>>,
    /// What was fitted, where that is not the coefficients themselves; `bread` is over this then.
    pub lift: Option<&'a Lift>,
}

/// Quantities that were fitted: the rows of joint j turn with them as W_j B_j.
pub(crate) struct Lift {
    /// B_jᵀ, quantities × coefficients.
    pub transposed: Vec<DMatrix<f64>>,
    /// Quantities whose deviations widen together where the model misfits.
    pub groups: Vec<Range<usize>>,
}

impl Sandwich<'_> {
    /// What turns with the fitted quantities instead of the coefficients.
    fn lifted(&self, joint: usize, of_coefficients: DMatrix<f64>) -> DMatrix<f64> {
        match self.lift {
            Some(lift) => product(&lift.transposed[joint], &of_coefficients),
            None => of_coefficients,
        }
    }

    fn groups(&self) -> Vec<Range<usize>> {
        let of_model = || self.rows.model.groups().iter().map(|(_, range)| range.clone()).collect();
        self.lift.map_or_else(of_model, |lift| lift.groups.clone())
    }

    /// The covariance of the coefficients, column-major.
    pub(crate) fn covariance(&self) -> Result<Vec<f64>, CalibrationError> {
        let Self { rows: observed, coefficients, weights, bread, .. } = *self;
        let model = observed.model;
        let n = coefficients.len();
        let pieces = observed.pieces();
        let mut rows = observed.rows(&pieces, coefficients)?;
        if let Some(weight) = self.row_weight {
            for (joint, row) in rows.iter_mut().flat_map(|joints| joints.iter_mut().enumerate()) {
                row.residual.iter_mut().for_each(|e| *e *= weight(joint, *e));
            }
        }
        let size = self.lift.and_then(|lift| lift.transposed.first()).map_or(n, DMatrix::nrows);
        let bread = DMatrix::from_column_slice(size, size, bread);

        let parts: Vec<DMatrix<f64>> = (0..model.joints())
            .into_par_iter()
            .map(|joint| {
                let (mut memory, mut shown) = (Autocovariance::default(), 0.0);
                for (piece, rows) in pieces.iter().zip(&rows).filter(|(_, r)| !r.is_empty()) {
                    memory.add(&rows[joint].residual, rows[joint].counted);
                    shown += piece.times * rows[joint].residual.iter().map(|e| e * e).sum::<f64>();
                }
                let noise = memory.fit();
                let columns = model.row_columns(joint);
                let mut factor = JointFactor::new(columns.to_vec());
                for (piece, rows) in pieces.iter().zip(&rows).filter(|(_, r)| !r.is_empty()) {
                    fold(&mut factor, &rows[joint], &noise, piece.times);
                }
                // Rows of A⁻¹ S Cᵀ: what each unit of independent noise moves.
                let middle = self.lifted(joint, root_of_gram(&factor, n));
                let pulled = product(&bread, &middle);
                // The fit took up part of the noise, and the residual shows the rest.
                let taken: f64 = middle.iter().zip(pulled.iter()).map(|(m, p)| m * p).sum::<f64>()
                    * weights[joint].powi(2)
                    * noise.innovation;
                let moved = pulled * (weights[joint].powi(2) * noise.innovation.sqrt());
                let share = if shown > 0.0 { taken / (shown + taken) } else { 0.0 };
                let covariance = product(&moved, &moved.transpose());
                covariance / (1.0 - share.clamp(0.0, 0.9))
            })
            .collect();
        let mut covariance = parts.into_iter().fold(DMatrix::zeros(size, size), |sum, part| sum + part);

        let steps = self.steps(&pieces, &rows, &bread);
        let groups = self.groups();
        let mut deviation = DVector::from_element(size, 1.0);
        for (group, factor) in groups.iter().zip(factors(&steps, &covariance, &groups)) {
            group.clone().for_each(|k| deviation[k] = factor.sqrt());
        }
        for c in 0..size {
            for r in 0..size {
                covariance[(r, c)] *= deviation[r] * deviation[c];
            }
        }
        if covariance.iter().all(|v| v.is_finite()) {
            Ok(covariance.as_slice().to_vec())
        } else {
            Err(CalibrationError::NotFinite)
        }
    }

    /// A⁻¹ g of each cluster: recordings, cut into stretches where they are few.
    fn steps(
        &self,
        pieces: &[Piece<'_>],
        rows: &[Vec<JointRows>],
        bread: &DMatrix<f64>,
    ) -> Vec<DVector<f64>> {
        let n = self.coefficients.len();
        let total: usize = rows.iter().filter_map(|r| r.first()).map(|r| r.residual.len()).sum();
        let length = total.div_ceil(CLUSTERS).max(SHORTEST);
        let mut steps = Vec::new();
        for (piece, rows) in pieces.iter().zip(rows).filter(|(_, r)| !r.is_empty()) {
            let count = rows[0].residual.len();
            let parts = (count as f64 / length as f64).round().max(1.0) as usize;
            for part in 0..parts {
                let range = part * count / parts..(part + 1) * count / parts;
                let mut total = DVector::zeros(bread.nrows());
                for (joint, rows) in rows.iter().enumerate() {
                    let mut score = DMatrix::zeros(n, 1);
                    let weight = piece.times * self.weights[joint].powi(2);
                    let left = &rows.residual[range.clone()];
                    for (column, values) in self.rows.model.row_columns(joint).iter().zip(&rows.columns) {
                        let product: f64 = values[range.clone()].iter().zip(left).map(|(w, e)| w * e).sum();
                        score[*column] += weight * product;
                    }
                    total += self.lifted(joint, score).column(0);
                }
                steps.push(bread * total);
            }
        }
        steps
    }
}

/// Rᵀ of a factor's triangle over all `n` coefficients, n × columns, so that Rᵀ R is the Gram matrix of the joint's columns.
pub(crate) fn root_of_gram(factor: &JointFactor, n: usize) -> DMatrix<f64> {
    let (triangle, columns) = (factor.triangle(), factor.columns());
    let mut root = DMatrix::zeros(n, columns.len());
    for (k, column) in columns.iter().enumerate() {
        for row in 0..=k {
            root[(*column, row)] = triangle[k * (columns.len() + 1) + row];
        }
    }
    root
}

/// A product in one order of operations, so that the baseline gives the same bits on every machine.
pub(crate) fn product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut result = DMatrix::zeros(a.nrows(), b.ncols());
    for (mut to, from) in result.column_iter_mut().zip(b.column_iter()) {
        for (column, factor) in a.column_iter().zip(from.iter()).filter(|(_, f)| **f != 0.0) {
            to.iter_mut().zip(column.iter()).for_each(|(t, v)| *t += factor * v);
        }
    }
    result
}

fn fold(factor: &mut JointFactor, rows: &JointRows, noise: &Autoregression, times: f64) {
    let length = rows.residual.len() + noise.longer();
    let mut coloured = vec![Vec::new(); rows.columns.len()];
    for (column, out) in rows.columns.iter().zip(&mut coloured) {
        noise.coloured(column, out);
        if times != 1.0 {
            out.iter_mut().for_each(|v| *v *= times);
        }
    }
    factor.push(|k| &coloured[k], &vec![0.0; length], |_| true);
}
