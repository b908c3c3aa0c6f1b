//! Across a prismatic joint: as [`super::motion`] across a revolute one, but in one form for all placements.

use super::lanes::Lanes;
use super::motion::{JointLanes, LinkMotion, Place, Rates, Twist};
use super::turn::{Any, Anywhere, Shifted, Turned, Vector};

/// v + ω × (0, 0, δ): the velocity of the origin that has slid by δ.
#[inline(always)]
fn slide<T: Lanes>([ox, oy, _]: &Vector<T>, v: &Vector<T>, slid: T) -> Vector<T> {
    [oy.mul_add(slid, v[0]), ox.neg_mul_add(slid, v[1]), v[2]]
}

#[inline(always)]
pub(super) fn slide_first_link<T: Lanes>(
    gravity_m_s2: [f64; 3],
    place: &Place,
    rates: &Rates<'_>,
    group: &[usize],
    links: &mut [LinkMotion<T>],
) {
    let zero = [T::splat(0.0); 3];
    let base = [T::splat(-gravity_m_s2[0]), T::splat(-gravity_m_s2[1]), T::splat(-gravity_m_s2[2])];
    let [ax, ay, az] = Any(place.rotation).in_joint(&base);
    for (link, first) in links.iter_mut().zip(group) {
        let (_, acceleration) = rates.at(*first);
        *link = LinkMotion { omega: zero, omega_dot: zero, accel: [ax, ay, az + acceleration] };
    }
}

/// Moves on to the motion of the next link: the origin accelerates with a + B (p + δ z) + 2 ω × δ̇ z + δ̈ z.
#[inline(always)]
pub(super) fn slide_next_link<T: Lanes>(
    place: &Place,
    rates: &Rates<'_>,
    group: &[usize],
    links: &mut [LinkMotion<T>],
) {
    let turn = Any(place.rotation);
    let [px, py, pz] = place.translation_m;
    let p = [T::splat(px), T::splat(py), T::splat(pz)];
    for (link, first) in links.iter_mut().zip(group) {
        let mut at_joint = link.accel;
        let b = link.derived().b;
        for r in 0..3 {
            at_joint[r] = b[r][0].mul_add(p[0], b[r][1].mul_add(p[1], b[r][2].mul_add(p[2], at_joint[r])));
        }
        let (rate, acceleration) = rates.at(*first);
        let slid = rates.slid(*first);
        let mut next = LinkMotion {
            omega: turn.in_joint(&link.omega),
            omega_dot: turn.in_joint(&link.omega_dot),
            accel: turn.in_joint(&at_joint),
        };
        let b = next.derived().b;
        let [ax, ay, az] = slide(&next.omega, &next.accel, rate + rate);
        next.accel =
            [b[0][2].mul_add(slid, ax), b[1][2].mul_add(slid, ay), b[2][2].mul_add(slid, az + acceleration)];
        *link = next;
    }
}

#[inline(always)]
pub(super) fn slide_carry<T: Lanes>(
    joints: &mut [JointLanes<T>],
    place: &Place,
    rates: &Rates<'_>,
    group: &[usize],
) {
    let turn = Any(place.rotation);
    let shift = Anywhere(place.translation_in_joint_m());
    for joint in joints {
        for (twist, first) in joint.twists.iter_mut().zip(group) {
            let omega = turn.in_joint(&twist.omega);
            let velocity = shift.swing(&omega, &turn.in_joint(&twist.velocity));
            *twist = Twist { omega, velocity: slide(&omega, &velocity, rates.slid(*first)) };
        }
    }
}

#[inline(always)]
pub(super) fn slide_carry_previous<T: Lanes>(
    previous: &mut JointLanes<T>,
    place: &Place,
    rates: &Rates<'_>,
    group: &[usize],
) {
    let ([ox, oy, oz], [vx, vy, vz]) = (place.previous_omega, place.previous_velocity);
    let omega = [T::splat(ox), T::splat(oy), T::splat(oz)];
    let velocity = [T::splat(vx), T::splat(vy), T::splat(vz)];
    for (twist, first) in previous.twists.iter_mut().zip(group) {
        *twist = Twist { omega, velocity: slide(&omega, &velocity, rates.slid(*first)) };
    }
}
