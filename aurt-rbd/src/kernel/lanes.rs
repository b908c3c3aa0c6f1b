use std::ops::{Add, Mul, Neg, Sub};

/// Several samples side by side, one lane each: plain arrays, which the compiler turns into the vector registers
/// of the function that the code ends up in.
///
/// For that everything is `#[inline(always)]`, and neither here nor in the kernel are there closures: a closure
/// is a function of its own, compiled for the baseline instruction set wherever it is not inlined, which costs
/// a factor of ten.
pub(crate) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    const LANES: usize;

    fn splat(value: f64) -> Self;
    /// The first values of `from`, which has at least as many as there are lanes.
    fn load(from: &[f64]) -> Self;
    /// Writes the lanes.
    ///
    /// # Safety
    /// As many values as there are lanes can be written at `to`.
    unsafe fn store_at(self, to: *mut f64);
    fn first(self) -> f64;
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// c − self · b, rounded once if the instruction set can.
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    /// The bits of self where bit 0 of `selector` is 0, those of `other` where it is 1.
    fn select_odd(self, other: Self, selector: Self) -> Self;
    /// Changes the sign where bit 1 of `selector` (plus `offset`, as integers) is 1.
    fn flip_by_bit_one(self, selector: Self, offset: u64) -> Self;
}

/// The lanes of an expression's values, written out: a loop for each operation, thousands in one function, takes the
/// compiler minutes.
macro_rules! each_lane {
    (2, $l:ident => $value:expr) => {
        each_lane!(@of $l => $value, 0 1)
    };
    (4, $l:ident => $value:expr) => {
        each_lane!(@of $l => $value, 0 1 2 3)
    };
    (8, $l:ident => $value:expr) => {
        each_lane!(@of $l => $value, 0 1 2 3 4 5 6 7)
    };
    (@of $l:ident => $value:expr, $($lane:literal)+) => {
        Self([$({
            const $l: usize = $lane;
            $value
        }),+])
    };
}

macro_rules! lanes {
    (@operator $(#[$attribute:meta])* $name:ident, $lanes:tt, $trait:ident, $function:ident, $operator:tt) => {
        $(#[$attribute])*
        impl $trait for $name {
            type Output = Self;

            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                each_lane!($lanes, L => self.0[L] $operator other.0[L])
            }
        }
    };
    ($(#[$attribute:meta])* $name:ident, $lanes:tt, $bytes:literal, $mul_add:ident) => {
        $(#[$attribute])*
        #[derive(Debug, Clone, Copy)]
        #[repr(C, align($bytes))]
        pub(crate) struct $name([f64; $lanes]);

        $(#[$attribute])*
        impl Lanes for $name {
            const LANES: usize = $lanes;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                Self([value; $lanes])
            }

            #[inline(always)]
            fn load(from: &[f64]) -> Self {
                let from = &from[..$lanes];
                each_lane!($lanes, L => from[L])
            }

            #[inline(always)]
            unsafe fn store_at(self, to: *mut f64) {
                // SAFETY: the caller's promise; an array of numbers has their alignment.
                unsafe { to.cast::<[f64; $lanes]>().write(self.0) };
            }

            #[inline(always)]
            fn first(self) -> f64 {
                self.0[0]
            }

            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                each_lane!($lanes, L => $mul_add(self.0[L], b.0[L], c.0[L]))
            }

            #[inline(always)]
            fn neg_mul_add(self, b: Self, c: Self) -> Self {
                each_lane!($lanes, L => $mul_add(-self.0[L], b.0[L], c.0[L]))
            }

            #[inline(always)]
            fn select_odd(self, other: Self, selector: Self) -> Self {
                each_lane!($lanes, L => {
                    let mask = (selector.0[L].to_bits() & 1).wrapping_neg();
                    f64::from_bits((self.0[L].to_bits() & !mask) | (other.0[L].to_bits() & mask))
                })
            }

            #[inline(always)]
            fn flip_by_bit_one(self, selector: Self, offset: u64) -> Self {
                each_lane!($lanes, L => {
                    let sign = (selector.0[L].to_bits().wrapping_add(offset) & 2) << 62;
                    f64::from_bits(self.0[L].to_bits() ^ sign)
                })
            }
        }

        lanes!(@operator $(#[$attribute])* $name, $lanes, Add, add, +);
        lanes!(@operator $(#[$attribute])* $name, $lanes, Sub, sub, -);
        lanes!(@operator $(#[$attribute])* $name, $lanes, Mul, mul, *);

        $(#[$attribute])*
        impl Neg for $name {
            type Output = Self;

            #[inline(always)]
            fn neg(self) -> Self {
                each_lane!($lanes, L => -self.0[L])
            }
        }
    };
}

#[inline(always)]
fn plain(a: f64, b: f64, c: f64) -> f64 {
    a * b + c
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn fused(a: f64, b: f64, c: f64) -> f64 {
    a.mul_add(b, c)
}

// Two lanes without fused operations: SSE2 and NEON registers, and the same bits on every machine.
lanes!(Plain2, 2, 16, plain);
// Four and eight lanes with fused multiply-add: AVX2 and AVX-512 registers.
lanes!(
    #[cfg(target_arch = "x86_64")]
    Fused4,
    4,
    32,
    fused
);
lanes!(
    #[cfg(target_arch = "x86_64")]
    Fused8,
    8,
    64,
    fused
);
