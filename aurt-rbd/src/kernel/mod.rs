//! The batched regressor kernel: one source, compiled once per instruction set, chosen at run time.
//!
//! One lane is one sample. For each link i the motion of its frame follows from that of its parent's frame; the
//! unit twist of every joint j on the path to link i is carried along into frame i; and the 1 × 10 block of (joint j,
//! link i) is the projection of the link's 6 × 10 wrench regressor on that twist. Blocks of joints that do not carry the
//! link are zero and never written.

mod block;
mod lanes;
mod motion;
mod plan;
mod sine_cosine;
mod slide;
mod torque;
mod turn;

use aurt_traits::{Dispatch, MotionView, RegressorTile};

use crate::{JointKind, SerialChain};
use block::{other_blocks, own_block, own_slide_block};
use lanes::{Lanes, Plain2};
use motion::{
    GROUP, JointLanes, Kept, LinkMotion, Rates, carry, carry_previous, first_link, joint_angles, next_link,
};
use plan::Plan;
use slide::{slide_carry, slide_carry_previous, slide_first_link, slide_next_link};

pub(crate) use block::possible_entries;
pub(crate) use motion::{Branching, Place};

pub(crate) use sine_cosine::sine_cosine_of;
pub(crate) use torque::torque;

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
    let mut kept = plan.kept();
    // Too few samples for the lanes are filled up, worked on beside the tile and copied into it. One loop serves both
    // cases: everything in it is compiled for each place that it stands at.
    let few_samples = samples < T::LANES;
    let padded = if few_samples { plan.padded_series(T::LANES) } else { Vec::new() };
    let (plan, targets) = if few_samples { plan.on_padded(&padded, T::LANES) } else { (plan, Vec::new()) };
    let mut values = vec![0.0; targets.len() * T::LANES];
    let aligned = if few_samples { 0 } else { samples_to_alignment::<T>(stride, data) };
    let columns = if few_samples { &mut values[..] } else { &mut *data };
    let mut groups = Groups::new(plan.samples, T::LANES, aligned);
    while let Some(group) = groups.next() {
        evaluate_group(&plan, group, joints, &mut links, &mut kept, columns);
    }
    for (target, lanes) in targets.iter().zip(values.chunks_exact(T::LANES)) {
        data[*target..target + samples].copy_from_slice(&lanes[..samples]);
    }
}

/// First samples of the vectors of samples that are worked on together.
///
/// First and last vector may overlap those between; what is written twice is the same.
struct Groups {
    group: [usize; GROUP],
    next: usize,
    last: usize,
    lanes: usize,
    begun: bool,
    done: bool,
}

impl Groups {
    /// Groups of vectors of `lanes` of the samples, of which there are at least as many; all but the first and last
    /// vector start whole vectors behind sample `aligned`.
    #[inline(always)]
    const fn new(samples: usize, lanes: usize, aligned: usize) -> Self {
        Self {
            group: [0; GROUP],
            next: aligned,
            last: samples - lanes,
            lanes,
            begun: aligned == 0,
            done: false,
        }
    }

    #[inline(always)]
    fn next(&mut self) -> Option<&[usize]> {
        if self.done {
            return None;
        }
        let mut used = 0;
        if !self.begun {
            self.begun = true;
            self.group[0] = 0;
            used = 1;
        }
        while used < GROUP && self.next < self.last {
            self.group[used] = self.next;
            self.next += self.lanes;
            used += 1;
        }
        if used < GROUP {
            self.group[used] = self.last;
            self.done = true;
            used += 1;
        }
        Some(&self.group[..used])
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
    kept: &mut [Kept<T>],
    data: &mut [f64],
) {
    for first in group {
        plan.assert_fits(first + T::LANES, data.len());
    }
    let to = data.as_mut_ptr();
    for ((lanes, joint), [position, ..]) in joints.iter_mut().zip(plan.joints).zip(&plan.series) {
        joint_angles(joint, position, group, &mut lanes.angles);
    }
    for (i, joint) in plan.joints.iter().enumerate() {
        advance(plan, i, group, joints, links, kept);
        let Some((own, others)) = plan.blocks_of(i).split_last() else { return };
        // SAFETY: `assert_fits` has compared the largest offset with the length of `data`.
        unsafe {
            other_blocks(links, &joints[..others.len()], others, group, to);
            match joint.kind {
                JointKind::Revolute => own_block(links, joint.sign, *own, group, to),
                JointKind::Prismatic => own_slide_block(links, joint.sign, *own, group, to),
            }
        }
    }
}

/// From the parent link to link i: its motion, and the twists of the joints on its path in its frame.
#[inline(always)]
fn advance<T: Lanes>(
    plan: &Plan<'_>,
    i: usize,
    group: &[usize],
    joints: &mut [JointLanes<T>],
    links: &mut [LinkMotion<T>; GROUP],
    kept: &mut [Kept<T>],
) {
    let place = &plan.places[i];
    if let Some(number) = place.branching.resumes {
        kept[number].resume(links, joints);
    }
    cross(plan, i, group, joints, links);
    if let Some(number) = place.branching.kept {
        kept[number].keep(links, joints);
    }
}

/// Across joint i, with the motion of the parent link and the twists in its frame at work.
#[inline(always)]
fn cross<T: Lanes>(
    plan: &Plan<'_>,
    i: usize,
    group: &[usize],
    joints: &mut [JointLanes<T>],
    links: &mut [LinkMotion<T>; GROUP],
) {
    let place = &plan.places[i];
    let (before, here) = joints.split_at_mut(i);
    let before = &mut before[..place.branching.depth];
    let angles = &here[0].angles[..group.len()];
    let [position, velocity, acceleration] = plan.series[i];
    let rates = Rates { sign: plan.joints[i].sign, position, velocity, acceleration };
    if place.kind == JointKind::Prismatic {
        match before.split_last_mut() {
            None => slide_first_link(plan.gravity_m_s2, place, &rates, group, links),
            Some((previous, earlier)) => {
                slide_next_link(place, &rates, group, links);
                slide_carry(earlier, place, &rates, group);
                slide_carry_previous(previous, place, &rates, group);
            }
        }
        return;
    }
    match before.split_last_mut() {
        None => first_link(plan.gravity_m_s2, place, &rates, group, angles, links),
        Some((previous, earlier)) => {
            next_link(place, &rates, group, angles, links);
            carry(earlier, place, angles);
            carry_previous(previous, place, angles);
        }
    }
}
