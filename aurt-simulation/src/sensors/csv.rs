//! Decimal numbers of fixed resolution, as loggers write them.

/// Appends `value` rounded to `decimals` places (at most 12), without an exponent.
pub(super) fn push_decimal(text: &mut Vec<u8>, value: f64, decimals: usize) {
    const POWERS: [f64; 13] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12];
    let scaled = value * POWERS[decimals.min(12)];
    if !scaled.is_finite() || scaled.abs() >= 9.0e15 {
        text.extend_from_slice(format!("{value:e}").as_bytes());
        return;
    }
    let rounded = (scaled.abs() + 0.5) as u64;
    if value < 0.0 && rounded > 0 {
        text.push(b'-');
    }
    let mut digits = [b'0'; 24];
    let mut end = digits.len();
    let mut rest = rounded;
    let mut written = 0;
    while rest > 0 || written <= decimals {
        if decimals > 0 && written == decimals {
            end -= 1;
            digits[end] = b'.';
        }
        end -= 1;
        digits[end] = b'0' + (rest % 10) as u8;
        rest /= 10;
        written += 1;
    }
    text.extend_from_slice(&digits[end..]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(value: f64, decimals: usize) -> String {
        let mut out = Vec::new();
        push_decimal(&mut out, value, decimals);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn examples() {
        assert_eq!(text(0.0, 3), "0.000");
        assert_eq!(text(-0.0004, 3), "0.000");
        assert_eq!(text(-0.0006, 3), "-0.001");
        assert_eq!(text(12.5, 0), "13");
        assert_eq!(text(1234.56789, 2), "1234.57");
        assert_eq!(text(1e150, 4), "1e150");
    }

    proptest! {
        #[test]
        fn reads_back_within_half_a_step(value in -1e4..1e4_f64, decimals in 0..8_usize) {
            let back: f64 = text(value, decimals).parse().unwrap();
            prop_assert!((back - value).abs() <= 0.5 * 10_f64.powi(-(decimals as i32)) * (1.0 + 1e-9));
        }
    }
}
