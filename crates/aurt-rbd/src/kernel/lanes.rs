use std::ops::{Add, Mul, Neg, Sub};

/// Several samples side by side, one lane each.
///
/// Every method is `#[inline(always)]`, so that its instructions end up in the kernel function that was
/// compiled for their instruction set. Processor intrinsics rather than loops over arrays: whether the
/// compiler turns such loops into vector instructions depends on the size of the function around them, and
/// in the kernel it did not.
///
/// An implementation may only be used where its instruction set has been detected.
pub(crate) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// Number of lanes.
    const LANES: usize;

    /// `value` in every lane.
    fn splat(value: f64) -> Self;
    /// The first values of `from`, which has at least as many as there are lanes.
    fn load(from: &[f64]) -> Self;
    /// Writes the lanes.
    ///
    /// # Safety
    /// As many values as there are lanes can be written at `to`.
    unsafe fn store_at(self, to: *mut f64);
    /// self · b + c, rounded once if the instruction set can.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// c − self · b, rounded once if the instruction set can.
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    /// The bits of self where bit 0 of `selector` is 0, those of `other` where it is 1.
    fn select_odd(self, other: Self, selector: Self) -> Self;
    /// Changes the sign where bit 1 of `selector` (plus `offset`, as integers) is 1.
    fn flip_by_bit_one(self, selector: Self, offset: i64) -> Self;
}

/// An array of lanes, for single values and for processors without an implementation of their own.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Array2([f64; 2]);

impl Array2 {
    /// The first lane.
    pub fn first(self) -> f64 {
        self.0[0]
    }
}

impl Lanes for Array2 {
    const LANES: usize = 2;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self([value; 2])
    }

    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        Self([from[0], from[1]])
    }

    #[inline(always)]
    unsafe fn store_at(self, to: *mut f64) {
        // SAFETY: the caller's promise.
        unsafe { to.cast::<[f64; 2]>().write(self.0) };
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        c - self * b
    }

    #[inline(always)]
    fn select_odd(self, other: Self, selector: Self) -> Self {
        let select = |l: usize| if selector.0[l].to_bits() & 1 == 0 { self.0[l] } else { other.0[l] };
        Self([select(0), select(1)])
    }

    #[inline(always)]
    fn flip_by_bit_one(self, selector: Self, offset: i64) -> Self {
        let flip = |l: usize| {
            let sign = (selector.0[l].to_bits().wrapping_add_signed(offset) & 2) << 62;
            f64::from_bits(self.0[l].to_bits() ^ sign)
        };
        Self([flip(0), flip(1)])
    }
}

impl Add for Array2 {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self([self.0[0] + other.0[0], self.0[1] + other.0[1]])
    }
}

impl Sub for Array2 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self([self.0[0] - other.0[0], self.0[1] - other.0[1]])
    }
}

impl Mul for Array2 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self([self.0[0] * other.0[0], self.0[1] * other.0[1]])
    }
}

impl Neg for Array2 {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self([-self.0[0], -self.0[1]])
    }
}
