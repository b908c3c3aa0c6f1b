use aurt_traits::RegressorTile;

use super::lanes::Lanes;
use super::motion::{LinkMotion, Twist, Vector, cross, dot};

/// Where the ten entries of one (joint, link) block go.
pub(super) struct Destination<'a> {
    /// Destinations of the block's ten entries.
    pub of: &'a [u32],
    /// Distance between two columns.
    pub stride: usize,
    /// First sample of this batch of lanes.
    pub first: usize,
    /// Number of lanes that hold samples.
    pub valid: usize,
    /// The tile's values.
    pub data: &'a mut [f64],
}

impl Destination<'_> {
    /// Writes entry `k` if it is wanted; the value is not computed otherwise.
    #[inline(always)]
    fn write<T: Lanes>(&mut self, k: usize, value: impl FnOnce() -> T) {
        let column = self.of[k];
        if column == RegressorTile::UNWANTED {
            return;
        }
        let start = column as usize * self.stride + self.first;
        let value = value();
        if self.valid == T::LANES {
            value.store(&mut self.data[start..]);
        } else {
            let mut padded = [0.0; 8];
            value.store(&mut padded);
            self.data[start..start + self.valid].copy_from_slice(&padded[..self.valid]);
        }
    }
}

/// The block of a joint and a later link: the link's wrench regressor projected on the joint's unit twist.
///
/// With ω, ω̇ and the origin's acceleration a of the link, a link of inertia I about the origin, first moment
/// h and mass m needs the force m a + B h and the moment I ω̇ + ω × I ω + h × a.
#[inline(always)]
pub(super) fn other_block<T: Lanes>(link: &LinkMotion<T>, twist: &Twist<T>, to: &mut Destination<'_>) {
    let s = &twist.omega;
    let v = &twist.velocity;
    let b = &link.b;
    let [ax, ay, az] = link.omega_dot;
    let [wx, wy, wz] = link.omega;
    let (xy, xz, yz) = (wx * wy, wx * wz, wy * wz);
    to.write(0, || dot(s, &[ax, xz, -xy]));
    to.write(1, || dot(s, &[-b[2][0], b[2][1], b[0][0] - b[1][1]]));
    to.write(2, || dot(s, &[b[1][0], b[2][2] - b[0][0], -b[1][2]]));
    to.write(3, || dot(s, &[-yz, ay, xy]));
    to.write(4, || dot(s, &[b[1][1] - b[2][2], -b[0][1], b[0][2]]));
    to.write(5, || dot(s, &[yz, -xz, az]));
    let moment: Vector<T> = cross(&link.accel, s);
    for c in 0..3 {
        to.write(6 + c, || b[2][c].mul_add(v[2], b[1][c].mul_add(v[1], b[0][c].mul_add(v[0], moment[c]))));
    }
    to.write(9, || dot(v, &link.accel));
}

/// The block of a joint and its own link: the z component of the moment. The entries of mZ and m are zero
/// by construction and not written; on a fixed base (`first`), so are those of all inertias but ZZ.
#[inline(always)]
pub(super) fn own_block<T: Lanes>(link: &LinkMotion<T>, sign: f64, first: bool, to: &mut Destination<'_>) {
    let sign = T::splat(sign);
    let b = &link.b;
    let [wx, wy, _] = link.omega;
    if !first {
        to.write(0, || -(wx * wy) * sign);
        to.write(1, || (b[0][0] - b[1][1]) * sign);
        to.write(2, || -b[1][2] * sign);
        to.write(3, || wx * wy * sign);
        to.write(4, || b[0][2] * sign);
    }
    to.write(5, || link.omega_dot[2] * sign);
    to.write(6, || link.accel[1] * sign);
    to.write(7, || -link.accel[0] * sign);
}
