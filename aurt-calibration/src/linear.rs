//! Dense algebra behind the fold, by `faer` on one thread.
//!
//! Matrices are `nalgebra`'s, whose storage is column-major without gaps, as `faer` reads it. `faer` chooses its instructions
//! at run time, so that last bits of what comes from here depend on the processor; coefficients and predictions of
//! least squares do not come from here (docs/decisions/0003).
//!
//! Every function returns `None` where the matrix is not finite, or singular.

use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::solvers::{Llt, Solve};
use faer::{Accum, MatMut, MatRef, Par, Side};
use nalgebra::{DMatrix, DVector};

/// The Cholesky factor of a positive definite matrix.
pub(crate) struct Cholesky(Llt<f64>);

impl Cholesky {
    pub(crate) fn of(matrix: &DMatrix<f64>) -> Option<Self> {
        Llt::new(seen(matrix), Side::Lower).ok().map(Self)
    }

    pub(crate) fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        let (mut found, n) = (right.clone(), right.len());
        self.0.solve_in_place(MatMut::from_column_major_slice_mut(found.as_mut_slice(), n, 1));
        found
    }
}

pub(crate) fn gram(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let (of, n) = (seen(matrix), matrix.ncols());
    let (lower, whole) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
    let mut gram = DMatrix::zeros(n, n);
    matmul(written(&mut gram), lower, Accum::Replace, of.transpose(), whole, of, whole, 1.0, Par::Seq);
    gram.fill_upper_triangle_with_lower_triangle();
    gram
}

pub(crate) fn singular_values(matrix: &DMatrix<f64>) -> Option<Vec<f64>> {
    is_finite(matrix).then(|| seen(matrix).singular_values().ok())?
}

/// U, singular values and V of a matrix with at least as many rows as columns, M = U diag(values) Vᵀ.
pub(crate) fn singular_vectors(matrix: &DMatrix<f64>) -> Option<(DMatrix<f64>, DVector<f64>, DMatrix<f64>)> {
    let svd = is_finite(matrix).then(|| seen(matrix).thin_svd().ok())??;
    let values = svd.S().column_vector();
    Some((taken(svd.U()), DVector::from_iterator(values.nrows(), values.iter().copied()), taken(svd.V())))
}

/// U⁻¹ B of an upper triangle U.
pub(crate) fn solve_upper(upper: &DMatrix<f64>, right: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let mut found = right.clone();
    seen(upper).solve_upper_triangular_in_place(written(&mut found));
    Some(found).filter(is_finite)
}

/// Ratio of the largest to the smallest singular value of a square matrix, column-major; infinite where the matrix
/// is singular as far as numbers of 53 bits tell, NaN where it is empty or not finite.
pub fn condition_number(matrix: &[f64], n: usize) -> f64 {
    let values = if n == 0 { None } else { singular_values(&DMatrix::from_column_slice(n, n, matrix)) };
    match values.unwrap_or_default().as_slice() {
        [] => f64::NAN,
        [largest, .., smallest] if *smallest > f64::EPSILON * largest => largest / smallest,
        [only] if *only > 0.0 => 1.0,
        _ => f64::INFINITY,
    }
}

fn is_finite(matrix: &DMatrix<f64>) -> bool {
    matrix.iter().all(|v| v.is_finite())
}

fn seen(matrix: &DMatrix<f64>) -> MatRef<'_, f64> {
    MatRef::from_column_major_slice(matrix.as_slice(), matrix.nrows(), matrix.ncols())
}

fn written(matrix: &mut DMatrix<f64>) -> MatMut<'_, f64> {
    let (rows, columns) = matrix.shape();
    MatMut::from_column_major_slice_mut(matrix.as_mut_slice(), rows, columns)
}

fn taken(matrix: MatRef<'_, f64>) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.nrows(), matrix.ncols(), |r, c| matrix[(r, c)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_matrices() {
        assert!(condition_number(&[], 0).is_nan() && condition_number(&[f64::NAN], 1).is_nan());
        assert_eq!(condition_number(&[0.0], 1), f64::INFINITY);
        assert_eq!(condition_number(&[1.0, 0.0, 1.0, 0.0], 2), f64::INFINITY);
        // Kahan's triangle diag(1, s, …) (I − c · strict upper), of order 3 with s = 0.6, c = 0.8; numpy.linalg.cond.
        let kahan = [1.0, 0.0, 0.0, -0.8, 0.6, 0.0, -0.8, -0.48, 0.36];
        assert!((condition_number(&kahan, 3) / 8.649_776_548_889_855 - 1.0).abs() < 1e-11);
        // Singular values of an upper triangle of ones are 1 / (2 sin((2k − 1)π / (4n + 2))).
        let n: usize = 40;
        let ones: Vec<f64> = (0..n * n).map(|i| f64::from(u8::from(i % n <= i / n))).collect();
        let angle = std::f64::consts::PI / (4 * n + 2) as f64;
        let expected = ((2 * n - 1) as f64 * angle).sin() / angle.sin();
        assert!((condition_number(&ones, n) / expected - 1.0).abs() < 1e-11);
        let scaled: Vec<f64> = ones.iter().map(|v| v * 1e-9).collect();
        assert!((condition_number(&scaled, n) / expected - 1.0).abs() < 1e-11);
    }
}
