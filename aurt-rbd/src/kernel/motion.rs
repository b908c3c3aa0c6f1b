use super::lanes::Lanes;
use super::sine_cosine::sine_cosine;
use super::turn::{Shift, Shifted, Turn, Turned, Vector, with_shift, with_turn};
use crate::joint::{Joint, JointFrame, JointKind};

/// How many vectors of samples go through each step of the calculation side by side: the steps are chains of
/// dependent operations, and several of them keep the processor busy. More would not fit its fastest cache.
pub(super) const GROUP: usize = 6;

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Branching {
    /// Where the link's path begins among those of all links.
    pub path: usize,
    /// How many joints carry the link beside its own.
    pub depth: usize,
    /// The number of what is kept of this link: a joint other than the next sits on it.
    pub kept: Option<usize>,
    /// What was kept of the parent, which is not the link before.
    pub resumes: Option<usize>,
}

/// What the kernel needs of a joint's place on its parent link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    pub branching: Branching,
    /// What the joint does.
    pub kind: JointKind,
    turn: Turn,
    /// The same turn as a matrix, for prismatic joints: few robots have them, and one form of them is enough.
    pub rotation: [[f64; 3]; 3],
    /// The origin in the joint's own axes, as a [`Shift`].
    shift: Shift,
    /// The origin in the parent link's frame, in m.
    pub translation_m: [f64; 3],
    /// The unit twist of the parent link's joint, carried to this joint but not yet turned by its angle: the same
    /// in every sample.
    pub previous_omega: [f64; 3],
    pub previous_velocity: [f64; 3],
}

impl Place {
    /// The place of a joint on the link of the joint `previous`.
    pub fn new(kind: JointKind, frame: &JointFrame, previous: Option<&Joint>, branching: Branching) -> Self {
        let z = previous.map_or(1.0, |joint| joint.sign);
        let p = frame.translation_m;
        let (omega, velocity) = match previous.map(|joint| joint.kind) {
            Some(JointKind::Prismatic) => ([0.0; 3], [0.0, 0.0, z]),
            _ => ([0.0, 0.0, z], [-z * p[1], z * p[0], 0.0]),
        };
        let shift = transpose_times(&frame.rotation, p);
        // What is zero but for the rounding of the product is meant to be zero; the kernel's results do not
        // notice, its speed does.
        let dust = 4.0 * f64::EPSILON * p.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        Self {
            branching,
            kind,
            rotation: frame.rotation,
            turn: Turn::of(&frame.rotation),
            shift: Shift::of(shift.map(|v| if v.abs() <= dust { 0.0 } else { v })),
            translation_m: p,
            previous_omega: transpose_times(&frame.rotation, omega),
            previous_velocity: transpose_times(&frame.rotation, velocity),
        }
    }

    /// The origin in the joint's own axes, in m.
    #[inline(always)]
    pub fn translation_in_joint_m(&self) -> [f64; 3] {
        transpose_times(&self.rotation, self.translation_m)
    }
}

#[inline(always)]
fn transpose_times(r: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| r[0][c] * v[0] + r[1][c] * v[1] + r[2][c] * v[2])
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Angle<T> {
    sine: T,
    cosine: T,
}

impl<T: Lanes> Angle<T> {
    #[inline(always)]
    pub fn zero() -> Self {
        Self { sine: T::splat(0.0), cosine: T::splat(0.0) }
    }

    /// Rot_z(θ)ᵀ v.
    #[inline(always)]
    fn in_link(&self, [x, y, z]: Vector<T>) -> Vector<T> {
        [self.sine.mul_add(y, self.cosine * x), self.sine.neg_mul_add(x, self.cosine * y), z]
    }
}

/// A joint's rates about z (θ̇ and θ̈) or along z.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rates<'a> {
    pub sign: f64,
    pub position: &'a [f64],
    pub velocity: &'a [f64],
    pub acceleration: &'a [f64],
}

impl Rates<'_> {
    #[inline(always)]
    pub fn at<T: Lanes>(&self, first: usize) -> (T, T) {
        let sign = T::splat(self.sign);
        (T::load(&self.velocity[first..]) * sign, T::load(&self.acceleration[first..]) * sign)
    }

    /// How far a prismatic joint has slid.
    #[inline(always)]
    pub fn slid<T: Lanes>(&self, first: usize) -> T {
        T::load(&self.position[first..]) * T::splat(self.sign)
    }
}

