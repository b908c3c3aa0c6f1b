use nalgebra::DMatrix;

/// Ratio of the largest to the smallest singular value of a square matrix, column-major; infinite where the matrix
/// is singular as far as numbers of 53 bits tell, NaN where it is empty or not finite.
///
/// The decomposition is nalgebra's, which chooses no instructions at run time: the same matrix gives the same bits on
/// every machine.
#[must_use]
pub fn condition_number(matrix: &[f64], n: usize) -> f64 {
    if n == 0 || matrix.iter().any(|v| !v.is_finite()) {
        return f64::NAN;
    }
    let values = DMatrix::from_column_slice(n, n, matrix).singular_values();
    let (largest, smallest) = (values.max(), values.min());
    if smallest <= f64::EPSILON * largest { f64::INFINITY } else { largest / smallest }
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
