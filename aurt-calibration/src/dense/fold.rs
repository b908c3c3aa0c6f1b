use super::columns::{Columns, LANES, mul_add};
use super::dispatched;

/// Columns whose reflectors are applied to the others at once.
const PANEL: usize = 8;

dispatched! {
    /// Replaces the upper triangle R, column-major, by that of [R; A]; A has `size` columns, `stride` apart, and
    /// `pieces` · [`LANES`] rows, which become something else.
    ///
    /// Householder vectors touch one row of R each: column k's reflector is H = I − τ v vᵀ with v = (1 at row k of R,
    /// a scaled column of A), so the zeros of R stay zeros. Eight of them are found one after the other and applied
    /// to the other columns at once (Schreiber and Van Loan, *A storage-efficient WY representation for products of
    /// Householder transformations*, 1989): with V their A parts, C the other columns and T the rows of R, w solves
    /// τ_i⁻¹ w_i = (T + VᵀC)_i − Σ_{j<i} (v_i·v_j) w_j, and T ← T − w, C ← C − V w.
    fold_rows = fold(triangle: &mut [f64], size: usize, rows: &mut [f64], stride: usize, pieces: usize)
}

#[inline(always)]
fn fold<const FUSED: bool, const KP: usize, const CP: usize, const KA: usize, const CA: usize>(
    triangle: &mut [f64],
    size: usize,
    rows: &mut [f64],
    stride: usize,
    pieces: usize,
) {
    if pieces == 0 {
        return;
    }
    let mut weights = vec![0.0; size * PANEL];
    for first in (0..size).step_by(PANEL) {
        let width = PANEL.min(size - first);
        let others = size - first - width;
        let (panel, rest) = rows[first * stride..].split_at_mut(width * stride);
        let reflectors = reflect::<FUSED>(triangle, size, first, panel, stride, pieces);
        if others == 0 {
            return;
        }
        let panel = Columns::new(panel, stride, PANEL, pieces);
        panel.products::<FUSED, KP, CP>(Columns::new(rest, stride, others, pieces), &mut weights);
        let top = &mut triangle[(first + width) * size + first..];
        for (some, weights) in (0..others).step_by(LANES).zip(weights.chunks_mut(PANEL * LANES)) {
            let count = LANES.min(others - some);
            reflectors.weigh::<FUSED>(&mut top[some * size..], size, &mut weights[..count * PANEL]);
        }
        panel.add_multiples::<FUSED, KA, CA>(&weights, rest, stride, others);
    }
}

/// What eight reflectors need in order to be applied at once.
struct Reflectors {
    tau: [f64; PANEL],
    /// `[i][j]` = v_i · v_j without their tops, for j < i.
    products: [[f64; PANEL]; PANEL],
}

/// Finds the reflectors of some columns, one after the other, and puts their vectors in the place of the columns.
#[inline(always)]
fn reflect<const FUSED: bool>(
    triangle: &mut [f64],
    size: usize,
    first: usize,
    panel: &mut [f64],
    stride: usize,
    pieces: usize,
) -> Reflectors {
    let mut found = Reflectors { tau: [0.0; PANEL], products: [[0.0; PANEL]; PANEL] };
    let width = panel.len() / stride;
    for k in 0..width {
        let mut products = [0.0; PANEL];
        let all = Columns::new(panel, stride, width, pieces);
        Columns::new(&panel[k * stride..], stride, 1, pieces).products::<FUSED, 1, 4>(all, &mut products);
        let norm2 = products[k];
        if norm2 == 0.0 {
            continue;
        }
        let diagonal = &mut triangle[(first + k) * size + first + k];
        let alpha = *diagonal;
        let beta = -(alpha * alpha + norm2).sqrt().copysign(if alpha == 0.0 { 1.0 } else { alpha });
        let scale = 1.0 / (alpha - beta);
        let tau = (beta - alpha) / beta;
        *diagonal = beta;
        found.tau[k] = tau;
        let mut factors = [0.0; PANEL];
        for l in 0..width {
            if l < k {
                found.products[k][l] = products[l] * scale;
            } else if l > k {
                let top = &mut triangle[(first + l) * size + first + k];
                let projection = tau * mul_add::<FUSED>(products[l], scale, *top);
                *top -= projection;
                factors[l] = -projection * scale;
            }
        }
        let (column, after) = panel[k * stride..].split_at_mut(stride);
        let column = &mut column[..pieces * LANES];
        Columns::new(column, stride, 1, pieces).add_multiples::<FUSED, 1, 4>(
            &factors[k + 1..],
            after,
            stride,
            width - k - 1,
        );
        for value in column {
            *value *= scale;
        }
    }
    found
}

impl Reflectors {
    /// From VᵀC of up to eight columns their w, negative, in its place; T ← T − w.
    #[inline(always)]
    fn weigh<const FUSED: bool>(&self, top: &mut [f64], size: usize, weights: &mut [f64]) {
        let mut w = [[0.0; LANES]; PANEL];
        for (lane, (own, top)) in weights.chunks_exact(PANEL).zip(top.chunks(size)).enumerate() {
            for i in 0..PANEL {
                w[i][lane] = own[i] + top[i];
            }
        }
        for i in 0..PANEL {
            let (before, own) = w.split_at_mut(i);
            let own = &mut own[0];
            for (product, before) in self.products[i].iter().zip(before) {
                for lane in 0..LANES {
                    own[lane] = mul_add::<FUSED>(-product, before[lane], own[lane]);
                }
            }
            for value in own {
                *value *= self.tau[i];
            }
        }
        for (lane, (own, top)) in weights.chunks_exact_mut(PANEL).zip(top.chunks_mut(size)).enumerate() {
            for i in 0..PANEL {
                top[i] -= w[i][lane];
                own[i] = -w[i][lane];
            }
        }
    }
}
