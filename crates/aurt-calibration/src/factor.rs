use crate::CalibrationError;

/// Rows buffered before they are folded into the triangle; a multiple of the vector width, small enough for
/// buffer and triangle to stay in the second-level cache.
const CHUNK_ROWS: usize = 256;

/// The least-squares information of one joint's rows: the triangle R of a QR factorisation of [W_j | y_j],
/// accumulated over tiles, so that W is never held as a whole.
///
/// R has p + 1 columns (the measurement is the last) and says all that least squares can ask of the rows:
/// for any ζ, ‖y_j − W_j ζ‖² = ‖R (−ζ, 1)ᵀ‖². Factors over the same columns add up ([`Self::merge`]), and a
/// column subset of R is the factor of the column subset of W.
#[derive(Debug, Clone)]
pub struct JointFactor {
    columns: Vec<usize>,
    size: usize,
    triangle: Vec<f64>,
    buffer: Vec<f64>,
    buffered: usize,
    rows: usize,
}

impl JointFactor {
    /// An empty factor over the given columns of the robot's regressor.
    #[must_use]
    pub fn new(columns: Vec<usize>) -> Self {
        let size = columns.len() + 1;
        Self { columns, size, triangle: vec![0.0; size * size], buffer: Vec::new(), buffered: 0, rows: 0 }
    }

    /// A factor whose triangle is known, column-major, (p + 1) × (p + 1).
    pub(crate) fn from_triangle(columns: Vec<usize>, triangle: Vec<f64>, rows: usize) -> Self {
        let size = columns.len() + 1;
        Self { columns, size, triangle, buffer: Vec::new(), buffered: 0, rows }
    }

    /// The regressor columns that the joint's rows have.
    #[must_use]
    pub fn columns(&self) -> &[usize] {
        &self.columns
    }

    /// Number of rows taken in.
    #[must_use]
    pub const fn rows(&self) -> usize {
        self.rows
    }

    /// Takes in rows. `column(k)` is the k-th of [`Self::columns`], `measurement` the right-hand side; row i is
    /// taken where `keep(i)`.
    pub fn push<'a>(
        &mut self,
        column: impl Fn(usize) -> &'a [f64],
        measurement: &[f64],
        keep: impl Fn(usize) -> bool,
    ) {
        let kept: Vec<usize> = (0..measurement.len()).filter(|i| keep(*i)).collect();
        // A factor that is only solved needs no buffer.
        self.buffer.resize(CHUNK_ROWS * self.size, 0.0);
        let mut taken = 0;
        while taken < kept.len() {
            let now = &kept[taken..(taken + CHUNK_ROWS - self.buffered).min(kept.len())];
            for k in 0..self.size {
                let source = if k + 1 == self.size { measurement } else { column(k) };
                let start = k * CHUNK_ROWS + self.buffered;
                for (to, row) in self.buffer[start..start + now.len()].iter_mut().zip(now) {
                    *to = source[*row];
                }
            }
            self.buffered += now.len();
            taken += now.len();
            if self.buffered == CHUNK_ROWS {
                self.fold();
            }
        }
        self.rows += kept.len();
    }

    /// Adds the information of another factor over the same columns.
    ///
    /// # Errors
    /// [`CalibrationError::Columns`] if the columns differ.
    pub fn merge(&mut self, other: &Self) -> Result<(), CalibrationError> {
        if self.columns != other.columns {
            return Err(CalibrationError::Columns { left: self.columns.len(), right: other.columns.len() });
        }
        let triangle = other.triangle();
        let size = self.size;
        let rows = self.rows + other.rows;
        self.push(|k| &triangle[k * size..(k + 1) * size], &triangle[(size - 1) * size..], |_| true);
        self.rows = rows;
        Ok(())
    }

    /// The triangle R, column-major, (p + 1) × (p + 1); its last column belongs to the measurement.
    #[must_use]
    pub fn triangle(&self) -> Vec<f64> {
        if self.buffered == 0 {
            return self.triangle.clone();
        }
        let mut finished = self.clone();
        finished.fold();
        finished.triangle
    }

    fn fold(&mut self) {
        fold_rows(&mut self.triangle, self.size, &mut self.buffer, CHUNK_ROWS, self.buffered);
        self.buffered = 0;
    }
}

