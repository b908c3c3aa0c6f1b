//! Student's and χ² distributions, as tests and intervals need them.

use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

/// The normal deviate that 5 % exceed.
pub const ONE_SIDED_5: f64 = 1.644_853_626_951_472;

/// The normal deviate with the probability of Student's t (Wallace 1959, *Annals of Mathematical Statistics* 30). In the
/// tails of a chart a probability is too close to one to be told from it; this needs none.
pub(crate) fn normal(t: f64, freedom: f64) -> f64 {
    let wallace = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
    let z = wallace * (freedom * libm::log1p(t * t / freedom)).sqrt();
    z.copysign(t)
}

/// Student's t with the probability of a normal deviate; the deviate itself where the freedom has no bound, NaN where there
/// is none.
pub fn student(z: f64, freedom: f64) -> f64 {
    if freedom == f64::INFINITY {
        return z;
    }
    // Of the lower tail, which numbers resolve further than the upper one.
    let probability = Normal::standard().cdf(-z.abs());
    StudentsT::new(0.0, 1.0, freedom)
        .map_or(f64::NAN, |student| student.inverse_cdf(probability).abs().copysign(z))
}

/// Probability that |t| of some degrees of freedom exceeds |`t`|; NaN where there is no freedom.
pub fn two_sided(t: f64, freedom: f64) -> f64 {
    if t.is_nan() {
        return f64::NAN;
    }
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |student| 2.0 * student.sf(t.abs()))
}

/// What χ² of some degrees of freedom exceeds with 90 % probability; NaN where there are none.
pub(crate) fn low_chi_squared(freedom: f64) -> f64 {
    ChiSquared::new(freedom).map_or(f64::NAN, |of| of.inverse_cdf(0.1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uncertainty::NORMAL_95;

    /// Quantiles of Student's distribution from scipy 1.17: t_0.975 with 2, 5, 10 and 30.5 degrees of freedom.
    #[test]
    fn students_quantiles_are_those_of_tables() {
        let tabled =
            [(2.0, 4.302_652_730), (5.0, 2.570_581_836), (10.0, 2.228_138_852), (30.5, 2.040_869_445)];
        for (freedom, expected) in tabled {
            assert!((student(NORMAL_95, freedom) / expected - 1.0).abs() < 1e-7);
            // Wallace's approximation is poor for two and good for more.
            let allowed = if freedom < 5.0 { 3e-2 } else { 5e-3 };
            assert!((normal(expected, freedom) / NORMAL_95 - 1.0).abs() < allowed, "{freedom}");
            assert_eq!(student(-1.0, freedom), -student(1.0, freedom));
        }
        assert_eq!(student(1.5, f64::INFINITY), 1.5);
        assert!(student(1.5, 0.0).is_nan() && student(1.5, f64::NAN).is_nan());
    }

    /// Two-sided 5 % and 1 % points from scipy 1.17, stats.t.ppf(0.975 and 0.995, ν).
    #[test]
    fn tabulated_probabilities_are_met() {
        for (freedom, five, one) in [
            (1.0, 12.706_204_736_174_694, 63.656_741_162_871_526),
            (10.0, 2.228_138_851_986_274, 3.169_272_672_616_95),
            (100.0, 1.983_971_518_523_551_8, 2.625_890_521_438_017_3),
        ] {
            assert!((two_sided(five, freedom) - 0.05).abs() < 1e-12, "{freedom}");
            assert!((two_sided(-one, freedom) - 0.01).abs() < 1e-12, "{freedom}");
        }
        assert_eq!(two_sided(0.0, 5.0), 1.0);
        assert!(two_sided(f64::INFINITY, 5.0) == 0.0 && two_sided(f64::NAN, 5.0).is_nan());
        assert!(two_sided(1.0, 0.0).is_nan());
    }

    /// Quantiles of χ² from scipy 1.17: 10 % with 4, 10 and 30 degrees of freedom.
    #[test]
    fn chi_squared_is_that_of_tables() {
        for (freedom, expected) in [(4.0, 1.063_623_217), (10.0, 4.865_182_052), (30.0, 20.599_234_615)] {
            assert!((low_chi_squared(freedom) / expected - 1.0).abs() < 1e-7, "{}", low_chi_squared(freedom));
        }
    }
}
