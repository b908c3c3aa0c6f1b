use super::lanes::Lanes;
use super::motion::{LinkMotion, Twist};
use super::turn::dot;

/// The offset of an entry that is not wanted.
pub(super) const UNWANTED: usize = usize::MAX;

/// Writes entry `$k` if it is wanted; its value is not computed otherwise. A macro rather than a closure, which
/// would be compiled for the baseline instruction set where it is not inlined.
macro_rules! write_entry {
    ($offsets:ident, $data:ident, $first:ident, $k:expr, $value:expr) => {
        if $offsets[$k] != UNWANTED {
            $value.store(&mut $data[$offsets[$k] + $first..]);
        }
    };
}

/// The block of a joint and a later link: the link's wrench regressor projected on the joint's unit twist.
///
/// With ω, ω̇ and the origin's acceleration a of the link, a link of inertia I about the origin, first moment
/// h and mass m needs the force m a + B h and the moment I ω̇ + ω × I ω + h × a.
///
/// `offsets` are those of the block's ten columns in `data`, `first` is the sample of the first lane.
#[inline(always)]
pub(super) fn other_block<T: Lanes>(
    link: &LinkMotion<T>,
    twist: &Twist<T>,
    offsets: &[usize; 10],
    first: usize,
    data: &mut [f64],
) {
    let [sx, sy, sz] = twist.omega;
    let v = &twist.velocity;
    let [dx, dy, dz] = link.omega_dot;
    let [[b00, b01, b02], [b10, b11, b12], [b20, b21, b22]] = link.b;
    let (bx, by, bz) = ([b00, b10, b20], [b01, b11, b21], [b02, b12, b22]);
    let [xy, xz, yz] = link.products;
    let [xx_yy, zz_xx, yy_zz] = link.differences;
    write_entry!(offsets, data, first, 0, sz.neg_mul_add(xy, sy.mul_add(xz, sx * dx)));
    write_entry!(offsets, data, first, 1, sx.neg_mul_add(b20, sy.mul_add(b21, sz * xx_yy)));
    write_entry!(offsets, data, first, 2, sz.neg_mul_add(b12, sx.mul_add(b10, sy * zz_xx)));
    write_entry!(offsets, data, first, 3, sx.neg_mul_add(yz, sz.mul_add(xy, sy * dy)));
    write_entry!(offsets, data, first, 4, sy.neg_mul_add(b01, sz.mul_add(b02, sx * yy_zz)));
    write_entry!(offsets, data, first, 5, sy.neg_mul_add(xz, sx.mul_add(yz, sz * dz)));
    let [ax, ay, az] = link.accel;
    write_entry!(offsets, data, first, 6, ay.mul_add(sz, az.neg_mul_add(sy, dot(&bx, v))));
    write_entry!(offsets, data, first, 7, az.mul_add(sx, ax.neg_mul_add(sz, dot(&by, v))));
    write_entry!(offsets, data, first, 8, ax.mul_add(sy, ay.neg_mul_add(sx, dot(&bz, v))));
    write_entry!(offsets, data, first, 9, dot(v, &link.accel));
}

/// The block of a joint and its own link: the z component of the moment. The entries of mZ and m are zero
/// by construction and not written; on a fixed base (`on_base`), so are those of all inertias but ZZ.
#[inline(always)]
pub(super) fn own_block<T: Lanes>(
    link: &LinkMotion<T>,
    sign: f64,
    on_base: bool,
    offsets: &[usize; 10],
    first: usize,
    data: &mut [f64],
) {
    let sign = T::splat(sign);
    let [xy, ..] = link.products;
    if !on_base {
        write_entry!(offsets, data, first, 0, -(xy * sign));
        write_entry!(offsets, data, first, 1, (link.differences[0] * sign));
        write_entry!(offsets, data, first, 2, -(link.b[1][2] * sign));
        write_entry!(offsets, data, first, 3, (xy * sign));
        write_entry!(offsets, data, first, 4, (link.b[0][2] * sign));
    }
    write_entry!(offsets, data, first, 5, (link.omega_dot[2] * sign));
    write_entry!(offsets, data, first, 6, (link.accel[1] * sign));
    write_entry!(offsets, data, first, 7, -(link.accel[0] * sign));
}
