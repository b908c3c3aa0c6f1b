use super::lanes::Lanes;
use super::sine_cosine::sine_cosine;
use super::turn::{AboutX, Any, Down, Straight, Turn, Turned, Up, Vector};
use crate::chain::{Joint, JointFrame};

/// What the kernel needs of a joint's place: its constant turn and where its origin is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    turn: Turn,
    translation_m: [f64; 3],
    /// The unit twist of the previous joint, carried to this joint but not yet turned by its angle: the same
    /// in every sample.
    previous_omega: [f64; 3],
    previous_velocity: [f64; 3],
}

impl Place {
    /// The place of a joint behind one whose sense is `previous_sign`.
    pub fn new(frame: &JointFrame, previous_sign: f64) -> Self {
        let [px, py, _] = frame.translation_m;
        let z = previous_sign;
        Self {
            turn: Turn::of(frame),
            translation_m: frame.translation_m,
            previous_omega: transpose_times(&frame.rotation, [0.0, 0.0, z]),
            previous_velocity: transpose_times(&frame.rotation, [-z * py, z * px, 0.0]),
        }
    }
}

/// Rᵀ v.
fn transpose_times(r: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|c| r[0][c] * v[0] + r[1][c] * v[1] + r[2][c] * v[2])
}

/// Runs `$body` with `$turn` bound to the compile-time form of a [`Turn`], so that the choice is made once
/// per link and not once per vector.
macro_rules! with_turn {
    ($place:expr, $turn:ident => $body:expr) => {
        match $place.turn {
            Turn::Straight => {
                let $turn = Straight;
                $body
            }
            Turn::Up => {
                let $turn = Up;
                $body
            }
            Turn::Down => {
                let $turn = Down;
                $body
            }
            Turn::AboutX(cosine, sine) => {
                let $turn = AboutX(cosine, sine);
                $body
            }
            Turn::Any(matrix) => {
                let $turn = Any(matrix);
                $body
            }
        }
    };
}

/// The state of a joint in the lanes: sine and cosine of its angle, its rate and acceleration about z.
#[derive(Debug, Clone, Copy)]
pub(super) struct JointState<T> {
    sine: T,
    cosine: T,
    rate: T,
    acceleration: T,
}

impl<T: Lanes> JointState<T> {
    /// At rest at the angle 0, but for the cosine.
    #[inline(always)]
    pub fn zero() -> Self {
        let zero = T::splat(0.0);
        Self { sine: zero, cosine: zero, rate: zero, acceleration: zero }
    }

    #[inline(always)]
    pub fn new(joint: &Joint, q: T, qd: T, qdd: T) -> Self {
        let sign = T::splat(joint.sign);
        let (sine, cosine) = sine_cosine(q.mul_add(sign, T::splat(joint.theta_offset_rad)));
        Self { sine, cosine, rate: qd * sign, acceleration: qdd * sign }
    }

    /// Rot_z(θ)ᵀ v.
    #[inline(always)]
    fn into_link(&self, [x, y, z]: Vector<T>) -> Vector<T> {
        [self.sine.mul_add(y, self.cosine * x), self.sine.neg_mul_add(x, self.cosine * y), z]
    }
}

/// The motion of a link frame, in that frame's coordinates, and what its wrench regressor is made of.
#[derive(Debug, Clone, Copy)]
pub(super) struct LinkMotion<T> {
    /// Angular velocity ω.
    omega: Vector<T>,
    /// Angular acceleration ω̇.
    pub omega_dot: Vector<T>,
    /// Acceleration of the frame's origin less gravity.
    pub accel: Vector<T>,
    /// B = [ω̇]× + [ω]×[ω]×, so that a point at r accelerates with `accel` + B r.
    pub b: [Vector<T>; 3],
    /// ω_x ω_y, ω_x ω_z, ω_y ω_z.
    pub products: [T; 3],
    /// ω_x² − ω_y², ω_z² − ω_x², ω_y² − ω_z².
    pub differences: [T; 3],
}

