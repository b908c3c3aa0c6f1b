use super::columns::{Columns, LANES};
use super::dispatched;

/// Rows worked on at once: those of the basis then stay in the second-level cache for all columns.
const ROWS: usize = 64 * LANES;

dispatched! {
    /// `along` = Qᵀ B, and B − Q Qᵀ B in the place of B, for Q of `rows` rows and B of `along.len()` / (columns of Q)
    /// columns, all column-major.
    project_out = project(basis: &[f64], rows: usize, columns: &mut [f64], along: &mut [f64])
}

#[inline(always)]
fn project<const FUSED: bool, const KP: usize, const CP: usize, const KA: usize, const CA: usize>(
    basis: &[f64],
    rows: usize,
    columns: &mut [f64],
    along: &mut [f64],
) {
    along.fill(0.0);
    let Some(n) = basis.len().checked_div(rows).filter(|n| *n > 0) else { return };
    let count = along.len() / n;
    if count == 0 {
        return;
    }
    let whole = rows - rows % LANES;
    let mut part = vec![0.0; along.len()];
    for first in (0..whole).step_by(ROWS) {
        let pieces = ROWS.min(whole - first) / LANES;
        let left = Columns::new(&basis[first..], rows, n, pieces);
        left.products::<FUSED, KP, CP>(Columns::new(&columns[first..], rows, count, pieces), &mut part);
        along.iter_mut().zip(&part).for_each(|(sum, part)| *sum += part);
    }
    for (column, along) in columns.chunks_exact(rows).zip(along.chunks_exact_mut(n)) {
        for (q, sum) in basis.chunks_exact(rows).zip(along) {
            *sum += q[whole..].iter().zip(&column[whole..]).map(|(q, c)| q * c).sum::<f64>();
        }
    }
    part.iter_mut().zip(&*along).for_each(|(part, sum)| *part = -sum);
    for first in (0..whole).step_by(ROWS) {
        let pieces = ROWS.min(whole - first) / LANES;
        let left = Columns::new(&basis[first..], rows, n, pieces);
        left.add_multiples::<FUSED, KA, CA>(&part, &mut columns[first..], rows, count);
    }
    for (column, factors) in columns.chunks_exact_mut(rows).zip(part.chunks_exact(n)) {
        for (q, factor) in basis.chunks_exact(rows).zip(factors) {
            column[whole..].iter_mut().zip(&q[whole..]).for_each(|(c, q)| *c += factor * q);
        }
    }
}
