use std::ops::Range;

use aurt_traits::Dispatch;

use super::columns::{Columns, LANES};
use super::dispatched;

/// Columns on the right of a product at once; those on the left of them follow from symmetry.
const TOGETHER: usize = 3 * LANES;

/// Adds XᵀX to `gram`, column-major, for the rows `rows` of X, whose columns are `stride` apart.
///
/// # Panics
/// If `data` or `gram` is too short.
pub fn add_gram(data: &[f64], stride: usize, columns: usize, rows: Range<usize>, gram: &mut [f64]) {
    gram_of(Dispatch::active(), &data[rows.start.min(data.len())..], stride, columns, rows.len(), gram);
}

dispatched! {
    /// As [`add_gram`], for the first rows, on a given instruction set.
    gram_of = gram_body(data: &[f64], stride: usize, columns: usize, rows: usize, gram: &mut [f64])
}

#[inline(always)]
fn gram_body<const FUSED: bool, const KP: usize, const CP: usize, const KA: usize, const CA: usize>(
    data: &[f64],
    stride: usize,
    columns: usize,
    rows: usize,
    gram: &mut [f64],
) {
    let whole = rows - rows % LANES;
    let mut products = vec![0.0; columns * TOGETHER];
    for first in (0..columns).step_by(TOGETHER) {
        let count = TOGETHER.min(columns - first);
        let left = Columns::new(data, stride, first + count, whole / LANES);
        let right = Columns::new(&data[first * stride..], stride, count, whole / LANES);
        left.products::<FUSED, KP, CP>(right, &mut products);
        for (c, products) in (first..).zip(products.chunks_exact(first + count).take(count)) {
            for (k, product) in products.iter().enumerate().take(c + 1) {
                let rest: f64 = (whole..rows).map(|i| data[k * stride + i] * data[c * stride + i]).sum();
                gram[c * columns + k] += product + rest;
                if k != c {
                    gram[k * columns + c] += product + rest;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_instruction_set_gives_the_scalar_products() {
        let (stride, columns) = (70, 31);
        let data: Vec<f64> = (0..stride * columns).map(|i| ((i * i % 97) as f64 - 48.0) / 16.0).collect();
        for (first, end) in [(0, 70), (3, 64), (5, 9), (70, 70)] {
            for level in Dispatch::available() {
                // Quotients by 16 are added without rounding.
                let mut gram = vec![1.0; columns * columns];
                gram_of(level, &data[first..], stride, columns, end - first, &mut gram);
                for (i, value) in gram.iter().enumerate() {
                    let (a, b) = (i / columns, i % columns);
                    let exact: f64 = (first..end).map(|r| data[a * stride + r] * data[b * stride + r]).sum();
                    assert_eq!(*value, 1.0 + exact, "{level} {a} {b} {first}..{end}");
                }
            }
        }
    }
}
