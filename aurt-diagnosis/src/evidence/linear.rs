//! Small dense solves on second moments, tolerant of columns that the data do not excite.

use crate::evidence::gram::dot;

/// Relative pivot below which a column counts as dependent on those before it. Moments square the condition
/// number, so this corresponds to a share of 1e-5 of the column's length.
const PIVOT_TOLERANCE: f64 = 1e-10;

/// Cholesky factor L (lower, column-major) of a positive semidefinite matrix whose dependent columns are
/// skipped: they get a zero solution.
#[derive(Debug, Clone)]
pub(crate) struct Cholesky {
    n: usize,
    lower: Vec<f64>,
    /// One over the diagonal of L.
    reciprocal: Vec<f64>,
    used: Vec<bool>,
}

impl Cholesky {
    /// Factorises a symmetric matrix, column-major n × n.
    pub(crate) fn new(matrix: &[f64], n: usize) -> Self {
        Self::of(matrix.to_vec(), n)
    }

    /// The same in the place of the matrix.
    fn of(mut lower: Vec<f64>, n: usize) -> Self {
        let mut used = vec![true; n];
        let mut reciprocal = vec![0.0; n];
        let diagonal: Vec<f64> = (0..n).map(|k| lower[k * n + k]).collect();
        for k in 0..n {
            let original = diagonal[k];
            let pivot = lower[k * n + k];
            if pivot <= PIVOT_TOLERANCE * original || !original.is_normal() {
                used[k] = false;
                lower[k * n + k..(k + 1) * n].fill(0.0);
                continue;
            }
            let root = pivot.sqrt();
            reciprocal[k] = root.recip();
            lower[k * n + k] = root;
            lower[k * n + k + 1..(k + 1) * n].iter_mut().for_each(|v| *v *= reciprocal[k]);
            let (left, right) = lower.split_at_mut((k + 1) * n);
            let column = &left[k * n..];
            for (offset, target) in right.chunks_exact_mut(n).enumerate() {
                let l = k + 1 + offset;
                let factor = column[l];
                if factor != 0.0 {
                    for (t, c) in target[l..].iter_mut().zip(&column[l..]) {
                        *t -= factor * c;
                    }
                }
            }
        }
        Self { n, lower, reciprocal, used }
    }

    /// Whether each column is independent of those before it.
    pub(crate) fn used(&self) -> &[bool] {
        &self.used
    }

    /// Solves L x = b in place.
    pub(crate) fn forward(&self, b: &mut [f64]) {
        for k in 0..self.n {
            if !self.used[k] {
                b[k] = 0.0;
                continue;
            }
            // Columns of joints that do not interact stay zero.
            if b[k] == 0.0 {
                continue;
            }
            b[k] *= self.reciprocal[k];
            let (value, column) = (b[k], &self.lower[k * self.n + k + 1..(k + 1) * self.n]);
            for (x, l) in b[k + 1..].iter_mut().zip(column) {
                *x -= value * l;
            }
        }
    }

    /// Solves Lᵀ x = b in place.
    pub(crate) fn backward(&self, b: &mut [f64]) {
        for k in (0..self.n).rev() {
            if !self.used[k] {
                b[k] = 0.0;
                continue;
            }
            let column = &self.lower[k * self.n + k + 1..(k + 1) * self.n];
            b[k] = (b[k] - dot(column, &b[k + 1..])) * self.reciprocal[k];
        }
    }

    /// Solves L Lᵀ x = b.
    pub(crate) fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut x = b.to_vec();
        self.forward(&mut x);
        self.backward(&mut x);
        x
    }
}

/// A gradient below this share of the largest entry of the scaled right side is zero.
const ZERO_GRADIENT: f64 = 1e-9;

/// Least squares on moments, Sβ = c, with some entries of β held to be ≥ 0: the minimum of ½βᵀSβ − cᵀβ under these
/// signs. Active sets in units of the columns' lengths, so that the answer does not depend on the units of the
/// coefficients (Lawson and Hanson 1974, chapter 23, begun with all columns in).
pub(crate) fn solve_signed(matrix: &[f64], right: &[f64], nonnegative: &[bool]) -> Vec<f64> {
    solve_signed_from(matrix, right, nonnegative, vec![true; right.len()])
}

/// The same, begun with some columns in. A good guess saves most of the work, and any has the same answer.
pub(crate) fn solve_signed_from(
    matrix: &[f64],
    right: &[f64],
    nonnegative: &[bool],
    mut passive: Vec<bool>,
) -> Vec<f64> {
    let n = right.len();
    if let ([length], [right], [nonnegative]) = (matrix, right, nonnegative) {
        let value = if length.is_normal() && *length > 0.0 { right / length } else { 0.0 };
        return vec![if *nonnegative { value.max(0.0) } else { value }];
    }
    let scale: Vec<f64> = (0..n)
        .map(|k| if matrix[k * n + k].is_normal() { matrix[k * n + k].sqrt().recip() } else { 0.0 })
        .collect();
    let mut scaled = matrix.to_vec();
    for (column, own) in scaled.chunks_exact_mut(n.max(1)).zip(&scale) {
        column.iter_mut().zip(&scale).for_each(|(value, other)| *value *= own * other);
    }
    let target: Vec<f64> = right.iter().zip(&scale).map(|(r, s)| r * s).collect();
    let zero = ZERO_GRADIENT * target.iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    let mut x = vec![0.0; n];
    // Every pass of the outer loop lowers the error; the bound only ends what rounding would let run in circles.
    for _ in 0..3 * n + 3 {
        loop {
            let wanted = solve_among(&scaled, &target, &passive);
            let wrong = |k: &usize| passive[*k] && nonnegative[*k] && wanted[*k] < 0.0;
            let reach = |k: usize| x[k] / (x[k] - wanted[k]);
            let first = (0..n).filter(wrong).min_by(|a, b| reach(*a).total_cmp(&reach(*b)));
            let step = first.map_or(1.0, reach);
            x.iter_mut().zip(&wanted).for_each(|(x, w)| *x += step * (w - *x));
            let Some(first) = first else { break };
            for k in 0..n {
                if k == first || passive[k] && nonnegative[k] && wanted[k] < 0.0 && x[k] <= 0.0 {
                    passive[k] = false;
                    x[k] = 0.0;
                }
            }
        }
        let gradient = |k: usize| target[k] - dot(&scaled[k * n..(k + 1) * n], &x);
        let best = (0..n)
            .filter(|k| !passive[*k])
            .map(|k| (k, gradient(k)))
            .filter(|(_, g)| *g > zero)
            .max_by(|a, b| a.1.total_cmp(&b.1));
        match best {
            Some((k, _)) => passive[k] = true,
            None => break,
        }
    }
    x.iter().zip(&scale).map(|(x, s)| x * s).collect()
}

