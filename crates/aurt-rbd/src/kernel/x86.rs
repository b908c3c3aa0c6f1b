//! Lanes of the x86-64 instruction sets.

use std::arch::x86_64::*;
use std::ops::{Add, Mul, Neg, Sub};

use super::lanes::Lanes;

macro_rules! lanes {
    (
        $(#[$doc:meta])* $name:ident: $register:ty, $lanes:literal,
        $set:ident, $loadu:ident, $storeu:ident, $add:ident, $sub:ident, $mul:ident,
        mul_add: |$a:ident, $b:ident, $c:ident| $mul_add:expr,
        neg_mul_add: |$na:ident, $nb:ident, $nc:ident| $neg_mul_add:expr,
        select: |$sa:ident, $sb:ident, $selector:ident| $select:expr,
        sign: |$bits:ident, $offset:ident| $sign:expr,
        xor: $xor:ident
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy)]
        pub(crate) struct $name($register);

        impl Lanes for $name {
            const LANES: usize = $lanes;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                // SAFETY: the trait's contract: the instruction set has been detected.
                Self(unsafe { $set(value) })
            }

            #[inline(always)]
            fn load(from: &[f64]) -> Self {
                let from = &from[..$lanes];
                // SAFETY: as in `splat`, and the slice has as many values as are read.
                Self(unsafe { $loadu(from.as_ptr()) })
            }

            #[inline(always)]
            unsafe fn store_at(self, to: *mut f64) {
                // SAFETY: as in `splat`, and the caller's promise.
                unsafe { $storeu(to, self.0) }
            }

            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                let ($a, $b, $c) = (self.0, b.0, c.0);
                // SAFETY: as in `splat`.
                Self(unsafe { $mul_add })
            }

            #[inline(always)]
            fn neg_mul_add(self, b: Self, c: Self) -> Self {
                let ($na, $nb, $nc) = (self.0, b.0, c.0);
                // SAFETY: as in `splat`.
                Self(unsafe { $neg_mul_add })
            }

            #[inline(always)]
            fn select_odd(self, other: Self, selector: Self) -> Self {
                let ($sa, $sb, $selector) = (self.0, other.0, selector.0);
                // SAFETY: as in `splat`.
                Self(unsafe { $select })
            }

            #[inline(always)]
            fn flip_by_bit_one(self, selector: Self, offset: i64) -> Self {
                let ($bits, $offset) = (selector.0, offset);
                // SAFETY: as in `splat`.
                Self(unsafe { $xor(self.0, $sign) })
            }
        }

        impl Add for $name {
            type Output = Self;

            #[inline(always)]
            fn add(self, other: Self) -> Self {
                // SAFETY: as in `splat`.
                Self(unsafe { $add(self.0, other.0) })
            }
        }

        impl Sub for $name {
            type Output = Self;

            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                // SAFETY: as in `splat`.
                Self(unsafe { $sub(self.0, other.0) })
            }
        }

        impl Mul for $name {
            type Output = Self;

            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                // SAFETY: as in `splat`.
                Self(unsafe { $mul(self.0, other.0) })
            }
        }

        impl Neg for $name {
            type Output = Self;

            #[inline(always)]
            fn neg(self) -> Self {
                // SAFETY: as in `splat`.
                Self(unsafe { $xor(self.0, $set(-0.0)) })
            }
        }
    };
}

lanes!(
    /// Two lanes without fused operations, which every x86-64 processor has.
    Sse2: __m128d, 2,
    _mm_set1_pd, _mm_loadu_pd, _mm_storeu_pd, _mm_add_pd, _mm_sub_pd, _mm_mul_pd,
    mul_add: |a, b, c| _mm_add_pd(_mm_mul_pd(a, b), c),
    neg_mul_add: |a, b, c| _mm_sub_pd(c, _mm_mul_pd(a, b)),
    select: |a, b, selector| {
        let bit = _mm_and_si128(_mm_castpd_si128(selector), _mm_set1_epi64x(1));
        let mask = _mm_castsi128_pd(_mm_sub_epi64(_mm_setzero_si128(), bit));
        _mm_or_pd(_mm_andnot_pd(mask, a), _mm_and_pd(mask, b))
    },
    sign: |bits, offset| {
        let sum = _mm_add_epi64(_mm_castpd_si128(bits), _mm_set1_epi64x(offset));
        _mm_castsi128_pd(_mm_slli_epi64::<62>(_mm_and_si128(sum, _mm_set1_epi64x(2))))
    },
    xor: _mm_xor_pd
);

lanes!(
    /// Four lanes with fused multiply-add.
    Avx2: __m256d, 4,
    _mm256_set1_pd, _mm256_loadu_pd, _mm256_storeu_pd, _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd,
    mul_add: |a, b, c| _mm256_fmadd_pd(a, b, c),
    neg_mul_add: |a, b, c| _mm256_fnmadd_pd(a, b, c),
    select: |a, b, selector| {
        let bit = _mm256_slli_epi64::<63>(_mm256_castpd_si256(selector));
        _mm256_blendv_pd(a, b, _mm256_castsi256_pd(bit))
    },
    sign: |bits, offset| {
        let sum = _mm256_add_epi64(_mm256_castpd_si256(bits), _mm256_set1_epi64x(offset));
        _mm256_castsi256_pd(_mm256_slli_epi64::<62>(_mm256_and_si256(sum, _mm256_set1_epi64x(2))))
    },
    xor: _mm256_xor_pd
);

lanes!(
    /// Eight lanes with fused multiply-add.
    Avx512: __m512d, 8,
    _mm512_set1_pd, _mm512_loadu_pd, _mm512_storeu_pd, _mm512_add_pd, _mm512_sub_pd, _mm512_mul_pd,
    mul_add: |a, b, c| _mm512_fmadd_pd(a, b, c),
    neg_mul_add: |a, b, c| _mm512_fnmadd_pd(a, b, c),
    select: |a, b, selector| {
        let odd = _mm512_test_epi64_mask(_mm512_castpd_si512(selector), _mm512_set1_epi64(1));
        _mm512_mask_blend_pd(odd, a, b)
    },
    sign: |bits, offset| {
        let sum = _mm512_add_epi64(_mm512_castpd_si512(bits), _mm512_set1_epi64(offset));
        _mm512_castsi512_pd(_mm512_slli_epi64::<62>(_mm512_and_si512(sum, _mm512_set1_epi64(2))))
    },
    xor: _mm512_xor_pd
);
