/// Sweeps over all pairs; five suffice for matrices of order four.
const SWEEPS: usize = 12;

/// Eigenvalues of a symmetric matrix, ascending, each with its eigenvector of unit length, by Jacobi's rotations.
pub(super) fn symmetric<const N: usize>(mut a: [[f64; N]; N]) -> Vec<(f64, [f64; N])> {
    // Rows of v become the eigenvectors.
    let mut v = [[0.0; N]; N];
    (0..N).for_each(|i| v[i][i] = 1.0);
    for _ in 0..SWEEPS {
        for p in 0..N {
            for q in p + 1..N {
                if a[p][q] == 0.0 {
                    continue;
                }
                let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
                let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
                let (c, s) = (1.0 / t.hypot(1.0), t / t.hypot(1.0));
                for row in &mut a {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
                for k in 0..N {
                    (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
                    (v[p][k], v[q][k]) = (c * v[p][k] - s * v[q][k], s * v[p][k] + c * v[q][k]);
                }
            }
        }
    }
    let mut pairs: Vec<(f64, [f64; N])> = (0..N).map(|i| (a[i][i], v[i])).collect();
    pairs.sort_by(|x, y| x.0.total_cmp(&y.0));
    pairs
}

#[cfg(test)]
mod tests {
    use super::symmetric;

    #[test]
    fn known_eigenvalues_and_their_vectors() {
        // The second-difference matrix of order four has the eigenvalues 2 − 2 cos(kπ/5).
        let matrix =
            [[2.0, -1.0, 0.0, 0.0], [-1.0, 2.0, -1.0, 0.0], [0.0, -1.0, 2.0, -1.0], [0.0, 0.0, -1.0, 2.0]];
        for (k, (value, vector)) in symmetric(matrix).into_iter().enumerate() {
            let expected = 2.0 - 2.0 * ((k + 1) as f64 * std::f64::consts::PI / 5.0).cos();
            assert!((value - expected).abs() < 1e-12, "{value} {expected}");
            for (row, v) in matrix.iter().zip(vector) {
                let product: f64 = row.iter().zip(vector).map(|(m, x)| m * x).sum();
                assert!((product - value * v).abs() < 1e-12);
            }
        }
    }
}
