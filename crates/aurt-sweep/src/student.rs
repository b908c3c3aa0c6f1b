//! Student's distribution.

use libm::lgamma;

/// Probability that |t| of `degrees` degrees of freedom exceeds |`t`|: I_x(ν/2, ½) with x = ν/(ν + t²)
/// (Abramowitz and Stegun, *Handbook of Mathematical Functions*, 26.7.1 and 26.5.27).
#[must_use]
pub fn two_sided(t: f64, degrees: f64) -> f64 {
    if t.is_nan() || degrees <= 0.0 {
        return f64::NAN;
    }
    incomplete_beta(degrees / 2.0, 0.5, degrees / (degrees + t * t))
}

/// The regularised incomplete beta function I_x(a, b).
fn incomplete_beta(a: f64, b: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x >= 1.0 {
        return 1.0;
    }
    let front = (lgamma(a + b) - lgamma(a) - lgamma(b) + a * x.ln() + b * (1.0 - x).ln()).exp();
    // The fraction converges fast below the distribution's mean; above it the mirrored one does.
    if x < (a + 1.0) / (a + b + 2.0) {
        front * fraction(a, b, x) / a
    } else {
        1.0 - front * fraction(b, a, 1.0 - x) / b
    }
}

/// The continued fraction of I_x(a, b) (26.5.8), from the front, by the recurrence of its convergents' ratios.
fn fraction(a: f64, b: f64, x: f64) -> f64 {
    const MOST_TERMS: u32 = 300;
    let away_from_zero = |v: f64| if v.abs() < 1e-300 { 1e-300 } else { v };
    let mut upper = 1.0;
    let mut lower = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
    let mut value = lower;
    for m in 1..=MOST_TERMS {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut change = 1.0;
        for term in [even, odd] {
            lower = 1.0 / away_from_zero(1.0 + term * lower);
            upper = away_from_zero(1.0 + term / upper);
            change = upper * lower;
            value *= change;
        }
        if (change - 1.0).abs() < 1e-15 {
            break;
        }
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tabulated_quantiles_are_met() {
        // Two-sided 5 % and 1 % points, from scipy 1.17, stats.t.ppf(0.975 and 0.995, ν).
        for (degrees, five, one) in [
            (1.0, 12.706_204_736_174_694, 63.656_741_162_871_526),
            (10.0, 2.228_138_851_986_274, 3.169_272_672_616_95),
            (100.0, 1.983_971_518_523_551_8, 2.625_890_521_438_017_3),
        ] {
            assert!((two_sided(five, degrees) - 0.05).abs() < 1e-12, "{degrees}");
            assert!((two_sided(-one, degrees) - 0.01).abs() < 1e-12, "{degrees}");
        }
        assert_eq!(two_sided(0.0, 5.0), 1.0);
        assert!(two_sided(f64::INFINITY, 5.0) == 0.0 && two_sided(f64::NAN, 5.0).is_nan());
    }
}
