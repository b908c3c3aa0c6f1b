use aurt_traits::Dispatch;

use super::columns::{Columns, LANES};
use super::dispatched;

/// XᵀY over the first `rows` rows, `[column of Y · columns of X + column of X]`. Each of both is (data, distance of its
/// columns, number of columns).
///
/// # Panics
/// If `x` or `y` is too short.
pub fn products_of_columns(x: (&[f64], usize, usize), y: (&[f64], usize, usize), rows: usize) -> Vec<f64> {
    let mut products = vec![0.0; x.2 * y.2];
    products_of(Dispatch::active(), x, y, rows, &mut products);
    products
}

dispatched! {
    /// As [`products_of_columns`], on a given instruction set.
    products_of = products_body(
        x: (&[f64], usize, usize),
        y: (&[f64], usize, usize),
        rows: usize,
        products: &mut [f64],
    )
}

#[inline(always)]
fn products_body<const FUSED: bool, const KP: usize, const CP: usize, const KA: usize, const CA: usize>(
    (x, x_stride, x_count): (&[f64], usize, usize),
    (y, y_stride, y_count): (&[f64], usize, usize),
    rows: usize,
    products: &mut [f64],
) {
    let whole = rows - rows % LANES;
    let left = Columns::new(x, x_stride, x_count, whole / LANES);
    let right = Columns::new(y, y_stride, y_count, whole / LANES);
    left.products::<FUSED, KP, CP>(right, products);
    for (c, products) in products.chunks_exact_mut(x_count.max(1)).enumerate() {
        for (k, product) in products.iter_mut().enumerate() {
            *product += (whole..rows).map(|i| x[k * x_stride + i] * y[c * y_stride + i]).sum::<f64>();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_instruction_set_gives_the_products() {
        let (rows, left, right) = (21, 5, 4);
        let series = |count: usize, stride: usize, by: usize| -> Vec<f64> {
            (0..count * stride).map(|i| ((i * i * by % 97) as f64 - 48.0) / 16.0).collect()
        };
        let (x, y) = (series(left, 23, 3), series(right, 30, 5));
        for level in Dispatch::available() {
            let mut found = vec![0.0; left * right];
            products_of(level, (&x, 23, left), (&y, 30, right), rows, &mut found);
            for (i, value) in found.iter().enumerate() {
                let (k, c) = (i % left, i / left);
                // Quotients by 16 are added without rounding.
                let exact: f64 = (0..rows).map(|r| x[k * 23 + r] * y[c * 30 + r]).sum();
                assert_eq!(*value, exact, "{level} {k} {c}");
            }
        }
    }
}