impl<T: Lanes> LinkMotion<T> {
    /// At rest without gravity.
    #[inline(always)]
    pub fn zero() -> Self {
        let zero = [T::splat(0.0); 3];
        Self { omega: zero, omega_dot: zero, accel: zero, b: [zero; 3], products: zero, differences: zero }
    }

    /// The first link, on a base at rest.
    #[inline(always)]
    pub fn first(gravity_m_s2: [f64; 3], place: &Place, state: &JointState<T>) -> Self {
        let zero = T::splat(0.0);
        let base = [T::splat(-gravity_m_s2[0]), T::splat(-gravity_m_s2[1]), T::splat(-gravity_m_s2[2])];
        let accel = with_turn!(place, turn => state.into_link(turn.into_joint(&base)));
        Self::from_rates([zero, zero, state.rate], [zero, zero, state.acceleration], accel)
    }

    /// The next link, across its joint.
    #[inline(always)]
    pub fn next(&self, place: &Place, state: &JointState<T>) -> Self {
        let mut at_joint = self.accel;
        for c in 0..3 {
            if place.translation_m[c] != 0.0 {
                let p = T::splat(place.translation_m[c]);
                for r in 0..3 {
                    at_joint[r] = self.b[r][c].mul_add(p, at_joint[r]);
                }
            }
        }
        with_turn!(place, turn => {
            let accel = state.into_link(turn.into_joint(&at_joint));
            let [ox, oy, oz] = state.into_link(turn.into_joint(&self.omega));
            let [dx, dy, dz] = state.into_link(turn.into_joint(&self.omega_dot));
            let rate = state.rate;
            let omega_dot = [oy.mul_add(rate, dx), ox.neg_mul_add(rate, dy), dz + state.acceleration];
            Self::from_rates([ox, oy, oz + rate], omega_dot, accel)
        })
    }

    #[inline(always)]
    fn from_rates(omega: Vector<T>, omega_dot: Vector<T>, accel: Vector<T>) -> Self {
        let [wx, wy, wz] = omega;
        let [ax, ay, az] = omega_dot;
        let (xx, yy, zz) = (wx * wx, wy * wy, wz * wz);
        let (xy, xz, yz) = (wx * wy, wx * wz, wy * wz);
        let b =
            [[-(yy + zz), xy - az, xz + ay], [xy + az, -(xx + zz), yz - ax], [xz - ay, yz + ax, -(xx + yy)]];
        Self { omega, omega_dot, accel, b, products: [xy, xz, yz], differences: [xx - yy, zz - xx, yy - zz] }
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

    /// The twist of the joint before the one at `place`, carried across the latter.
    #[inline(always)]
    pub fn of_previous(place: &Place, state: &JointState<T>) -> Self {
        let [ox, oy, oz] = place.previous_omega;
        let [vx, vy, vz] = place.previous_velocity;
        Self {
            omega: state.into_link([T::splat(ox), T::splat(oy), T::splat(oz)]),
            velocity: state.into_link([T::splat(vx), T::splat(vy), T::splat(vz)]),
        }
    }
}

/// Carries twists of the previous link frame into the next, across the joint at `place`.
#[inline(always)]
pub(super) fn carry<T: Lanes>(twists: &mut [Twist<T>], place: &Place, state: &JointState<T>) {
    let [px, py, pz] = place.translation_m;
    with_turn!(place, turn => {
        for twist in twists {
            let [ox, oy, oz] = twist.omega;
            let [mut vx, mut vy, mut vz] = twist.velocity;
            if px != 0.0 {
                let p = T::splat(px);
                vy = oz.mul_add(p, vy);
                vz = oy.neg_mul_add(p, vz);
            }
            if py != 0.0 {
                let p = T::splat(py);
                vx = oz.neg_mul_add(p, vx);
                vz = ox.mul_add(p, vz);
            }
            if pz != 0.0 {
                let p = T::splat(pz);
                vx = oy.mul_add(p, vx);
                vy = ox.neg_mul_add(p, vy);
            }
            twist.omega = state.into_link(turn.into_joint(&twist.omega));
            twist.velocity = state.into_link(turn.into_joint(&[vx, vy, vz]));
        }
    });
}