/// The motion of a link frame, in that frame's coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct LinkMotion<T> {
    /// Angular velocity ω.
    pub omega: Vector<T>,
    /// Angular acceleration ω̇.
    pub omega_dot: Vector<T>,
    /// Acceleration of the frame's origin less gravity.
    pub accel: Vector<T>,
}

impl<T: Lanes> LinkMotion<T> {
    #[inline(always)]
    pub fn zero() -> Self {
        let zero = [T::splat(0.0); 3];
        Self { omega: zero, omega_dot: zero, accel: zero }
    }

    /// What follows from the motion; quicker to calculate twice than to keep.
    #[inline(always)]
    pub fn derived(&self) -> Derived<T> {
        let [wx, wy, wz] = self.omega;
        let [ax, ay, az] = self.omega_dot;
        let (xx, yy, zz) = (wx * wx, wy * wy, wz * wz);
        let (xy, xz, yz) = (wx * wy, wx * wz, wy * wz);
        Derived {
            b: [
                [-(yy + zz), xy - az, xz + ay],
                [xy + az, -(xx + zz), yz - ax],
                [xz - ay, yz + ax, -(xx + yy)],
            ],
            products: [xy, xz, yz],
            differences: [xx - yy, zz - xx, yy - zz],
        }
    }
}

/// What a link's wrench regressor is made of beside its [`LinkMotion`].
#[derive(Debug, Clone, Copy)]
pub(super) struct Derived<T> {
    /// B = [ω̇]× + [ω]×[ω]×, so that a point at r accelerates with `accel` + B r.
    pub b: [Vector<T>; 3],
    /// ω_x ω_y, ω_x ω_z, ω_y ω_z.
    pub products: [T; 3],
    /// ω_x² − ω_y², ω_z² − ω_x², ω_y² − ω_z².
    pub differences: [T; 3],
}

/// The velocity that a joint's unit velocity gives to a link frame, in that frame's coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct Twist<T> {
    pub omega: Vector<T>,
    /// Velocity of the frame's origin.
    pub velocity: Vector<T>,
}

impl<T: Lanes> Twist<T> {
    #[inline(always)]
    pub fn zero() -> Self {
        Self { omega: [T::splat(0.0); 3], velocity: [T::splat(0.0); 3] }
    }
}

/// The angles of a revolute joint at the samples from each of `group` on.
#[inline(always)]
pub(super) fn joint_angles<T: Lanes>(
    joint: &Joint,
    position: &[f64],
    group: &[usize],
    angles: &mut [Angle<T>],
) {
    if joint.kind == JointKind::Prismatic {
        return;
    }
    let (sign, offset) = (T::splat(joint.sign), T::splat(joint.theta_offset_rad));
    for (angle, first) in angles.iter_mut().zip(group) {
        let (sine, cosine) = sine_cosine(T::load(&position[*first..]).mul_add(sign, offset));
        *angle = Angle { sine, cosine };
    }
}

/// The motion of the first link, on a base at rest.
#[inline(always)]
pub(super) fn first_link<T: Lanes>(
    gravity_m_s2: [f64; 3],
    place: &Place,
    rates: &Rates<'_>,
    group: &[usize],
    angles: &[Angle<T>],
    links: &mut [LinkMotion<T>],
) {
    let zero = T::splat(0.0);
    let base = [T::splat(-gravity_m_s2[0]), T::splat(-gravity_m_s2[1]), T::splat(-gravity_m_s2[2])];
    with_turn!(place.turn, turn => {
        let base = turn.in_joint(&base);
        for ((link, angle), first) in links.iter_mut().zip(angles).zip(group) {
            let (rate, acceleration) = rates.at(*first);
            let accel = angle.in_link(base);
            *link = LinkMotion { omega: [zero, zero, rate], omega_dot: [zero, zero, acceleration], accel };
        }
    });
}

