//! The batched regressor kernel: one source, compiled once per instruction set, chosen at run time.
//!
//! One lane is one sample. For each link i the motion of its frame follows from that of frame i − 1; the
//! unit twist of every joint j ≤ i is carried along into frame i; and the 1 × 10 block of (joint j, link i)
//! is the projection of the link's 6 × 10 wrench regressor on that twist.

mod block;
pub(crate) mod dispatch;
pub(crate) mod lanes;
mod motion;
pub(crate) mod sine_cosine;

use aurt_traits::{MotionView, RegressorTile};

use crate::SerialChain;
use block::{Destination, other_block, own_block};
use dispatch::Dispatch;
use lanes::{Lanes, Plain2};
use motion::{LinkMotion, Twist, carry};

/// Writes the wanted entries of the regressor for every sample of `motion`.
pub(crate) fn evaluate(
    level: Dispatch,
    chain: &SerialChain,
    motion: MotionView<'_>,
    tile: &mut RegressorTile<'_>,
) {
    match level {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the processor has the features that the function was compiled for.
        Dispatch::Avx512 if level.is_available() => unsafe { evaluate_avx512(chain, motion, tile) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Dispatch::Avx2 if level.is_available() => unsafe { evaluate_avx2(chain, motion, tile) },
        _ => evaluate_lanes::<Plain2>(chain, motion, tile),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
fn evaluate_avx512(chain: &SerialChain, motion: MotionView<'_>, tile: &mut RegressorTile<'_>) {
    evaluate_lanes::<lanes::Fused8>(chain, motion, tile);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn evaluate_avx2(chain: &SerialChain, motion: MotionView<'_>, tile: &mut RegressorTile<'_>) {
    evaluate_lanes::<lanes::Fused4>(chain, motion, tile);
}

#[inline(always)]
fn evaluate_lanes<T: Lanes>(chain: &SerialChain, motion: MotionView<'_>, tile: &mut RegressorTile<'_>) {
    let samples = motion.samples();
    let parameters = tile.parameters();
    let (destinations, stride, data) = tile.raw_mut();
    let frames = chain.frames();
    let mut twists = vec![Twist::<T>::zero(); frames.len()];
    let mut first = 0;
    while first < samples {
        let valid = (samples - first).min(T::LANES);
        let mut link = LinkMotion::<T>::base(chain.gravity_m_s2());
        for (i, (frame, joint)) in frames.iter().zip(chain.joints()).enumerate() {
            let series = |values: &[f64]| load_padded::<T>(&values[first..], valid);
            let rotation = link.advance(
                frame,
                joint,
                series(motion.position_rad(i)),
                series(motion.velocity_rad_s(i)),
                series(motion.acceleration_rad_s2(i)),
            );
            for (j, twist) in twists[..i].iter_mut().enumerate() {
                *twist = carry(twist, frame, &rotation);
                let start = j * parameters + 10 * i;
                let mut to = Destination { of: &destinations[start..start + 10], stride, first, valid, data };
                other_block(&link, twist, &mut to);
            }
            twists[i] = Twist::own(joint.sign);
            let start = i * parameters + 10 * i;
            let mut to = Destination { of: &destinations[start..start + 10], stride, first, valid, data };
            own_block(&link, joint.sign, i == 0, &mut to);
        }
        first += T::LANES;
    }
}

/// The next samples of a series; lanes beyond its end repeat the last sample.
#[inline(always)]
fn load_padded<T: Lanes>(values: &[f64], valid: usize) -> T {
    if valid == T::LANES {
        return T::load(values);
    }
    let mut padded = [values[valid - 1]; 8];
    padded[..valid].copy_from_slice(&values[..valid]);
    T::load(&padded)
}
