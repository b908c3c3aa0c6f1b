//! The regressor kernel against what the processor can do at all: `cargo bench -p aurt-rbd --bench roofline`.
//!
//! For every instruction set, the fastest of many short rounds by turns:
//!
//! - the peak: multiply-adds (at the baseline products and sums) of twelve independent vectors in registers;
//! - the writing of a tile: the kernel's columns, filled with constants;
//! - the kernel, its columns stored into a tile or kept in the first-level cache.
//!
//! Prints the operations and bytes of one evaluation (those that written entries depend on, see
//! `aurt_rbd::Operations`), and the kernel's share of the peak. All operations of a fused kernel could be
//! multiply-adds only if it had as many additions as multiplications in the right places; the second share counts
//! instructions instead: the time that the kernel's arithmetic instructions would take at the peak's rate.
#![expect(clippy::expect_used, reason = "the robots are constants")]

mod kernel;

use std::hint::black_box;
use std::time::Instant;

use aurt_rbd::{Dispatch, Operations};
use kernel::{ROBOTS, SAMPLES, STRIDE, cases, robot, time};

/// Independent sums: enough to hide the latency of two units, few enough for sixteen registers.
const SUMS: usize = 12;
/// Steps of one round of the peak.
const STEPS: usize = 4096;
const ROUNDS: usize = 801;
/// Vectors of a column that are written one after the other, as the kernel does.
const GROUP: usize = 6;

/// Writes a constant to all columns of a tile, some vectors at a time.
#[inline(always)]
fn fill<const L: usize>(tile: &mut [f64], value: [f64; L]) {
    for first in (0..SAMPLES).step_by(GROUP * L) {
        let end = (first + GROUP * L).min(SAMPLES);
        for column in tile.chunks_exact_mut(STRIDE) {
            let (vectors, _) = column[first..end].as_chunks_mut::<L>();
            for vector in vectors {
                *vector = value;
            }
        }
    }
}

/// The two loops at one level: `$attribute` chooses the instructions, `$x86` are the processor's own names for them,
/// because the compiler's way of making vectors of arrays is what is to be measured, not what to measure it with.
macro_rules! at_level {
    ($steps:ident, $fill:ident, $lanes:literal, $feature:literal, $splat:ident, $add:ident, $($multiply:ident)+) => {
        /// Twelve vectors, each x ← x · a + b, `STEPS` times.
        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = $feature)]
        fn $steps(a: f64, b: f64) -> f64 {
            use std::arch::x86_64::*;
            let (a, b) = ($splat(a), $splat(b));
            // Different from one another, for otherwise one chain would do for all.
            let mut sums: [_; SUMS] = std::array::from_fn(|k| $splat(black_box(k as f64)));
            for _ in 0..STEPS {
                for sum in &mut sums {
                    *sum = at_level!(@step sum, a, b, $add, $($multiply)+);
                }
            }
            let mut total = $splat(0.0);
            for sum in sums {
                total = $add(total, sum);
            }
            let mut lanes = [0.0; $lanes];
            // SAFETY: the array has the vector's size; vectors of numbers have no other contents.
            unsafe { std::ptr::copy_nonoverlapping((&raw const total).cast(), lanes.as_mut_ptr(), $lanes) };
            lanes.iter().sum()
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = $feature)]
        fn $fill(tile: &mut [f64], value: f64) {
            fill::<$lanes>(tile, [value; $lanes]);
        }
    };
    (@step $x:ident, $a:ident, $b:ident, $add:ident, fused $multiply_add:ident) => {
        $multiply_add(*$x, $a, $b)
    };
    (@step $x:ident, $a:ident, $b:ident, $add:ident, plain $multiply:ident) => {
        $add($multiply(*$x, $a), $b)
    };
}
at_level!(steps_baseline, fill_baseline, 2, "sse2", _mm_set1_pd, _mm_add_pd, plain _mm_mul_pd);
at_level!(steps_avx2, fill_avx2, 4, "avx2,fma", _mm256_set1_pd, _mm256_add_pd, fused _mm256_fmadd_pd);
at_level!(
    steps_avx512,
    fill_avx512,
    8,
    "avx512f,avx512dq,avx512vl,avx2,fma",
    _mm512_set1_pd,
    _mm512_add_pd,
    fused _mm512_fmadd_pd
);