/// Replaces the upper triangle R by that of [R; A], A having `rows` rows (column-major, `stride` apart).
///
/// Householder vectors touch one row of R each: column k's reflector is (1 at row k of R, A's column k), so
/// the zeros of R stay zeros and each reflector costs 4·rows operations per remaining column.
fn fold_rows(triangle: &mut [f64], size: usize, rows: &mut [f64], stride: usize, count: usize) {
    if count == 0 {
        return;
    }
    for k in 0..size {
        let (left, right) = rows.split_at_mut((k + 1) * stride);
        let pivot_column = &mut left[k * stride..k * stride + count];
        let norm2: f64 = dot(pivot_column, pivot_column);
        if norm2 == 0.0 {
            continue;
        }
        let alpha = triangle[k * size + k];
        let beta = -(alpha * alpha + norm2).sqrt().copysign(if alpha == 0.0 { 1.0 } else { alpha });
        let scale = 1.0 / (alpha - beta);
        let tau = (beta - alpha) / beta;
        pivot_column.iter_mut().for_each(|v| *v *= scale);
        triangle[k * size + k] = beta;
        for l in k + 1..size {
            let column = &mut right[(l - k - 1) * stride..(l - k - 1) * stride + count];
            let top = &mut triangle[l * size + k];
            let projection = tau * (*top + dot(pivot_column, column));
            *top -= projection;
            for (c, v) in column.iter_mut().zip(pivot_column.iter()) {
                *c -= projection * v;
            }
        }
    }
}

/// Scalar product in eight interleaved partial sums, so that it vectorises and rounds less.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut partial = [0.0_f64; 8];
    let (a_blocks, a_rest) = a.as_chunks::<8>();
    let (b_blocks, b_rest) = b.as_chunks::<8>();
    for (x, y) in a_blocks.iter().zip(b_blocks) {
        for lane in 0..8 {
            partial[lane] += x[lane] * y[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(x, y)| x * y).sum();
    partial.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reproducible series without a random crate: fractional parts of multiples of an irrational.
    fn series(seed: f64, n: usize) -> Vec<f64> {
        (0..n).map(|i| ((i as f64 + 1.0) * (0.754_877_666_2 + seed)).fract() - 0.5).collect()
    }

    #[test]
    fn triangle_reproduces_the_gram_matrix_over_any_split() {
        let n = 1000;
        let columns: Vec<Vec<f64>> = (0..5).map(|k| series(0.1 * f64::from(k), n)).collect();
        let mut whole = JointFactor::new(vec![0, 1, 2, 3]);
        whole.push(|k| &columns[k], &columns[4], |_| true);
        let mut halves = JointFactor::new(vec![0, 1, 2, 3]);
        let mut second = halves.clone();
        halves.push(|k| &columns[k][..300], &columns[4][..300], |_| true);
        second.push(|k| &columns[k][300..], &columns[4][300..], |_| true);
        halves.merge(&second).unwrap();
        assert_eq!(halves.rows(), n);
        for factor in [&whole, &halves] {
            let r = factor.triangle();
            for a in 0..5 {
                for b in 0..5 {
                    let gram: f64 = columns[a].iter().zip(&columns[b]).map(|(x, y)| x * y).sum();
                    let from_triangle: f64 = (0..5).map(|i| r[a * 5 + i] * r[b * 5 + i]).sum();
                    assert!((gram - from_triangle).abs() < 1e-11, "{a} {b}: {gram} {from_triangle}");
                }
            }
        }
    }

    #[test]
    fn rows_that_are_not_kept_do_not_count() {
        let x = series(0.3, 64);
        let y = series(0.7, 64);
        let mut some = JointFactor::new(vec![0]);
        some.push(|_| &x, &y, |i| i % 3 == 0);
        let expected: f64 = x.iter().step_by(3).map(|v| v * v).sum();
        assert_eq!(some.rows(), 22);
        assert!((some.triangle()[0].powi(2) - expected).abs() < 1e-12);
    }
}
