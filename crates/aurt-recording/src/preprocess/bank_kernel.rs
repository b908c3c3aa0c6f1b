//! The hot loop of [`ZeroPhaseBank`](crate::ZeroPhaseBank): weighted sums over blocks of consecutive samples.
//!
//! The lanes of a vector are not columns but the eight weights that one sample is multiplied with, so the
//! samples of a column are read where they lie and nothing is transposed. Products and sums stay separate
//! (no fused multiply-add), hence every instruction set gives the same bits.

/// Weights per sample: two poles, real and imaginary part, forward and backward.
pub(super) const WIDTH: usize = 8;

/// Instruction set of the loop, chosen once when a bank is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Level {
    /// What every processor of the target architecture has.
    Baseline,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Level {
    /// The widest level that this processor has.
    pub(super) fn detect() -> Self {
        Self::available().last().copied().unwrap_or(Self::Baseline)
    }

    /// All levels that this processor has, the widest last.
    pub(super) fn available() -> Vec<Self> {
        #[cfg_attr(not(target_arch = "x86_64"), expect(unused_mut, reason = "one level only"))]
        let mut levels = vec![Self::Baseline];
        #[cfg(target_arch = "x86_64")]
        {
            if std::arch::is_x86_feature_detected!("avx2") {
                levels.push(Self::Avx2);
            }
            if std::arch::is_x86_feature_detected!("avx512f") {
                levels.push(Self::Avx512);
            }
        }
        levels
    }
}

/// `sums[k] = Σ_i weights[i] · x[k·F + i]` with F = `weights.len()`, for every block k of `sums`.
///
/// `x` holds at least F · `sums.len()` samples.
pub(super) fn block_sums(level: Level, x: &[f64], weights: &[[f64; WIDTH]], sums: &mut [[f64; WIDTH]]) {
    match level {
        Level::Baseline => block_sums_in(x, weights, sums),
        // SAFETY: `Level::Avx2` is only made by `Level::available` after the processor reported avx2.
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 => unsafe { block_sums_avx2(x, weights, sums) },
        // SAFETY: `Level::Avx512` is only made by `Level::available` after the processor reported avx512f.
        #[cfg(target_arch = "x86_64")]
        Level::Avx512 => unsafe { block_sums_avx512(x, weights, sums) },
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn block_sums_avx2(x: &[f64], weights: &[[f64; WIDTH]], sums: &mut [[f64; WIDTH]]) {
    block_sums_in(x, weights, sums);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
fn block_sums_avx512(x: &[f64], weights: &[[f64; WIDTH]], sums: &mut [[f64; WIDTH]]) {
    block_sums_in(x, weights, sums);
}

/// Blocks summed at a time: enough independent sums to hide the latency of an addition.
const TOGETHER: usize = 4;

#[inline(always)]
fn block_sums_in(x: &[f64], weights: &[[f64; WIDTH]], sums: &mut [[f64; WIDTH]]) {
    let factor = weights.len();
    let mut blocks = x.chunks_exact(TOGETHER * factor);
    let mut groups = sums.chunks_exact_mut(TOGETHER);
    for (group, x) in groups.by_ref().zip(blocks.by_ref()) {
        let (x01, x23) = x.split_at(2 * factor);
        let (x0, x1) = x01.split_at(factor);
        let (x2, x3) = x23.split_at(factor);
        let mut s = [[0.0; WIDTH]; TOGETHER];
        for ((((w, a), b), c), d) in weights.iter().zip(x0).zip(x1).zip(x2).zip(x3) {
            for lane in 0..WIDTH {
                s[0][lane] += w[lane] * a;
                s[1][lane] += w[lane] * b;
                s[2][lane] += w[lane] * c;
                s[3][lane] += w[lane] * d;
            }
        }
        group.copy_from_slice(&s);
    }
    let done = x.len() / (TOGETHER * factor) * TOGETHER * factor;
    for (sum, x) in groups.into_remainder().iter_mut().zip(x[done..].chunks_exact(factor)) {
        let mut s = [0.0; WIDTH];
        for (w, a) in weights.iter().zip(x) {
            for lane in 0..WIDTH {
                s[lane] += w[lane] * a;
            }
        }
        *sum = s;
    }
}
