//! Reflections of small matrices, one column after the other: solutions and condition numbers.

use super::{
    columns::{LANES, mul_add, total},
    dispatched,
};
use crate::factor;

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
        let length = dot::<FUSED>(column, column).sqrt();
        let rest = dot::<FUSED>(&column[next..], &column[next..]).sqrt();
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
            let projection = tau * (*top + dot::<FUSED>(below, reflector));
            *top -= projection;
            add_multiple::<FUSED>(-projection, reflector, below);
        }
        column[next] = beta;
        column[next + 1..].fill(0.0);
        pivots[c] = Some(next);
        next += 1;
    }
}

dispatched! {
    /// The entries of the bidiagonal matrix that reflections from both sides leave of a square matrix, column-major:
    /// d_0, e_0, d_1, e_1, …, d_{n−1} (Golub and Kahan, 1965). The matrix becomes something else.
    bidiagonal = bidiagonal_body(matrix: &mut [f64], n: usize, entries: &mut [f64])
}

#[inline(always)]
fn bidiagonal_body<const FUSED: bool, const KP: usize, const CP: usize, const KA: usize, const CA: usize>(
    matrix: &mut [f64],
    n: usize,
    entries: &mut [f64],
) {
    let mut row = vec![0.0; n];
    let mut along = vec![0.0; n];
    for k in 0..n {
        let (left, right) = matrix.split_at_mut((k + 1) * n);
        let column = &mut left[k * n + k..];
        let (diagonal, tau) = reflector::<FUSED>(column);
        entries[2 * k] = diagonal;
        for other in right.chunks_exact_mut(n) {
            let other = &mut other[k..];
            let projection = tau * dot_in_order::<FUSED>(column, other);
            add_multiple::<FUSED>(-projection, column, other);
        }
        if k + 1 == n {
            return;
        }
        let row = &mut row[k + 1..];
        for (r, column) in row.iter_mut().zip(right.chunks_exact(n)) {
            *r = column[k];
        }
        let (beside, tau) = reflector::<FUSED>(row);
        entries[2 * k + 1] = beside;
        let along = &mut along[k + 1..];
        along.fill(0.0);
        for (v, column) in row.iter().zip(right.chunks_exact(n)) {
            add_multiple::<FUSED>(tau * v, &column[k + 1..], along);
        }
        for (v, column) in row.iter().zip(right.chunks_exact_mut(n)) {
            add_multiple::<FUSED>(-*v, along, &mut column[k + 1..]);
        }
    }
}

/// Turns x into the v of the reflection I − τ v vᵀ that leaves of x its first component, and returns that and τ.
#[inline(always)]
fn reflector<const FUSED: bool>(x: &mut [f64]) -> (f64, f64) {
    let length = dot_in_order::<FUSED>(x, x).sqrt();
    let Some(first) = x.first_mut() else { return (0.0, 0.0) };
    if length == 0.0 {
        return (0.0, 0.0);
    }
    let alpha = *first;
    let beta = -length.copysign(alpha);
    *first = 1.0;
    for value in &mut x[1..] {
        *value /= alpha - beta;
    }
    (beta, (beta - alpha) / beta)
}

/// Scalar product. The baseline keeps the order of sums that its bits are known by.
#[inline(always)]
fn dot<const FUSED: bool>(a: &[f64], b: &[f64]) -> f64 {
    if !FUSED {
        return factor::dot(a, b);
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

/// [`dot`]; at the baseline from front to back.
#[inline(always)]
fn dot_in_order<const FUSED: bool>(a: &[f64], b: &[f64]) -> f64 {
    if FUSED {
        return dot::<FUSED>(a, b);
    }
    let mut sum = 0.0;
    for (x, y) in a.iter().zip(b) {
        sum += x * y;
    }
    sum
}

/// Adds `factor` · x to `to`.
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
            let mut found: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
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
                let mut entries = vec![0.0; 2 * n - 1];
                bidiagonal(level, &mut matrix.clone(), n, &mut entries);
                // Reflections keep the sum of all squares.
                let squares = |m: &[f64]| m.iter().map(|v| v * v).sum::<f64>();
                assert!((squares(&entries) / squares(&matrix) - 1.0).abs() < 1e-13, "{level} {n}");
                found.push((r, entries));
            }
            for (r, entries) in &found[1..] {
                let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-10);
                assert!(near(r, &found[0].0) && near(entries, &found[0].1), "{n}");
                assert!(r == &found[1].0 && entries == &found[1].1, "{n}: AVX2 and AVX-512 differ");
            }
        }
    }
}
