//! The hot loops of [`ZeroPhaseBank`](crate::ZeroPhaseBank), for eight columns at a time.
//!
//! Samples are read where they lie, column by column, and each is multiplied with the eight weights of a group of
//! modes: there the lanes of a vector are weights. The sums, one for every block of `decimation` samples, are
//! transposed, and the states run on with a column in each lane. Products and sums stay separate (no fused
//! multiply-add), hence every instruction set gives the same bits.

use aurt_traits::Dispatch;

use crate::preprocess::modes::{ModeGroup, WIDTH};

/// Blocks that one call takes in at most.
pub(super) const CHUNK: usize = 16;

/// One number for each column of a pack.
pub(super) type Lanes = [f64; WIDTH];

/// The states of a group of modes in one direction: re, im, re, im.
pub(super) type PackState = [Lanes; 4];

/// Sums of a pack's columns, `[column][block][weight]`.
pub(super) type Sums = [[Lanes; CHUNK]; WIDTH];

/// Some blocks of up to eight columns.
#[derive(Clone, Copy)]
pub(super) struct PackSamples<'a> {
    /// Column c starts at `data[c * stride]` and has at least `blocks` · F samples.
    pub(super) data: &'a [f64],
    pub(super) stride: usize,
    /// Columns that there are, at most eight.
    pub(super) columns: usize,
    /// Blocks that are taken in, at most [`CHUNK`].
    pub(super) blocks: usize,
}

/// Where the rows of a pack go that are held back.
pub(super) struct PackRows<'a> {
    /// One row for each block: what the past and the row's own sample contribute; the contributions are added.
    pub(super) past: &'a mut [Lanes],
    /// The backward sums of the row before the first block, then of the blocks.
    pub(super) future: &'a mut [PackState],
}

/// Defines a function that runs `$body` on the instruction set of a level.
macro_rules! dispatched {
    ($(#[$attribute:meta])* $name:ident = $body:ident($($argument:ident: $kind:ty),* $(,)?)) => {
        $(#[$attribute])*
        pub(super) fn $name(level: Dispatch, $($argument: $kind),*) {
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f")]
            fn avx512($($argument: $kind),*) {
                $body($($argument),*);
            }
            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            fn avx2($($argument: $kind),*) {
                $body($($argument),*);
            }
            match level {
                #[cfg(target_arch = "x86_64")]
                // SAFETY: the processor has the features that the function was compiled for.
                Dispatch::Avx512 if level.is_available() => unsafe { avx512($($argument),*) },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: as above.
                Dispatch::Avx2 if level.is_available() => unsafe { avx2($($argument),*) },
                _ => $body($($argument),*),
            }
        }
    };
}

dispatched! {
    /// Takes in blocks: the forward `state` moves on, `rows` receive what is known of them.
    ///
    /// The backward sum of a block lacks the first sample of the next; so every call completes the row before its first
    /// block, which is a dummy if there is none.
    take_in = take_in_body(
        group: &ModeGroup,
        samples: PackSamples<'_>,
        state: &mut PackState,
        rows: PackRows<'_>,
        sums: &mut Sums,
    )
}

dispatched! {
    /// Runs backward over the rows of a pack from the newest on and adds the contributions to the first `past.len()`.
    run_backward = run_backward_body(group: &ModeGroup, future: &[PackState], past: &mut [Lanes])
}

#[inline(always)]
fn take_in_body(
    group: &ModeGroup,
    samples: PackSamples<'_>,
    state: &mut PackState,
    rows: PackRows<'_>,
    sums: &mut Sums,
) {
    let factor = group.weights.len();
    let PackSamples { data, stride, columns, blocks } = samples;
    for (column, sums) in sums.iter_mut().enumerate().take(columns) {
        let start = column * stride;
        block_sums(&data[start..start + blocks * factor], &group.weights, &mut sums[..blocks]);
    }
    let mut s = *state;
    let mut waiting = rows.future[0];
    for k in 0..blocks {
        let mut first = [0.0; WIDTH];
        for (lane, column) in first.iter_mut().zip(data.chunks(stride)).take(columns) {
            *lane = column[k * factor];
        }
        let sum = transposed(sums, k);
        let past = &mut rows.past[k];
        for lane in 0..WIDTH {
            past[lane] += group.direct * first[lane] + output(group, &s, lane);
        }
        advance(&group.step, &mut s, [&sum[0], &sum[1], &sum[2], &sum[3]]);
        for part in 0..4 {
            for lane in 0..WIDTH {
                waiting[part][lane] += group.bridge[part] * first[lane];
            }
        }
        rows.future[k] = waiting;
        waiting = [sum[4], sum[5], sum[6], sum[7]];
    }
    rows.future[blocks] = waiting;
    *state = s;
}

#[inline(always)]
fn run_backward_body(group: &ModeGroup, future: &[PackState], past: &mut [Lanes]) {
    let mut s = [[0.0; WIDTH]; 4];
    let (ready, ahead) = future.split_at(past.len());
    for sum in ahead.iter().rev() {
        advance(&group.step, &mut s, [&sum[0], &sum[1], &sum[2], &sum[3]]);
    }
    for (sum, past) in ready.iter().zip(past).rev() {
        advance(&group.step, &mut s, [&sum[0], &sum[1], &sum[2], &sum[3]]);
        for lane in 0..WIDTH {
            past[lane] += output(group, &s, lane);
        }
    }
}

/// s ← p s + sum for two modes.
#[inline(always)]
fn advance(step: &[f64; 4], s: &mut PackState, sum: [&Lanes; 4]) {
    let old = *s;
    for mode in [0, 2] {
        let (re, im) = (step[mode], step[mode + 1]);
        for lane in 0..WIDTH {
            s[mode][lane] = (re * old[mode][lane] - im * old[mode + 1][lane]) + sum[mode][lane];
            s[mode + 1][lane] = (re * old[mode + 1][lane] + im * old[mode][lane]) + sum[mode + 1][lane];
        }
    }
}

/// Σ Re(coefficient · state) of one column.
#[inline(always)]
fn output(group: &ModeGroup, s: &PackState, lane: usize) -> f64 {
    let c = &group.output;
    (c[0] * s[0][lane] - c[1] * s[1][lane]) + (c[2] * s[2][lane] - c[3] * s[3][lane])
}

/// The sums of block `k`: `[weight][column]`.
#[inline(always)]
fn transposed(sums: &Sums, k: usize) -> [Lanes; WIDTH] {
    let mut out = [[0.0; WIDTH]; WIDTH];
    for column in 0..WIDTH {
        for weight in 0..WIDTH {
            out[weight][column] = sums[column][k][weight];
        }
    }
    out
}

/// Blocks summed at a time: enough independent sums to hide the latency of an addition.
const TOGETHER: usize = 4;

/// `sums[k] = Σ_i weights[i] · x[k·F + i]` with F = `weights.len()`, for every block k.
#[inline(always)]
fn block_sums(x: &[f64], weights: &[Lanes], sums: &mut [Lanes]) {
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
    for (sum, x) in groups.into_remainder().iter_mut().zip(blocks.remainder().chunks_exact(factor)) {
        let mut s = [0.0; WIDTH];
        for (w, a) in weights.iter().zip(x) {
            for lane in 0..WIDTH {
                s[lane] += w[lane] * a;
            }
        }
        *sum = s;
    }
}
