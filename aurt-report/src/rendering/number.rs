//! Numbers as tables show them.

/// `value` with that many significant digits; a dash where there is no value.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    if value == 0.0 {
        return "0".into();
    }
    let rounded = format!("{value:.*e}", digits.saturating_sub(1));
    let exponent: i32 = rounded.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    let decimals = digits as i32 - 1 - exponent;
    if (-4..6).contains(&exponent) { format!("{value:.*}", decimals.max(0) as usize) } else { rounded }
}

/// A share as a percentage with one decimal, two below ten.
pub fn percent(share: f64) -> String {
    let value = 100.0 * share;
    if !value.is_finite() {
        "–".into()
    } else if value.abs() < 9.995 {
        format!("{value:.2}")
    } else {
        format!("{value:.1}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_significant_ones() {
        assert_eq!(significant(0.081_486_3, 4), "0.08149");
        assert_eq!(significant(9.999_96, 4), "10.00");
        assert_eq!(significant(-1234.56, 4), "-1235");
        assert_eq!(significant(1.234_56e-7, 3), "1.23e-7");
        assert_eq!(significant(f64::NAN, 3), "–");
        assert_eq!(significant(0.0, 3), "0");
        assert_eq!(percent(0.1041), "10.4");
        assert_eq!(percent(0.0104), "1.04");
    }
}
