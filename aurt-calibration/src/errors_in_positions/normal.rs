//! Normal equations, where noise changes them.

use nalgebra::{DMatrix, DVector};

use crate::{System, linear::Cholesky};

/// A = WᵀΩ⁻¹W and c = WᵀΩ⁻¹y.
#[derive(Clone)]
pub(super) struct Normal {
    matrix: DMatrix<f64>,
    right: DVector<f64>,
}

impl Normal {
    pub(super) fn of(system: &System, weights: &[f64]) -> Self {
        let n = system.coefficients();
        let (mut matrix, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for (factor, weight) in system.factors().iter().zip(weights) {
            let (r, columns) = (factor.triangle(), factor.columns());
            let size = columns.len() + 1;
            let column = |k: usize| &r[k * size..(k + 1) * size];
            let dot = |a: usize, b: usize| -> f64 {
                weight * weight * column(a).iter().zip(column(b)).map(|(x, y)| x * y).sum::<f64>()
            };
            for (a, first) in columns.iter().enumerate() {
                right[*first] += dot(a, size - 1);
                for (b, second) in columns.iter().enumerate() {
                    matrix[(*first, *second)] += dot(a, b);
                }
            }
        }
        Self { matrix, right }
    }

    pub(super) fn add(&mut self, other: &Self, factor: f64) {
        self.matrix += factor * &other.matrix;
        self.right += factor * &other.right;
    }

    /// ζ and A⁻¹ over the excited coefficients; `None` unless A is positive definite.
    pub(super) fn solve(&self, excited: &[bool]) -> Option<(Vec<f64>, Vec<f64>)> {
        let kept: Vec<usize> = (0..excited.len()).filter(|k| excited[*k]).collect();
        let inverse = inverse_over(&self.matrix, &kept)?;
        Some(((&inverse * &self.right).as_slice().to_vec(), inverse.as_slice().to_vec()))
    }
}

/// The inverse over the columns that are kept, zero elsewhere; `None` unless it is positive definite there.
pub(super) fn inverse_over(matrix: &DMatrix<f64>, kept: &[usize]) -> Option<DMatrix<f64>> {
    let scale: Vec<f64> = kept.iter().map(|k| matrix[(*k, *k)].sqrt()).collect();
    if scale.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
        return None;
    }
    let at = |a: usize, b: usize| matrix[(kept[a], kept[b])] / (scale[a] * scale[b]);
    let inverse = Cholesky::of(&DMatrix::from_fn(kept.len(), kept.len(), at))?.inverse();
    let mut full = DMatrix::zeros(matrix.nrows(), matrix.ncols());
    for (a, first) in kept.iter().enumerate() {
        for (b, second) in kept.iter().enumerate() {
            full[(*first, *second)] = inverse[(a, b)] / (scale[a] * scale[b]);
        }
    }
    Some(full)
}
