use super::lanes::Lanes;
use super::sine_cosine::sine_cosine;
use crate::chain::{Joint, JointFrame};

/// A vector of three in the lanes.
pub(super) type Vector<T> = [T; 3];

#[inline(always)]
pub(super) fn dot<T: Lanes>(a: &Vector<T>, b: &Vector<T>) -> T {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

#[inline(always)]
pub(super) fn cross<T: Lanes>(a: &Vector<T>, b: &Vector<T>) -> Vector<T> {
    [
        a[2].neg_mul_add(b[1], a[1] * b[2]),
        a[0].neg_mul_add(b[2], a[2] * b[0]),
        a[1].neg_mul_add(b[0], a[0] * b[1]),
    ]
}

/// Sine and cosine of a joint's angle.
#[derive(Debug, Clone, Copy)]
pub(super) struct JointRotation<T> {
    sine: T,
    cosine: T,
}

impl<T: Lanes> JointRotation<T> {
    /// A vector of the previous link frame in the link's own: Rot_z(θ)ᵀ Rᵀ v.
    #[inline(always)]
    fn into_link(self, frame: &JointFrame, v: &Vector<T>) -> Vector<T> {
        let r = &frame.rotation;
        let in_joint = |c: usize| {
            T::splat(r[2][c]).mul_add(v[2], T::splat(r[1][c]).mul_add(v[1], T::splat(r[0][c]) * v[0]))
        };
        let [x, y, z] = [in_joint(0), in_joint(1), in_joint(2)];
        [self.sine.mul_add(y, self.cosine * x), self.sine.neg_mul_add(x, self.cosine * y), z]
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
    /// B = [ω̇]× + [ω]×[ω]×, so that a point at r accelerates with `accel` + B r.
    pub b: [Vector<T>; 3],
}

impl<T: Lanes> LinkMotion<T> {
    /// The base at rest.
    #[inline(always)]
    pub fn base(gravity_m_s2: [f64; 3]) -> Self {
        let zero = [T::splat(0.0); 3];
        let accel = gravity_m_s2.map(|g| T::splat(-g));
        Self { omega: zero, omega_dot: zero, accel, b: [zero; 3] }
    }

    /// Moves on to the next link, across its joint at position q with velocity q̇ and acceleration q̈.
    #[inline(always)]
    pub fn advance(&mut self, frame: &JointFrame, joint: &Joint, q: T, qd: T, qdd: T) -> JointRotation<T> {
        let sign = T::splat(joint.sign);
        let (sine, cosine) = sine_cosine(q.mul_add(sign, T::splat(joint.theta_offset_rad)));
        let (qd, qdd) = (qd * sign, qdd * sign);
        let rotation = JointRotation { sine, cosine };
        let p = frame.translation_m.map(T::splat);
        let at_joint: Vector<T> = std::array::from_fn(|r| self.accel[r] + dot(&self.b[r], &p));
        self.accel = rotation.into_link(frame, &at_joint);

        let omega = rotation.into_link(frame, &self.omega);
        let omega_dot = rotation.into_link(frame, &self.omega_dot);
        self.omega_dot =
            [omega[1].mul_add(qd, omega_dot[0]), omega[0].neg_mul_add(qd, omega_dot[1]), omega_dot[2] + qdd];
        self.omega = [omega[0], omega[1], omega[2] + qd];

        let [wx, wy, wz] = self.omega;
        let [ax, ay, az] = self.omega_dot;
        let (xx, yy, zz) = (wx * wx, wy * wy, wz * wz);
        let (xy, xz, yz) = (wx * wy, wx * wz, wy * wz);
        self.b =
            [[-(yy + zz), xy - az, xz + ay], [xy + az, -(xx + zz), yz - ax], [xz - ay, yz + ax, -(xx + yy)]];
        rotation
    }
}

/// The velocity that a joint's unit velocity gives to a link frame, in that frame's coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct Twist<T> {
    /// Angular velocity.
    pub omega: Vector<T>,
    /// Velocity of the frame's origin.
    pub velocity: Vector<T>,
}

impl<T: Lanes> Twist<T> {
    /// No motion.
    #[inline(always)]
    pub fn zero() -> Self {
        Self { omega: [T::splat(0.0); 3], velocity: [T::splat(0.0); 3] }
    }

    /// The twist of a joint in the frame of its own link.
    #[inline(always)]
    pub fn own(sign: f64) -> Self {
        let zero = T::splat(0.0);
        Self { omega: [zero, zero, T::splat(sign)], velocity: [zero; 3] }
    }
}

/// A twist of the previous link frame, carried into the next.
#[inline(always)]
pub(super) fn carry<T: Lanes>(twist: &Twist<T>, frame: &JointFrame, rotation: &JointRotation<T>) -> Twist<T> {
    let swing = cross(&twist.omega, &frame.translation_m.map(T::splat));
    let velocity: Vector<T> = std::array::from_fn(|r| twist.velocity[r] + swing[r]);
    Twist { omega: rotation.into_link(frame, &twist.omega), velocity: rotation.into_link(frame, &velocity) }
}
