/// Halvings of the interval on a logarithmic scale; enough for a singular value to some 1e-12 of itself.
const HALVINGS: usize = 60;

/// Singular values below this share of the largest are zero as far as numbers of 53 bits tell.
const SMALLEST: f64 = 1e-30;

/// Ratio of the largest to the smallest singular value of a square matrix, column-major; infinite where the matrix
/// is singular, NaN where it is empty.
///
/// Reflections from both sides leave a bidiagonal matrix B (Golub and Kahan, 1965). Its singular values are the
/// positive eigenvalues of a tridiagonal matrix with zero diagonal and the entries of B beside it, counted by
/// Sturm sequences. Everything is done in one order, so that the same matrix gives the same bits everywhere.
pub(crate) fn condition_number(matrix: &[f64], n: usize) -> f64 {
    if n == 0 {
        return f64::NAN;
    }
    let beside = bidiagonal(matrix.to_vec(), n);
    // No eigenvalue is larger than the largest row sum of magnitudes (Gershgorin).
    let before = std::iter::once(&0.0).chain(&beside);
    let after = beside.iter().chain(std::iter::once(&0.0));
    let bound = before.zip(after).map(|(a, b)| a.abs() + b.abs()).fold(0.0, f64::max);
    if bound == 0.0 {
        return f64::INFINITY;
    }
    // Every singular value is an eigenvalue of either sign; below a positive x all n negative ones lie.
    let below = |x: f64| count_below(&beside, x, bound).saturating_sub(n);
    if below(SMALLEST * bound) > 0 {
        return f64::INFINITY;
    }
    let search = |wanted: usize| {
        let (mut low, mut high) = (SMALLEST * bound, 2.0 * bound);
        for _ in 0..HALVINGS {
            let middle = (low * high).sqrt();
            if below(middle) >= wanted { high = middle } else { low = middle }
        }
        (low * high).sqrt()
    };
    search(n) / search(1)
}

/// The entries of the bidiagonal matrix that reflections from both sides leave: d_0, e_0, d_1, e_1, …, d_{n−1}.
fn bidiagonal(mut a: Vec<f64>, n: usize) -> Vec<f64> {
    let mut entries = Vec::with_capacity(2 * n - 1);
    let mut row = vec![0.0; n];
    let mut along = vec![0.0; n];
    for k in 0..n {
        let (left, right) = a.split_at_mut((k + 1) * n);
        let column = &mut left[k * n + k..];
        let (diagonal, tau) = reflector(column);
        entries.push(diagonal);
        for other in right.chunks_exact_mut(n) {
            let other = &mut other[k..];
            let projection = tau * column.iter().zip(&*other).map(|(v, o)| v * o).sum::<f64>();
            other.iter_mut().zip(&*column).for_each(|(o, v)| *o -= projection * v);
        }
        if k + 1 == n {
            break;
        }
        let row = &mut row[k + 1..];
        row.iter_mut().zip(right.chunks_exact(n)).for_each(|(r, column)| *r = column[k]);
        let (beside, tau) = reflector(row);
        entries.push(beside);
        let along = &mut along[k + 1..];
        along.fill(0.0);
        for (v, column) in row.iter().zip(right.chunks_exact(n)) {
            along.iter_mut().zip(&column[k + 1..]).for_each(|(s, c)| *s += tau * v * c);
        }
        for (v, column) in row.iter().zip(right.chunks_exact_mut(n)) {
            column[k + 1..].iter_mut().zip(&*along).for_each(|(c, s)| *c -= v * s);
        }
    }
    entries
}

/// Turns x into the v of the reflection I − τ v vᵀ that leaves of x its first component, and returns that and τ.
fn reflector(x: &mut [f64]) -> (f64, f64) {
    let length = x.iter().map(|v| v * v).sum::<f64>().sqrt();
    let Some(first) = x.first_mut() else { return (0.0, 0.0) };
    if length == 0.0 {
        return (0.0, 0.0);
    }
    let alpha = *first;
    let beta = -length.copysign(alpha);
    *first = 1.0;
    x[1..].iter_mut().for_each(|v| *v /= alpha - beta);
    (beta, (beta - alpha) / beta)
}

/// Eigenvalues below x of the symmetric tridiagonal matrix with zero diagonal and `beside` next to it.
fn count_below(beside: &[f64], x: f64, bound: f64) -> usize {
    let least = f64::MIN_POSITIVE * bound.max(1.0) / f64::EPSILON;
    let mut pivot = -x;
    let mut count = usize::from(pivot < 0.0);
    for b in beside {
        if pivot.abs() < least {
            pivot = -least;
        }
        pivot = -x - b * b / pivot;
        count += usize::from(pivot < 0.0);
    }
    count
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
