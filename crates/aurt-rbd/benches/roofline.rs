//! How near the regressor kernel comes to what one core can do.
//!
//! `cargo bench -p aurt-rbd --bench roofline`
//!
//! For every instruction set: the peak of multiply-adds (independent chains in registers), the rate at which a tile can
//! be written, and what the kernel reaches of either, in one run. The kernel's operations and bytes per evaluation are
//! those of a UR10e, counted by the kernel's unit test `work_of_an_evaluation_of_a_ur10e`. The fastest of many short
//! rounds counts.
#![expect(clippy::expect_used, reason = "the robot is a constant")]

use std::hint::black_box;
use std::time::Instant;

use aurt_rbd::{Dispatch, MdhRows, MdhTable, SerialChain};
use aurt_traits::{Motion, RegressorTile, RigidBodyRegressor};

const UR10E: &str =
    "alpha,a,d\npi/2,0,0.1807\n0,-0.6127,0\n0,-0.57155,0\npi/2,0,0.17415\n-pi/2,0,0.11985\n0,0,0.11655\n";
const SAMPLES: usize = 256;
const STRIDE: usize = SAMPLES + 8;
const ROUNDS: usize = 2001;
/// Floating-point operations and entries of an evaluation; a multiply-add counts two.
const OPERATIONS: f64 = 0.0;
const ENTRIES: usize = 0;
/// Chains of multiply-adds that do not depend on one another.
const CHAINS: usize = 12;
const STEPS: usize = 2000;

/// Seconds of the fastest round.
fn fastest(mut work: impl FnMut()) -> f64 {
    (0..ROUNDS)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}

#[inline(always)]
fn chains<const FUSED: bool, const LANES: usize>(factor: f64, offset: f64) -> f64 {
    let mut sums = [[1.0_f64; LANES]; CHAINS];
    for _ in 0..STEPS {
        for sum in &mut sums {
            for lane in sum {
                *lane = if FUSED { lane.mul_add(factor, offset) } else { *lane * factor + offset };
            }
        }
    }
    sums.iter().flatten().sum()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
fn chains_avx512(factor: f64, offset: f64) -> f64 {
    chains::<true, 8>(factor, offset)
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn chains_avx2(factor: f64, offset: f64) -> f64 {
    chains::<true, 4>(factor, offset)
}

/// Operations per nanosecond of one core.
fn peak(level: Dispatch) -> f64 {
    let lanes = match level {
        Dispatch::Baseline => 2,
        Dispatch::Avx2 => 4,
        Dispatch::Avx512 => 8,
    };
    let seconds = fastest(|| {
        let (factor, offset) = black_box((0.999, 0.001));
        black_box(match level {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: only levels that this processor has are asked for.
            Dispatch::Avx512 => unsafe { chains_avx512(factor, offset) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Dispatch::Avx2 => unsafe { chains_avx2(factor, offset) },
            _ => chains::<false, 2>(factor, offset),
        });
    });
    (2 * CHAINS * STEPS * lanes) as f64 / seconds * 1e-9
}

/// Nanoseconds per sample of the kernel; `destinations` in a tile.
fn kernel(level: Dispatch, chain: &SerialChain, destinations: &[u32], columns: usize) -> f64 {
    let series = |reach: f64| -> Vec<f64> {
        (0..6 * SAMPLES).map(|k| reach * (2.0 * (k as f64 * 0.618_033_988_749_894_9).fract() - 1.0)).collect()
    };
    let motion =
        Motion::new(6, vec![0.0; SAMPLES], series(3.0), series(2.0), series(10.0)).expect("lengths fit");
    let mut data = vec![0.0; columns * STRIDE];
    let seconds = fastest(|| {
        let mut tile = RegressorTile::new(destinations, 60, SAMPLES, STRIDE, &mut data);
        chain.evaluate_on(level, black_box(motion.view()), &mut tile);
        black_box(&mut data);
    });
    seconds / SAMPLES as f64 * 1e9
}

fn main() {
    let table = MdhTable::parse(UR10E, "ur10e", MdhRows::Next).expect("a constant table");
    let chain = SerialChain::from_mdh(&table, [0.0, 0.0, -9.81]).expect("a constant chain");
    let mut next = 0;
    let stored: Vec<u32> = (0..360)
        .map(|entry| {
            if !chain.loads(entry % 60, entry / 60) {
                return RegressorTile::UNWANTED;
            }
            next += 1;
            next - 1
        })
        .collect();
    let in_cache: Vec<u32> =
        stored.iter().map(|d| if *d == RegressorTile::UNWANTED { *d } else { d % 10 }).collect();
    let mut tile = vec![0.0_f64; ENTRIES * STRIDE];
    let mut value = 0.0;
    let filling = fastest(|| {
        value += 1.0;
        tile.fill(black_box(value));
        black_box(&mut tile);
    });
    let writing = (tile.len() * size_of::<f64>()) as f64 / filling * 1e-9;
    let bytes = (ENTRIES * size_of::<f64>()) as f64;
    println!(
        "{OPERATIONS} operations and {bytes} bytes written per evaluation: {:.2} operations a byte",
        OPERATIONS / bytes
    );
    println!("a tile of {:.0} kB is filled at {writing:.1} GB/s", tile.len() as f64 * 8e-3);
    for level in Dispatch::available() {
        let peak = peak(level);
        let [cached, stored] =
            [kernel(level, &chain, &in_cache, 10), kernel(level, &chain, &stored, ENTRIES)];
        let (calculated, written) = (OPERATIONS / peak, bytes / writing);
        println!(
            "{:9} peak {peak:5.1} Gflop/s; limits {calculated:.1} ns calculating, {written:.1} ns writing; in cache {cached:.1} ns = \
             {:.0} % of peak; stored {stored:.1} ns = {:.0} % of peak, {:.1} GB/s",
            level.name(),
            100.0 * calculated / cached,
            100.0 * calculated / stored,
            bytes / stored
        );
    }
}
