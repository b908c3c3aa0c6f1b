//! The batched regressor kernel: one source, compiled once per instruction set, chosen at run time.
//!
//! One lane is one sample. For each link i the motion of its frame follows from that of frame i − 1; the
//! unit twist of every joint j < i is carried along into frame i; and the 1 × 10 block of (joint j, link i)
//! is the projection of the link's 6 × 10 wrench regressor on that twist.

mod block;
mod lanes;
mod motion;
mod plan;
mod sine_cosine;
mod turn;

use aurt_traits::{Dispatch, MotionView, RegressorTile};

use crate::SerialChain;
use block::{other_blocks, own_block};
use lanes::{Lanes, Plain2};
use motion::{
    GROUP, JointLanes, LinkMotion, Rates, carry, carry_previous, first_link, joint_angles, next_link,
};
use plan::Plan;

pub(crate) use motion::Place;
pub(crate) use sine_cosine::sine_cosine_of;

/// Writes the wanted entries of the regressor for every sample of `motion`.
///
/// Lanes are independent of one another, so that where a sample stands in a batch does not change its bits.
pub(crate) fn evaluate(
    level: Dispatch,
    chain: &SerialChain,
    motion: MotionView<'_>,
    tile: &mut RegressorTile<'_>,
) {
    let plan = Plan::new(chain, motion, tile);
    let (_, stride, data) = tile.raw_mut();
    match level {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the processor has the features that the function was compiled for.
        Dispatch::Avx512 if level.is_available() => unsafe { evaluate_avx512(plan, stride, data) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Dispatch::Avx2 if level.is_available() => unsafe { evaluate_avx2(plan, stride, data) },
        _ => evaluate_lanes::<Plain2>(plan, stride, data),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
fn evaluate_avx512(plan: Plan<'_>, stride: usize, data: &mut [f64]) {
    evaluate_lanes::<lanes::Fused8>(plan, stride, data);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn evaluate_avx2(plan: Plan<'_>, stride: usize, data: &mut [f64]) {
    evaluate_lanes::<lanes::Fused4>(plan, stride, data);
}

/// Robots of up to this many joints need no memory from the heap, which would take longer to get than a few
/// samples take.
const FEW_JOINTS: usize = 8;

#[inline(always)]
fn evaluate_lanes<T: Lanes>(plan: Plan<'_>, stride: usize, data: &mut [f64]) {
    let samples = plan.samples;
    if plan.is_empty() {
        return;
    }
    let mut few = [JointLanes::<T>::zero(); FEW_JOINTS];
    let mut many = Vec::new();
    let joints = if plan.joints.len() <= FEW_JOINTS {
        &mut few[..plan.joints.len()]
    } else {
        many.resize(plan.joints.len(), JointLanes::zero());
        &mut many[..]
    };
    let mut links = [LinkMotion::zero(); GROUP];
    if samples < T::LANES {
        let padded = plan.padded_series(T::LANES);
        let (plan, targets) = plan.on_padded(&padded, T::LANES);
        let mut values = vec![0.0; targets.len() * T::LANES];
        evaluate_group(&plan, &[0], joints, &mut links, &mut values);
        for (target, lanes) in targets.iter().zip(values.chunks_exact(T::LANES)) {
            data[*target..target + samples].copy_from_slice(&lanes[..samples]);
        }
        return;
    }
    // First and last vector may overlap those between; what is written twice is the same.
    let last = samples - T::LANES;
    let mut next = samples_to_alignment::<T>(stride, data);
    let mut group = [0; GROUP];
    let mut used = usize::from(next > 0);
    loop {
        while used < GROUP && next < last {
            group[used] = next;
            next += T::LANES;
            used += 1;
        }
        let done = used < GROUP;
        if done {
            group[used] = last;
            used += 1;
        }
        evaluate_group(&plan, &group[..used], joints, &mut links, data);
        if done {
            return;
        }
        used = 0;
    }
}

/// How many samples there are before the first whose lanes start on a boundary of their own size in every
/// column; vectors across such a boundary take twice as long to write.
#[inline(always)]
fn samples_to_alignment<T: Lanes>(stride: usize, data: &[f64]) -> usize {
    let start = data.as_ptr() as usize / size_of::<f64>();
    if stride.is_multiple_of(T::LANES) { start.next_multiple_of(T::LANES) - start } else { 0 }
}

/// As many samples as there are lanes, from each of the samples `group` on.
#[inline(always)]
fn evaluate_group<T: Lanes>(
    plan: &Plan<'_>,
    group: &[usize],
    joints: &mut [JointLanes<T>],
    links: &mut [LinkMotion<T>; GROUP],
    data: &mut [f64],
) {
    for first in group {
        plan.assert_fits(first + T::LANES, data.len());
    }
    let to = data.as_mut_ptr();
    for ((lanes, joint), [position, ..]) in joints.iter_mut().zip(plan.joints).zip(&plan.series) {
        joint_angles(joint, position, group, &mut lanes.angles);
    }
    for (i, (joint, place)) in plan.joints.iter().zip(plan.places).enumerate() {
        let (before, here) = joints.split_at_mut(i);
        let angles = &here[0].angles[..group.len()];
        let [_, velocity, acceleration] = plan.series[i];
        let rates = Rates { sign: joint.sign, velocity, acceleration };
        match before.split_last_mut() {
            None => first_link(plan.gravity_m_s2, place, &rates, group, angles, links),
            Some((previous, earlier)) => {
                next_link(place, &rates, group, angles, links);
                carry(earlier, place, angles);
                carry_previous(previous, place, angles);
            }
        }
        let Some((own, others)) = plan.blocks_of(i).split_last() else { return };
        // SAFETY: `assert_fits` has compared the largest offset with the length of `data`.
        unsafe {
            other_blocks(links, before, others, group, to);
            own_block(links, joint.sign, *own, group, to);
        }
    }
}
