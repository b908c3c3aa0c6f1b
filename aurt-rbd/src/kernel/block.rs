use aurt_traits::RegressorTile;

use super::lanes::Lanes;
use super::motion::{Derived, JointLanes, LinkMotion, Twist};
use super::turn::dot;
use crate::{INERTIAL_PARAMETERS, JointKind};

/// Which entries of a (joint, link) block are wanted, and where their columns start in the tile.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    /// Bit k is set if entry k is wanted.
    wanted: u16,
    /// Where the columns of the wanted entries start.
    offsets: [usize; INERTIAL_PARAMETERS],
}

const ALL: u16 = 0b11_1111_1111;
/// The entries that most base parameter sets keep: all but YY, mZ and m.
const USUAL_BASE: u16 = 0b00_1111_0111;
const AS_WANTED: u16 = 0;

/// The entries of a link's block that can load its own revolute joint: its mass and its first moment along the axis
/// cannot.
const OWN: u16 = 0b00_1111_1111;
/// The entries of the block of a link on the base that can load its revolute joint, whose axis is fixed in space: of the
/// inertias only ZZ.
const OWN_ON_BASE: u16 = 0b00_1110_0000;
/// The entries of a link's block that can load a prismatic joint: inertias need no force.
const SLIDE: u16 = 0b11_1100_0000;
/// The entries of the block of a link on the base that can load its prismatic joint: the link does not turn.
const SLIDE_ON_BASE: u16 = 0b10_0000_0000;

/// The entries of the block of a joint of this kind and a link that it carries that can be other than zero; the link may be
/// its `own`, and that may be `on_base`.
pub(crate) const fn possible_entries(kind: JointKind, own: bool, on_base: bool) -> u16 {
    match kind {
        JointKind::Revolute if !own => ALL,
        JointKind::Revolute if on_base => OWN_ON_BASE,
        JointKind::Revolute => OWN,
        JointKind::Prismatic if own && on_base => SLIDE_ON_BASE,
        JointKind::Prismatic => SLIDE,
    }
}

impl Block {
    /// The wanted ones of the entries in the mask `possible`, from their destinations in the tile.
    pub fn new(destinations: &[u32; INERTIAL_PARAMETERS], possible: u16, stride: usize) -> Self {
        let mut block = Self { wanted: 0, offsets: [0; INERTIAL_PARAMETERS] };
        for (k, destination) in destinations.iter().enumerate() {
            block.offsets[k] = *destination as usize * stride;
            block.wanted |= u16::from(*destination != RegressorTile::UNWANTED) << k;
        }
        block.wanted &= possible;
        block
    }

    const fn wants(&self, k: usize) -> bool {
        self.wanted & (1 << k) != 0
    }

    /// Replaces the offsets of all wanted entries.
    pub fn map_offsets(&mut self, mut replace: impl FnMut(usize) -> usize) {
        for k in 0..INERTIAL_PARAMETERS {
            if self.wants(k) {
                self.offsets[k] = replace(self.offsets[k]);
            }
        }
    }
}

/// Writes entry `$k` if it is wanted; its value is not calculated otherwise. With a mask that is known where the
/// code is compiled there is no branch. A macro rather than a closure, which would be compiled for the baseline
/// instruction set wherever it is not inlined.
macro_rules! write_entry {
    ($mask:ident, $block:ident, $to:ident, $k:literal, $value:expr) => {
        if ($mask == AS_WANTED && $block.wants($k)) || $mask & (1 << $k) != 0 {
            // SAFETY: the caller's promise for wanted entries.
            unsafe { $value.store_at($to.add($block.offsets[$k])) };
        }
    };
}

/// The blocks of one link and the joints before it: the link's wrench regressor projected on the joints' unit
/// twists.
///
/// With ω, ω̇ and the origin's acceleration a of the link, a link of inertia I about the origin, first moment
/// h and mass m needs the force m a + B h and the moment I ω̇ + ω × I ω + h × a.
///
/// # Safety
/// For every wanted entry of `blocks` and every member of `group`, as many values as there are lanes can be
/// written at their offsets from `to`.
#[inline(always)]
pub(super) unsafe fn other_blocks<T: Lanes>(
    links: &[LinkMotion<T>],
    joints: &[JointLanes<T>],
    blocks: &[Block],
    group: &[usize],
    to: *mut f64,
) {
    let mut start = 0;
    // Neighbours that want the same entries go together: on an arm of revolute joints all of them.
    while let Some(first) = blocks.get(start) {
        let wanted = first.wanted;
        let mut end = start + 1;
        while end < blocks.len() && blocks[end].wanted == wanted {
            end += 1;
        }
        let (joints, blocks) = (&joints[start..end], &blocks[start..end]);
        // SAFETY: the caller's promise, and the masks are what the blocks say.
        unsafe {
            match wanted {
                ALL => masked_blocks::<T, ALL>(links, joints, blocks, group, to),
                USUAL_BASE => masked_blocks::<T, USUAL_BASE>(links, joints, blocks, group, to),
                0 => (),
                _ => masked_blocks::<T, AS_WANTED>(links, joints, blocks, group, to),
            }
        }
        start = end;
    }
}