/// Numbers in a vector.
fn lanes(level: Dispatch) -> usize {
    match level {
        Dispatch::Baseline => 2,
        Dispatch::Avx2 => 4,
        Dispatch::Avx512 => 8,
    }
}

/// Seconds of the fastest of `ROUNDS`.
fn fastest(mut work: impl FnMut()) -> f64 {
    (0..ROUNDS)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}

/// The peak in 1e9 flops a second.
#[cfg(target_arch = "x86_64")]
fn peak(level: Dispatch) -> f64 {
    // Sums go to one, so that no number becomes subnormal.
    let seconds = fastest(|| {
        let (a, b) = (black_box(0.5), black_box(0.5));
        // SAFETY: the level is one of those that this processor has.
        black_box(unsafe {
            match level {
                Dispatch::Baseline => steps_baseline(a, b),
                Dispatch::Avx2 => steps_avx2(a, b),
                Dispatch::Avx512 => steps_avx512(a, b),
            }
        });
    });
    (2 * SUMS * STEPS * lanes(level)) as f64 / seconds / 1e9
}

/// Nanoseconds a sample of writing a tile of so many columns.
#[cfg(target_arch = "x86_64")]
fn writing(level: Dispatch, columns: usize) -> f64 {
    let mut tile = vec![0.0; columns * STRIDE];
    let seconds = fastest(|| {
        let value = black_box(1.0);
        // SAFETY: the level is one of those that this processor has.
        unsafe {
            match level {
                Dispatch::Baseline => fill_baseline(&mut tile, value),
                Dispatch::Avx2 => fill_avx2(&mut tile, value),
                Dispatch::Avx512 => fill_avx512(&mut tile, value),
            }
        }
        black_box(&mut tile);
    });
    seconds * 1e9 / SAMPLES as f64
}

#[cfg(not(target_arch = "x86_64"))]
fn main() {
    println!("skipped: the peak is measured with instructions of x86-64");
}

#[cfg(target_arch = "x86_64")]
fn main() {
    for (name, mdh) in ROBOTS {
        let chain = robot(name, mdh);
        for (case, destinations) in cases(&chain) {
            let operations = chain.operations(&destinations);
            let Operations { multiply_adds, additions, multiplications, others, loads, stores } = operations;
            println!(
                "{name}, {case}: {multiply_adds} multiply-adds, {additions} sums, {multiplications} products, \
                 {others} others; {} flops, {loads} numbers read, {stores} written",
                operations.flops()
            );
            let columns = destinations.iter().map(|d| d.wrapping_add(1)).max().unwrap_or(0) as usize;
            for level in Dispatch::available() {
                let [mut rate, mut write, mut here] = [0.0, f64::INFINITY, f64::INFINITY];
                for _ in 0..3 {
                    rate = peak(level).max(rate);
                    write = writing(level, columns).min(write);
                    here = time(level, &chain, &destinations)[0].min(here);
                }
                // Without fused instructions a multiply-add is two.
                let instructions = if level == Dispatch::Baseline {
                    operations.flops()
                } else {
                    multiply_adds + additions + multiplications
                };
                let instruction_rate = if level == Dispatch::Baseline { rate } else { rate / 2.0 };
                println!(
                    "  {:9} peak {rate:6.1} Gflop/s; kernel {here:6.1} ns, {:5.1} Gflop/s: {:4.1} % of the peak, \
                     {:4.1} % by instructions; writing alone {write:5.1} ns",
                    level.name(),
                    operations.flops() as f64 / here,
                    100.0 * operations.flops() as f64 / here / rate,
                    100.0 * instructions as f64 / instruction_rate / here,
                );
            }
        }
    }
}
