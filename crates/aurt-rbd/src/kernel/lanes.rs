use std::array::from_fn;
use std::ops::{Add, Mul, Neg, Sub};

/// Several samples side by side, one lane each.
///
/// Every method is `#[inline(always)]`, so that the code takes on the instruction set of the function that
/// it is inlined into.
pub(crate) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// Number of lanes.
    const LANES: usize;

    /// `value` in every lane.
    fn splat(value: f64) -> Self;
    /// The first values of `from`, which has at least as many as there are lanes.
    fn load(from: &[f64]) -> Self;
    /// Writes the lanes to the front of `to`, which has at least as many places as there are lanes.
    fn store(self, to: &mut [f64]);
    /// self · b + c, rounded once if the instruction set can.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// c − self · b, rounded once if the instruction set can.
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    /// The bits of each lane, worked on by `f` together with those of `other`.
    fn with_bits(self, other: Self, f: impl Fn(u64, u64) -> u64) -> Self;
}

macro_rules! lanes {
    ($(#[$doc:meta])* $name:ident, $lanes:literal, $bytes:literal, |$a:ident, $b:ident, $c:ident| $fused:expr) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy)]
        #[repr(C, align($bytes))]
        pub(crate) struct $name([f64; $lanes]);

        impl Lanes for $name {
            const LANES: usize = $lanes;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                Self([value; $lanes])
            }

            #[inline(always)]
            fn load(from: &[f64]) -> Self {
                let from = &from[..$lanes];
                Self(from_fn(|l| from[l]))
            }

            #[inline(always)]
            fn store(self, to: &mut [f64]) {
                to[..$lanes].copy_from_slice(&self.0);
            }

            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                Self(from_fn(|l| {
                    let ($a, $b, $c) = (self.0[l], b.0[l], c.0[l]);
                    $fused
                }))
            }

            #[inline(always)]
            fn neg_mul_add(self, b: Self, c: Self) -> Self {
                Self(from_fn(|l| {
                    let ($a, $b, $c) = (-self.0[l], b.0[l], c.0[l]);
                    $fused
                }))
            }

            #[inline(always)]
            fn with_bits(self, other: Self, f: impl Fn(u64, u64) -> u64) -> Self {
                Self(from_fn(|l| f64::from_bits(f(self.0[l].to_bits(), other.0[l].to_bits()))))
            }
        }

        impl Add for $name {
            type Output = Self;

            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self(from_fn(|l| self.0[l] + other.0[l]))
            }
        }

        impl Sub for $name {
            type Output = Self;

            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self(from_fn(|l| self.0[l] - other.0[l]))
            }
        }

        impl Mul for $name {
            type Output = Self;

            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                Self(from_fn(|l| self.0[l] * other.0[l]))
            }
        }

        impl Neg for $name {
            type Output = Self;

            #[inline(always)]
            fn neg(self) -> Self {
                Self(from_fn(|l| -self.0[l]))
            }
        }
    };
}

lanes!(
    /// Two lanes without fused operations: SSE2 and NEON registers, and the same bits on every machine.
    Plain2, 2, 16, |a, b, c| a * b + c
);
lanes!(
    /// Four lanes with fused multiply-add: AVX2 registers.
    Fused4, 4, 32, |a, b, c| a.mul_add(b, c)
);
lanes!(
    /// Eight lanes with fused multiply-add: AVX-512 registers.
    Fused8, 8, 64, |a, b, c| a.mul_add(b, c)
);
