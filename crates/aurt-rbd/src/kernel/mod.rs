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
mod turn;
#[cfg(target_arch = "x86_64")]
pub(crate) mod x86;

use aurt_traits::{MotionView, RegressorTile};

use crate::{INERTIAL_PARAMETERS, SerialChain};
use block::{UNWANTED, other_block, own_block};
use dispatch::Dispatch;
use lanes::Lanes;
use motion::{JointState, LinkMotion, Place, Twist, carry};

/// What every processor of the target can run.
#[cfg(target_arch = "x86_64")]
type Baseline = x86::Sse2;
#[cfg(not(target_arch = "x86_64"))]
type Baseline = lanes::Array2;

/// Writes the wanted entries of the regressor for every sample of `motion`.
///
/// Lanes are independent of one another, so that where samples stand in a batch does not change their bits.
pub(crate) fn evaluate(
    level: Dispatch,
    chain: &SerialChain,
    motion: MotionView<'_>,
    tile: &mut RegressorTile<'_>,
) {
    let (samples, joints) = (motion.samples(), motion.joints());
    let (destinations, stride, data) = tile.raw_mut();
    let offsets = destinations
        .iter()
        .map(|d| if *d == RegressorTile::UNWANTED { UNWANTED } else { *d as usize * stride })
        .collect();
    let places = (0..joints)
        .map(|j| Place::new(&chain.frames()[j], if j == 0 { 1.0 } else { chain.joints()[j - 1].sign }))
        .collect();
    let series = (0..joints)
        .map(|j| [motion.position_rad(j), motion.velocity_rad_s(j), motion.acceleration_rad_s2(j)])
        .collect();
    let work = Work { chain, places, offsets, series, samples };
    match level {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: the processor has the features that the function was compiled for.
        Dispatch::Avx512 if level.is_available() => unsafe { evaluate_avx512(work, data) },
        #[cfg(target_arch = "x86_64")]
        // SAFETY: as above.
        Dispatch::Avx2 if level.is_available() => unsafe { evaluate_avx2(work, data) },
        _ => evaluate_lanes::<Baseline>(work, data),
    }
}

/// One call's input, prepared for the lanes.
struct Work<'a> {
    chain: &'a SerialChain,
    places: Vec<Place>,
    /// Where each (joint, parameter) entry's column starts in the tile.
    offsets: Vec<usize>,
    /// Position, velocity and acceleration of each joint.
    series: Vec<[&'a [f64]; 3]>,
    samples: usize,
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
fn evaluate_avx512(work: Work<'_>, data: &mut [f64]) {
    evaluate_lanes::<x86::Avx512>(work, data);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn evaluate_avx2(work: Work<'_>, data: &mut [f64]) {
    evaluate_lanes::<x86::Avx2>(work, data);
}

#[inline(always)]
fn evaluate_lanes<T: Lanes>(work: Work<'_>, data: &mut [f64]) {
    let mut scratch = Scratch::<T>::new(work.places.len());
    if work.samples >= T::LANES {
        let last = work.samples - T::LANES;
        let mut first = 0;
        while first < last {
            evaluate_batch(&work, first, &mut scratch, data);
            first += T::LANES;
        }
        // The last lanes may overlap those before; what is written twice is the same.
        evaluate_batch(&work, last, &mut scratch, data);
    } else if work.samples > 0 {
        evaluate_few(work, &mut scratch, data);
    }
}

/// Fewer samples than lanes: the work is done on copies of full length.
#[inline(always)]
fn evaluate_few<T: Lanes>(mut work: Work<'_>, scratch: &mut Scratch<T>, data: &mut [f64]) {
    let samples = work.samples;
    let mut padded = vec![0.0; 3 * work.series.len() * T::LANES];
    for (series, padded) in work.series.iter().flatten().zip(padded.chunks_exact_mut(T::LANES)) {
        padded[..samples].copy_from_slice(series);
    }
    let mut values = Vec::new();
    let mut targets = Vec::new();
    for offset in work.offsets.iter_mut().filter(|offset| **offset != UNWANTED) {
        targets.push(*offset);
        *offset = values.len();
        values.resize(values.len() + T::LANES, 0.0);
    }
    let series = padded
        .chunks_exact(3 * T::LANES)
        .map(|s| [&s[..T::LANES], &s[T::LANES..2 * T::LANES], &s[2 * T::LANES..]])
        .collect();
    evaluate_batch(&Work { series, ..work }, 0, scratch, &mut values);
    for (target, lanes) in targets.iter().zip(values.chunks_exact(T::LANES)) {
        data[*target..target + samples].copy_from_slice(&lanes[..samples]);
    }
}

/// As many samples as there are lanes, from sample `first` on.
#[inline(always)]
fn evaluate_batch<T: Lanes>(work: &Work<'_>, first: usize, scratch: &mut Scratch<T>, data: &mut [f64]) {
    let joints = work.chain.joints();
    let parameters = INERTIAL_PARAMETERS * joints.len();
    let Scratch { states, links, twists } = scratch;
    for (state, ([q, qd, qdd], joint)) in states.iter_mut().zip(work.series.iter().zip(joints)) {
        *state = JointState::new(joint, T::load(&q[first..]), T::load(&qd[first..]), T::load(&qdd[first..]));
    }
    links[0] = LinkMotion::first(work.chain.gravity_m_s2(), &work.places[0], &states[0]);
    for i in 0..joints.len() {
        // The next link's motion comes first: it is one long chain of dependent operations, in whose
        // shadow the blocks of this link are calculated.
        if i + 1 < joints.len() {
            links[(i + 1) % 2] = links[i % 2].next(&work.places[i + 1], &states[i + 1]);
        }
        if i > 0 {
            carry(&mut twists[..i - 1], &work.places[i], &states[i]);
            twists[i - 1] = Twist::of_previous(&work.places[i], &states[i]);
        }
        let link = &links[i % 2];
        for (j, twist) in twists[..i].iter().enumerate() {
            if let Some((block, _)) =
                work.offsets[j * parameters + INERTIAL_PARAMETERS * i..].split_first_chunk()
            {
                other_block(link, twist, block, first, data);
            }
        }
        if let Some((block, _)) = work.offsets[i * parameters + INERTIAL_PARAMETERS * i..].split_first_chunk()
        {
            own_block(link, joints[i].sign, i == 0, block, first, data);
        }
    }
}

/// What the calculation of one batch remembers.
struct Scratch<T> {
    states: Vec<JointState<T>>,
    /// The link at work and the next one, by turns.
    links: [LinkMotion<T>; 2],
    /// The twists of all joints before the link at work.
    twists: Vec<Twist<T>>,
}

impl<T: Lanes> Scratch<T> {
    #[inline(always)]
    fn new(joints: usize) -> Self {
        let link = LinkMotion::zero();
        Self {
            states: vec![JointState::zero(); joints],
            links: [link, link],
            twists: vec![Twist::zero(); joints],
        }
    }
}