/// # Safety
/// As for [`other_blocks`]; `MASK` is the mask of all blocks or [`AS_WANTED`].
#[inline(always)]
unsafe fn masked_blocks<T: Lanes, const MASK: u16>(
    links: &[LinkMotion<T>],
    joints: &[JointLanes<T>],
    blocks: &[Block],
    group: &[usize],
    to: *mut f64,
) {
    for (member, (link, first)) in links.iter().zip(group).enumerate() {
        // A copy that is in registers: between the writes, which might overlap the original for all that the
        // processor knows, it would be slow to read.
        let link = *link;
        let derived = link.derived();
        for (joint, block) in joints.iter().zip(blocks) {
            // SAFETY: the caller's promise.
            unsafe { masked_block::<T, MASK>(&link, &derived, &joint.twists[member], block, to.add(*first)) };
        }
    }
}

/// # Safety
/// As for [`masked_blocks`].
#[inline(always)]
unsafe fn masked_block<T: Lanes, const MASK: u16>(
    link: &LinkMotion<T>,
    derived: &Derived<T>,
    twist: &Twist<T>,
    block: &Block,
    to: *mut f64,
) {
    let [sx, sy, sz] = twist.omega;
    let v = &twist.velocity;
    let [dx, dy, dz] = link.omega_dot;
    let [[b00, b01, b02], [b10, b11, b12], [b20, b21, b22]] = derived.b;
    let [xy, xz, yz] = derived.products;
    let [xx_yy, zz_xx, yy_zz] = derived.differences;
    write_entry!(MASK, block, to, 0, sz.neg_mul_add(xy, sy.mul_add(xz, sx * dx)));
    write_entry!(MASK, block, to, 1, sx.neg_mul_add(b20, sy.mul_add(b21, sz * xx_yy)));
    write_entry!(MASK, block, to, 2, sz.neg_mul_add(b12, sx.mul_add(b10, sy * zz_xx)));
    write_entry!(MASK, block, to, 3, sx.neg_mul_add(yz, sz.mul_add(xy, sy * dy)));
    write_entry!(MASK, block, to, 4, sy.neg_mul_add(b01, sz.mul_add(b02, sx * yy_zz)));
    write_entry!(MASK, block, to, 5, sy.neg_mul_add(xz, sx.mul_add(yz, sz * dz)));
    let [ax, ay, az] = link.accel;
    write_entry!(MASK, block, to, 6, ay.mul_add(sz, az.neg_mul_add(sy, dot(&[b00, b10, b20], v))));
    write_entry!(MASK, block, to, 7, az.mul_add(sx, ax.neg_mul_add(sz, dot(&[b01, b11, b21], v))));
    write_entry!(MASK, block, to, 8, ax.mul_add(sy, ay.neg_mul_add(sx, dot(&[b02, b12, b22], v))));
    write_entry!(MASK, block, to, 9, dot(v, &link.accel));
}

/// The block of one link and its own joint: the z component of the moment.
///
/// # Safety
/// As for [`other_blocks`].
#[inline(always)]
pub(super) unsafe fn own_block<T: Lanes>(
    links: &[LinkMotion<T>],
    sign: f64,
    block: Block,
    group: &[usize],
    to: *mut f64,
) {
    const USUAL_OWN: u16 = OWN & USUAL_BASE;
    // SAFETY: the caller's promise, and the mask is what the block says.
    unsafe {
        match block.wanted {
            OWN => masked_own_block::<T, OWN>(links, sign, block, group, to),
            USUAL_OWN => masked_own_block::<T, USUAL_OWN>(links, sign, block, group, to),
            0 => (),
            _ => masked_own_block::<T, AS_WANTED>(links, sign, block, group, to),
        }
    }
}

/// # Safety
/// As for [`other_blocks`]; `MASK` is the mask of the block or [`AS_WANTED`].
#[inline(always)]
unsafe fn masked_own_block<T: Lanes, const MASK: u16>(
    links: &[LinkMotion<T>],
    sign: f64,
    block: Block,
    group: &[usize],
    to: *mut f64,
) {
    let (plus, minus) = (T::splat(sign), T::splat(-sign));
    for (link, first) in links.iter().zip(group) {
        let derived = link.derived();
        let [xy, ..] = derived.products;
        // SAFETY: the caller's promise.
        let to = unsafe { to.add(*first) };
        write_entry!(MASK, block, to, 0, (xy * minus));
        write_entry!(MASK, block, to, 1, (derived.differences[0] * plus));
        write_entry!(MASK, block, to, 2, (derived.b[1][2] * minus));
        write_entry!(MASK, block, to, 3, (xy * plus));
        write_entry!(MASK, block, to, 4, (derived.b[0][2] * plus));
        write_entry!(MASK, block, to, 5, (link.omega_dot[2] * plus));
        write_entry!(MASK, block, to, 6, (link.accel[1] * plus));
        write_entry!(MASK, block, to, 7, (link.accel[0] * minus));
    }
}

/// The block of one link and its own prismatic joint: the z component of the force.
///
/// # Safety
/// As for [`other_blocks`].
#[inline(always)]
pub(super) unsafe fn own_slide_block<T: Lanes>(
    links: &[LinkMotion<T>],
    sign: f64,
    block: Block,
    group: &[usize],
    to: *mut f64,
) {
    const MASK: u16 = AS_WANTED;
    let plus = T::splat(sign);
    for (link, first) in links.iter().zip(group) {
        let [_, _, [bx, by, bz]] = link.derived().b;
        // SAFETY: the caller's promise.
        let to = unsafe { to.add(*first) };
        write_entry!(MASK, block, to, 6, (bx * plus));
        write_entry!(MASK, block, to, 7, (by * plus));
        write_entry!(MASK, block, to, 8, (bz * plus));
        write_entry!(MASK, block, to, 9, (link.accel[2] * plus));
    }
}
