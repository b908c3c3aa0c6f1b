//! Student's distribution through the normal one (Wallace 1959, *Annals of Mathematical Statistics* 30).

fn wallace(freedom: f64) -> f64 {
    (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0)
}

/// The normal deviate that 5 % exceed.
pub const ONE_SIDED_5: f64 = 1.644_853_626_951_472;

/// The mean of some values over its standard error: Student's t with one degree of freedom less than there are values.
#[must_use]
pub fn in_standard_errors(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    mean / (variance / n).sqrt()
}

/// The normal deviate with the probability of Student's t.
pub(crate) fn normal(t: f64, freedom: f64) -> f64 {
    let z = wallace(freedom) * (freedom * libm::log1p(t * t / freedom)).sqrt();
    z.copysign(t)
}

/// Student's t with the probability of a normal deviate.
#[must_use]
pub fn student(z: f64, freedom: f64) -> f64 {
    let t = (freedom * libm::expm1((z / wallace(freedom)).powi(2) / freedom)).sqrt();
    t.copysign(z)
}

/// What χ² of some degrees of freedom exceeds with 90 % probability (Wilson and Hilferty 1931).
pub(crate) fn low_chi_squared(freedom: f64) -> f64 {
    const NORMAL_10: f64 = -1.281_551_565_545;
    let part = 2.0 / (9.0 * freedom);
    freedom * (1.0 - part + NORMAL_10 * part.sqrt()).powi(3)
}

/// The probability that χ² of some degrees of freedom exceeds a value (Wilson and Hilferty 1931).
pub(crate) fn chi_squared_above(value: f64, freedom: f64) -> f64 {
    let part = 2.0 / (9.0 * freedom);
    let deviate = (libm::cbrt(value / freedom) - 1.0 + part) / part.sqrt();
    0.5 * libm::erfc(deviate / std::f64::consts::SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uncertainty::NORMAL_95;

    /// Quantiles of Student's distribution from tables: t_0.975 with 5, 10 and 30 degrees of freedom.
    #[test]
    fn students_quantiles_are_those_of_tables() {
        for (freedom, expected) in [(5.0, 2.5706), (10.0, 2.2281), (30.0, 2.0423)] {
            assert!((student(NORMAL_95, freedom) / expected - 1.0).abs() < 5e-3);
            assert!((normal(expected, freedom) / NORMAL_95 - 1.0).abs() < 5e-3);
            assert_eq!(student(-1.0, freedom), -student(1.0, freedom));
        }
    }

    /// Quantiles of χ² from tables: 10 % with 4, 10 and 30 degrees of freedom.
    #[test]
    fn quantiles_of_chi_squared_are_those_of_tables() {
        for (freedom, expected) in [(4.0, 1.0636), (10.0, 4.8652), (30.0, 20.599)] {
            assert!((low_chi_squared(freedom) / expected - 1.0).abs() < 2e-2, "{}", low_chi_squared(freedom));
        }
    }

    /// Quantiles of χ² from tables: 5 % with 4, 10 and 48 degrees of freedom.
    #[test]
    fn probabilities_of_chi_squared_are_those_of_tables() {
        for (freedom, value) in [(4.0, 9.488), (10.0, 18.307), (48.0, 65.171)] {
            let found = chi_squared_above(value, freedom);
            assert!((found / 0.05 - 1.0).abs() < 0.03, "{found}");
        }
    }
}
