use aurt_traits::Dispatch;

use crate::dense::bidiagonal;

/// Halvings of the interval on a logarithmic scale; enough for a singular value to some 1e-12 of itself.
const HALVINGS: usize = 60;

/// Singular values below this share of the largest are zero as far as numbers of 53 bits tell.
const SMALLEST: f64 = 1e-30;

/// Ratio of the largest to the smallest singular value of a square matrix, column-major; infinite where the matrix
/// is singular, NaN where it is empty.
///
/// Reflections from both sides leave a bidiagonal matrix B (Golub and Kahan, 1965). Its singular values are the
/// positive eigenvalues of a tridiagonal matrix with zero diagonal and the entries of B beside it, counted by
/// Sturm sequences. Everything is done in one order, so that the same matrix gives the same bits at the baseline.
pub(crate) fn condition_number(matrix: &[f64], n: usize) -> f64 {
    if n == 0 {
        return f64::NAN;
    }
    let mut beside = vec![0.0; 2 * n - 1];
    bidiagonal(Dispatch::active(), &mut matrix.to_vec(), n, &mut beside);
    // No eigenvalue is larger than the largest row sum of magnitudes (Gershgorin).
    let before = std::iter::once(&0.0).chain(&beside);
    let after = beside.iter().chain(std::iter::once(&0.0));
    let bound = before.zip(after).map(|(a, b)| a.abs() + b.abs()).fold(0.0, f64::max);
    if bound == 0.0 {
        return f64::INFINITY;
    }
    // Every singular value is an eigenvalue of either sign; below a positive x all n negative ones lie.
    if counts_below(&beside, [SMALLEST * bound], bound)[0] > n {
        return f64::INFINITY;
    }
    // The smallest and the largest are searched side by side: each step waits for its divisions, and two chains of them
    // take no longer than one.
    let mut ranges = [(SMALLEST * bound, 2.0 * bound); 2];
    for _ in 0..HALVINGS {
        let middles = ranges.map(|(low, high)| (low * high).sqrt());
        let counts = counts_below(&beside, middles, bound);
        for (((low, high), middle), (count, wanted)) in
            ranges.iter_mut().zip(middles).zip(counts.into_iter().zip([1, n]))
        {
            *(if count.saturating_sub(n) >= wanted { high } else { low }) = middle;
        }
    }
    let [smallest, largest] = ranges.map(|(low, high)| (low * high).sqrt());
    largest / smallest
}

/// For each x the eigenvalues below it of the symmetric tridiagonal matrix with zero diagonal and `beside` next to it.
fn counts_below<const N: usize>(beside: &[f64], x: [f64; N], bound: f64) -> [usize; N] {
    let least = f64::MIN_POSITIVE * bound.max(1.0) / f64::EPSILON;
    let mut pivots = x.map(|x| -x);
    let mut counts = pivots.map(|pivot| usize::from(pivot < 0.0));
    for b in beside {
        let square = b * b;
        for k in 0..N {
            if pivots[k].abs() < least {
                pivots[k] = -least;
            }
            pivots[k] = -x[k] - square / pivots[k];
            counts[k] += usize::from(pivots[k] < 0.0);
        }
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_matrices() {
        assert!(condition_number(&[], 0).is_nan());
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