#[inline(always)]
pub(super) fn next_link<T: Lanes>(
    place: &Place,
    rates: &Rates<'_>,
    group: &[usize],
    angles: &[Angle<T>],
    links: &mut [LinkMotion<T>],
) {
    let p = place.translation_m;
    with_turn!(place.turn, turn => {
        for ((link, angle), first) in links.iter_mut().zip(angles).zip(group) {
            let mut at_joint = link.accel;
            let b = link.derived().b;
            for c in 0..3 {
                if p[c] != 0.0 {
                    let p = T::splat(p[c]);
                    for r in 0..3 {
                        at_joint[r] = b[r][c].mul_add(p, at_joint[r]);
                    }
                }
            }
            let (rate, acceleration) = rates.at(*first);
            let accel = angle.in_link(turn.in_joint(&at_joint));
            let [ox, oy, oz] = angle.in_link(turn.in_joint(&link.omega));
            let [dx, dy, dz] = angle.in_link(turn.in_joint(&link.omega_dot));
            let omega_dot = [oy.mul_add(rate, dx), ox.neg_mul_add(rate, dy), dz + acceleration];
            *link = LinkMotion { omega: [ox, oy, oz + rate], omega_dot, accel };
        }
    });
}

#[derive(Debug, Clone, Copy)]
pub(super) struct JointLanes<T> {
    pub angles: [Angle<T>; GROUP],
    /// In the link frame at work, the unit twists of that joint of the link's path which stands at this place in it; in
    /// a chain, of this joint.
    pub twists: [Twist<T>; GROUP],
}

impl<T: Lanes> JointLanes<T> {
    #[inline(always)]
    pub fn zero() -> Self {
        Self { angles: [Angle::zero(); GROUP], twists: [Twist::zero(); GROUP] }
    }
}

/// The state at a link from which further branches go on: its motion, and the twists of the joints before its own.
#[derive(Debug, Clone)]
pub(super) struct Kept<T> {
    links: [LinkMotion<T>; GROUP],
    twists: Vec<[Twist<T>; GROUP]>,
}

impl<T: Lanes> Kept<T> {
    /// Zeros for a link that `depth` joints carry beside its own, to be overwritten.
    #[inline(always)]
    pub fn zero(depth: usize) -> Self {
        Self { links: [LinkMotion::zero(); GROUP], twists: vec![[Twist::zero(); GROUP]; depth] }
    }

    #[inline(always)]
    pub fn keep(&mut self, links: &[LinkMotion<T>; GROUP], joints: &[JointLanes<T>]) {
        self.links = *links;
        for (kept, joint) in self.twists.iter_mut().zip(joints) {
            *kept = joint.twists;
        }
    }

    #[inline(always)]
    pub fn resume(&self, links: &mut [LinkMotion<T>; GROUP], joints: &mut [JointLanes<T>]) {
        *links = self.links;
        for (kept, joint) in self.twists.iter().zip(joints) {
            joint.twists = *kept;
        }
    }
}

/// Carries the twists of `joints` from the previous link frame into the next, across the joint at `place`.
#[inline(always)]
pub(super) fn carry<T: Lanes>(joints: &mut [JointLanes<T>], place: &Place, angles: &[Angle<T>]) {
    with_turn!(place.turn, turn => with_shift!(place.shift, shift => {
        for joint in joints {
            for (twist, angle) in joint.twists.iter_mut().zip(angles) {
                let omega = turn.in_joint(&twist.omega);
                let velocity = shift.swing(&omega, &turn.in_joint(&twist.velocity));
                twist.omega = angle.in_link(omega);
                twist.velocity = angle.in_link(velocity);
            }
        }
    }));
}

/// The twists of the joint before the one at `place`, carried across the latter.
#[inline(always)]
pub(super) fn carry_previous<T: Lanes>(previous: &mut JointLanes<T>, place: &Place, angles: &[Angle<T>]) {
    let [ox, oy, oz] = place.previous_omega;
    let [vx, vy, vz] = place.previous_velocity;
    let omega = [T::splat(ox), T::splat(oy), T::splat(oz)];
    let velocity = [T::splat(vx), T::splat(vy), T::splat(vz)];
    for (twist, angle) in previous.twists.iter_mut().zip(angles) {
        twist.omega = angle.in_link(omega);
        twist.velocity = angle.in_link(velocity);
    }
}
