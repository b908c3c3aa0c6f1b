use aurt_traits::Dispatch;

use crate::CalibrationError;
use crate::dense::{LANES, fold_rows};

/// Rows buffered before they are folded into the triangle; a multiple of [`LANES`], small enough for buffer and
/// triangle to stay in the second-level cache, large enough for what folding costs beside the rows not to count.
const CHUNK_ROWS: usize = 384;

/// Distance between the buffer's columns: not a power of two, so that they do not fall on the same cache sets.
const STRIDE: usize = CHUNK_ROWS + LANES;

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
    pub fn columns(&self) -> &[usize] {
        &self.columns
    }

    /// Number of rows taken in.
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
        self.buffer.resize(STRIDE * self.size, 0.0);
        let mut taken = 0;
        while taken < kept.len() {
            let now = &kept[taken..(taken + CHUNK_ROWS - self.buffered).min(kept.len())];
            let [first, last] = [now[0], now[now.len() - 1]];
            for k in 0..self.size {
                let source = if k + 1 == self.size { measurement } else { column(k) };
                let start = k * STRIDE + self.buffered;
                let to = &mut self.buffer[start..start + now.len()];
                if last - first + 1 == now.len() {
                    to.copy_from_slice(&source[first..=last]);
                } else {
                    to.iter_mut().zip(now).for_each(|(to, row)| *to = source[*row]);
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
    pub fn triangle(&self) -> Vec<f64> {
        if self.buffered == 0 {
            return self.triangle.clone();
        }
        let mut finished = self.clone();
        finished.fold();
        finished.triangle
    }

    fn fold(&mut self) {
        let pieces = self.buffered.div_ceil(LANES);
        for column in self.buffer.chunks_exact_mut(STRIDE) {
            column[self.buffered..pieces * LANES].fill(0.0);
        }
        fold_rows(Dispatch::active(), &mut self.triangle, self.size, &mut self.buffer, STRIDE, pieces);
        self.buffered = 0;
    }
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

    /// Householder reflections, one column after the other, on the whole matrix: the textbook's way.
    fn triangle_by_the_book(columns: &[Vec<f64>]) -> Vec<f64> {
        let (n, p) = (columns[0].len(), columns.len());
        let mut all = columns.concat();
        crate::system::triangularise(&mut all, n, p);
        (0..p).flat_map(|c| (0..p).map(move |r| (c, r))).map(|(c, r)| all[c * n + r]).collect()
    }

    /// Every instruction set against the textbook, for sizes around the panel's and rows around the chunk's; AVX2 and
    /// AVX-512 agree bit for bit.
    #[test]
    fn every_instruction_set_gives_the_same_triangle() {
        for (size, rows) in
            [(1, 5), (3, 383), (8, 384), (9, 500), (16, 391), (23, 769), (42, 2000), (71, 1200)]
        {
            let columns: Vec<Vec<f64>> = (0..size).map(|k| series(0.013 * k as f64, rows)).collect();
            let book = triangle_by_the_book(&columns);
            let largest = book.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            let mut fused: Option<Vec<f64>> = None;
            for level in Dispatch::available() {
                let mut triangle = vec![0.0; size * size];
                let mut first = 0;
                while first < rows {
                    let count = CHUNK_ROWS.min(rows - first);
                    let mut buffer = vec![0.0; STRIDE * size];
                    for (to, from) in buffer.chunks_exact_mut(STRIDE).zip(&columns) {
                        to[..count].copy_from_slice(&from[first..first + count]);
                    }
                    fold_rows(level, &mut triangle, size, &mut buffer, STRIDE, count.div_ceil(LANES));
                    first += count;
                }
                for c in 0..size {
                    // Rows of R are unique but for their sign.
                    for r in 0..=c {
                        let sign = (triangle[r * size + r] * book[r * size + r]).signum();
                        let difference = sign * triangle[c * size + r] - book[c * size + r];
                        assert!(
                            difference.abs() < 1e-12 * largest,
                            "{level} {size}×{rows}: {r} {c} {difference:e}"
                        );
                    }
                }
                if level != Dispatch::Baseline {
                    assert!(
                        fused.get_or_insert_with(|| triangle.clone()) == &triangle,
                        "{level} {size}×{rows}"
                    );
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
