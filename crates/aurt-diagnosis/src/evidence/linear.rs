//! Small dense solves on second moments, tolerant of columns that the data do not excite.

/// Relative pivot below which a column counts as dependent on those before it. Moments square the condition
/// number, so this corresponds to a share of 1e-5 of the column's length.
const PIVOT_TOLERANCE: f64 = 1e-10;

/// Cholesky factor L (lower, column-major) of a positive semidefinite matrix whose dependent columns are
/// skipped: they get a zero solution.
#[derive(Debug, Clone)]
pub(crate) struct Cholesky {
    n: usize,
    lower: Vec<f64>,
    used: Vec<bool>,
}

impl Cholesky {
    /// Factorises a symmetric matrix, column-major n × n.
    pub(crate) fn new(matrix: &[f64], n: usize) -> Self {
        let mut lower = matrix.to_vec();
        let mut used = vec![true; n];
        for k in 0..n {
            let original = matrix[k * n + k];
            let pivot = lower[k * n + k];
            if pivot <= PIVOT_TOLERANCE * original || !original.is_normal() {
                used[k] = false;
                lower[k * n + k..(k + 1) * n].fill(0.0);
                continue;
            }
            let root = pivot.sqrt();
            lower[k * n + k] = root;
            lower[k * n + k + 1..(k + 1) * n].iter_mut().for_each(|v| *v /= root);
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
        Self { n, lower, used }
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
            b[k] /= self.lower[k * self.n + k];
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
            let sum: f64 = column.iter().zip(&b[k + 1..]).map(|(l, x)| l * x).sum();
            b[k] = (b[k] - sum) / self.lower[k * self.n + k];
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

/// Least squares on moments, Sβ = c, with some entries of β held to be ≥ 0: entries that come out negative
/// are set to zero, the most negative first, and the rest solved again.
pub(crate) fn solve_signed(matrix: &[f64], right: &[f64], nonnegative: &[bool]) -> Vec<f64> {
    let n = right.len();
    let mut active: Vec<usize> = (0..n).collect();
    loop {
        let m = active.len();
        let reduced: Vec<f64> =
            active.iter().flat_map(|b| active.iter().map(move |a| matrix[b * n + a])).collect();
        let reduced_right: Vec<f64> = active.iter().map(|a| right[*a]).collect();
        let solution = Cholesky::new(&reduced, m).solve(&reduced_right);
        let worst = (0..m)
            .filter(|i| nonnegative[active[*i]] && solution[*i] < 0.0)
            .min_by(|a, b| solution[*a].total_cmp(&solution[*b]));
        match worst {
            Some(i) => {
                active.remove(i);
            }
            None => {
                let mut full = vec![0.0; n];
                for (a, value) in active.iter().zip(solution) {
                    full[*a] = value;
                }
                return full;
            }
        }
    }
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
}
