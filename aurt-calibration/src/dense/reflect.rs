//! Reflections of small matrices, one column after the other.

use super::columns::{LANES, mul_add, total};
use super::dispatched;

/// A column whose part independent of the columns before it is smaller than this share of its length is taken as
/// dependent.
const DEPENDENCE_TOLERANCE: f64 = 1e-9;

dispatched! {
    /// Householder QR in place, left to right, of columns of which the k-th is zero below its first `heights[k]` rows,
    /// and of right-hand sides behind them; heights ascend. `pivots[k]` becomes the column's row of R, or nothing for
    /// one that depends on those before it.
    triangularise_below = triangularise_body(
        matrix: &mut [f64], rows: usize, heights: &[usize], pivots: &mut [Option<usize>]
    )
}

#[inline(always)]
fn triangularise_body<
    const FUSED: bool,
    const KP: usize,
    const CP: usize,
    const KA: usize,
    const CA: usize,
>(
    matrix: &mut [f64],
    rows: usize,
    heights: &[usize],
    pivots: &mut [Option<usize>],
) {
    let mut next = 0;
    for (c, height) in heights.iter().copied().enumerate() {
        pivots[c] = None;
        if next >= height {
            continue;
        }
        let (left, right) = matrix.split_at_mut((c + 1) * rows);
        let column = &mut left[c * rows..c * rows + height];
        let length = product::<FUSED>(column, column).sqrt();
        let rest = product::<FUSED>(&column[next..], &column[next..]).sqrt();
        if rest <= DEPENDENCE_TOLERANCE * length.max(f64::MIN_POSITIVE) {
            continue;
        }
        let alpha = column[next];
        let beta = -rest.copysign(if alpha == 0.0 { 1.0 } else { alpha });
        let tau = (beta - alpha) / beta;
        let scale = 1.0 / (alpha - beta);
        for value in &mut column[next + 1..] {
            *value *= scale;
        }
        let reflector = &column[next + 1..];
        for other in right.chunks_exact_mut(rows) {
            let other = &mut other[next..height];
            let Some((top, below)) = other.split_first_mut() else { continue };
            let projection = tau * (*top + product::<FUSED>(below, reflector));
            *top -= projection;
            add_multiple::<FUSED>(-projection, reflector, below);
        }
        column[next] = beta;
        column[next + 1..].fill(0.0);
        pivots[c] = Some(next);
        next += 1;
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

/// Scalar product. The baseline keeps the order of sums that its bits are known by.
#[inline(always)]
fn product<const FUSED: bool>(a: &[f64], b: &[f64]) -> f64 {
    if !FUSED {
        return dot(a, b);
    }
    let mut partial = [0.0_f64; LANES];
    let (a_blocks, a_rest) = a.as_chunks::<LANES>();
    let (b_blocks, b_rest) = b.as_chunks::<LANES>();
    for (x, y) in a_blocks.iter().zip(b_blocks) {
        for lane in 0..LANES {
            partial[lane] = mul_add::<FUSED>(x[lane], y[lane], partial[lane]);
        }
    }
    for ((sum, x), y) in partial.iter_mut().zip(a_rest).zip(b_rest) {
        *sum = mul_add::<FUSED>(*x, *y, *sum);
    }
    total(&partial)
}

#[inline(always)]
fn add_multiple<const FUSED: bool>(factor: f64, x: &[f64], to: &mut [f64]) {
    for (to, x) in to.iter_mut().zip(x) {
        *to = mul_add::<FUSED>(factor, *x, *to);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use aurt_traits::Dispatch;

    #[test]
    fn every_instruction_set_gives_the_same_reflections() {
        for n in [1, 2, 7, 8, 30, 61] {
            let matrix: Vec<f64> = (0..n * n).map(|i| ((i * i + 3 * i) % 101) as f64 / 50.0 - 1.0).collect();
            let mut found: Vec<Vec<f64>> = Vec::new();
            for level in Dispatch::available() {
                let (mut r, mut pivots) = (matrix.clone(), vec![None; n]);
                triangularise_below(level, &mut r, n, &vec![n; n], &mut pivots);
                assert!(pivots.iter().enumerate().all(|(k, p)| *p == Some(k)), "{level} {n} {pivots:?}");
                for a in 0..n {
                    for b in 0..n {
                        let gram = |m: &[f64]| (0..n).map(|i| m[a * n + i] * m[b * n + i]).sum::<f64>();
                        assert!((gram(&r) - gram(&matrix)).abs() < 1e-12 * n as f64, "{level} {n} {a} {b}");
                    }
                }
                found.push(r);
            }
            for r in &found[1..] {
                assert!(r.iter().zip(&found[0]).all(|(a, b)| (a - b).abs() < 1e-10), "{n}");
                assert!(r == &found[1], "{n}: AVX2 and AVX-512 differ");
            }
        }
    }
}
