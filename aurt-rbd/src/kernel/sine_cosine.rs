use super::lanes::{Lanes, Plain2};

/// Adding this to a number below 2^51 in magnitude and subtracting it again rounds to an integer, which
/// stands in the lowest bits of the sum in between.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// π/2 in three parts; the first two have 33 significant bits, so that their products with integers below
/// 2^20 are exact.
const HALF_PI: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

/// sin x = x + x³ S(x²) on [−π/4, π/4]: minimax polynomial, error 3.5e-18 relative to x.
const SINE: [f64; 6] = [
    -0.166_666_666_666_666_32,
    0.008_333_333_333_322_37,
    -0.000_198_412_698_297_711_5,
    2.755_731_367_866_04e-6,
    -2.505_075_596_059_182e-8,
    1.589_666_646_076_742_6e-10,
];

/// cos x = 1 − x²/2 + x⁴ C(x²) on [−π/4, π/4]: minimax polynomial, error 4.7e-20.
const COSINE: [f64; 6] = [
    0.041_666_666_666_666_6,
    -0.001_388_888_888_887_406_4,
    2.480_158_728_944_346_5e-5,
    -2.755_731_434_065_482e-7,
    2.087_572_162_314_000_7e-9,
    -1.135_955_930_224_291e-11,
];

/// Sine and cosine of every lane, without a branch and without the platform's mathematical library, whose
/// results differ from machine to machine.
///
/// Error below 1 ulp of 1 for |x| < 10⁶; beyond, up to 2^51, of the size of x's own rounding. What is not
/// finite gives NaN.
#[inline(always)]
pub(crate) fn sine_cosine<T: Lanes>(x: T) -> (T, T) {
    let shifted = x.mul_add(T::splat(std::f64::consts::FRAC_2_PI), T::splat(ROUND));
    let quadrant = shifted - T::splat(ROUND);
    let mut r = quadrant.neg_mul_add(T::splat(HALF_PI[0]), x);
    r = quadrant.neg_mul_add(T::splat(HALF_PI[1]), r);
    r = quadrant.neg_mul_add(T::splat(HALF_PI[2]), r);

    let y = r * r;
    let sine = (polynomial(&SINE, y) * y).mul_add(r, r);
    let cosine = (polynomial(&COSINE, y) * y).mul_add(y, y.neg_mul_add(T::splat(0.5), T::splat(1.0)));

    // Odd quadrants exchange sine and cosine; bit 1 of the quadrant is the sine's sign, bit 1 of the next
    // quadrant the cosine's.
    (
        sine.select_odd(cosine, shifted).flip_by_bit_one(shifted, 0),
        cosine.select_odd(sine, shifted).flip_by_bit_one(shifted, 1),
    )
}

pub(crate) fn sine_cosine_of(x: f64) -> (f64, f64) {
    let (sine, cosine) = sine_cosine(Plain2::splat(x));
    (sine.first(), cosine.first())
}

#[inline(always)]
fn polynomial<T: Lanes>(coefficients: &[f64; 6], y: T) -> T {
    let mut sum = T::splat(coefficients[5]);
    for k in (0..5).rev() {
        sum = sum.mul_add(y, T::splat(coefficients[k]));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn store<T: Lanes>(lanes: T, to: &mut [f64]) {
        assert!(to.len() >= T::LANES);
        // SAFETY: the slice has been seen to be long enough.
        unsafe { lanes.store_at(to.as_mut_ptr()) };
    }

    fn largest_error<T: Lanes>(reach: f64) -> f64 {
        let mut worst: f64 = 0.0;
        let steps = if cfg!(miri) { 1000 } else { 100_000 };
        for k in 0..steps {
            // An irrational step covers the interval without favouring multiples of anything.
            let x = reach * (2.0 * (f64::from(k) * 0.618_033_988_749_894_9).fract() - 1.0);
            let mut values = [0.0; 8];
            let (s, c) = sine_cosine(T::splat(x));
            store(s, &mut values);
            worst = worst.max((values[0] - libm::sin(x)).abs());
            store(c, &mut values);
            worst = worst.max((values[T::LANES - 1] - libm::cos(x)).abs());
        }
        worst
    }

    #[test]
    fn agrees_with_the_library_to_one_ulp_of_one() {
        for reach in [1.0, 10.0, 1e3, 1e6] {
            assert!(largest_error::<Plain2>(reach) < 2.3e-16, "{reach}: {}", largest_error::<Plain2>(reach));
        }
    }

    #[test]
    fn quadrants_and_values_that_are_no_angles() {
        use std::f64::consts::{FRAC_PI_2, PI};
        for (x, s, c) in [(0.0, 0.0, 1.0), (FRAC_PI_2, 1.0, 0.0), (PI, 0.0, -1.0), (-FRAC_PI_2, -1.0, 0.0)] {
            let mut values = [0.0; 2];
            let (sine, cosine) = sine_cosine(Plain2::splat(x));
            store(sine, &mut values);
            assert!((values[0] - s).abs() < 2e-16, "sin {x}");
            store(cosine, &mut values);
            assert!((values[0] - c).abs() < 2e-16, "cos {x}");
        }
        for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut values = [0.0; 2];
            store(sine_cosine(Plain2::splat(x)).0, &mut values);
            assert!(values[0].is_nan());
        }
    }
}