/// The solution with all but some columns left out; zero for those.
fn solve_among(matrix: &[f64], right: &[f64], used: &[bool]) -> Vec<f64> {
    let n = right.len();
    let active: Vec<usize> = (0..n).filter(|k| used[*k]).collect();
    let mut reduced = Vec::with_capacity(active.len() * active.len());
    for b in &active {
        let column = &matrix[b * n..(b + 1) * n];
        reduced.extend(active.iter().map(|a| column[*a]));
    }
    let reduced_right: Vec<f64> = active.iter().map(|a| right[*a]).collect();
    let mut full = vec![0.0; n];
    for (a, value) in active.iter().zip(Cholesky::of(reduced, active.len()).solve(&reduced_right)) {
        full[*a] = value;
    }
    full
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_and_skips_what_depends() {
        // Columns 0 and 1 independent, column 2 = column 0.
        let matrix = [4.0, 2.0, 4.0, 2.0, 3.0, 2.0, 4.0, 2.0, 4.0];
        let cholesky = Cholesky::new(&matrix, 3);
        assert_eq!(cholesky.used(), [true, true, false]);
        let x = cholesky.solve(&[8.0, 7.0, 8.0]);
        assert!((x[0] - 1.25).abs() < 1e-12 && (x[1] - 1.5).abs() < 1e-12 && x[2] == 0.0, "{x:?}");
    }

    #[test]
    fn a_negative_coefficient_that_may_not_be_is_left_out() {
        let matrix = [4.0, 0.0, 0.0, 4.0];
        assert_eq!(solve_signed(&matrix, &[-4.0, 8.0], &[true, true]), [0.0, 2.0]);
        assert_eq!(solve_signed(&matrix, &[-4.0, 8.0], &[false, true]), [-1.0, 2.0]);
    }

    /// Whether no feasible direction lowers the error.
    fn is_minimum(matrix: &[f64], right: &[f64], nonnegative: &[bool], x: &[f64]) -> bool {
        let n = right.len();
        (0..n).all(|k| {
            let gradient = right[k] - (0..n).map(|i| matrix[k * n + i] * x[i]).sum::<f64>();
            let length = matrix[k * n + k].sqrt();
            if nonnegative[k] && x[k] == 0.0 {
                gradient <= 1e-6 * length
            } else {
                gradient.abs() <= 1e-6 * length && (x[k] > 0.0 || !nonnegative[k])
            }
        })
    }

    #[test]
    fn a_column_left_out_too_early_comes_back() {
        // Without column 1, which has to go, column 0 is positive; the most negative one in units of the
        // coefficients is another one.
        let (rows, right) = ([[1.0, 0.9, 0.1], [0.9, 1.0, 0.3], [0.1, 0.3, 1.0]], [0.2, -0.1, 0.5]);
        for scale in [[1.0, 1.0, 1.0], [1e3, 1.0, 1e-3], [1e-4, 1e4, 1.0]] {
            let matrix: Vec<f64> = (0..9).map(|i| rows[i / 3][i % 3] * scale[i / 3] * scale[i % 3]).collect();
            let right: Vec<f64> = right.iter().zip(scale).map(|(r, s)| r * s).collect();
            let x = solve_signed(&matrix, &right, &[true; 3]);
            assert!(is_minimum(&matrix, &right, &[true; 3], &x), "{scale:?} {x:?}");
        }
    }

    proptest::proptest! {
        #[test]
        fn signs_hold_and_the_error_is_least(
            values in proptest::collection::vec(-1.0..1.0_f64, 40),
            units in proptest::collection::vec(-3.0..3.0_f64, 5),
            signed in proptest::collection::vec(proptest::bool::ANY, 5),
        ) {
            // Seven rows of five columns and a measurement.
            let column = |k: usize| -> Vec<f64> {
                values[k * 7..(k + 1) * 7].iter().map(|v| v * 10f64.powf(units[k])).collect()
            };
            let y = &values[33..40];
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
            let matrix: Vec<f64> = (0..25).map(|i| dot(&column(i / 5), &column(i % 5))).collect();
            let right: Vec<f64> = (0..5).map(|k| dot(&column(k), y)).collect();
            let x = solve_signed(&matrix, &right, &signed);
            proptest::prop_assert!(is_minimum(&matrix, &right, &signed, &x), "{x:?}");
        }
    }
}
