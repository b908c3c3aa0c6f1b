/// Powers of ten that a double holds exactly.
const EXACT_POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// A plain decimal number at the start of `bytes`, and its length in bytes; `decimal` is its decimal sign.
///
/// Correctly rounded: up to 2^53 a mantissa is exact, so are the powers of ten to 10^22, and one division or
/// product of exact numbers rounds once. `None` for everything else (long mantissas, large exponents, words);
/// that is left to [`parse`].
#[inline]
pub(super) fn parse_prefix(bytes: &[u8], decimal: u8) -> Option<(f64, usize)> {
    let mut at = 0;
    let negative = bytes.first() == Some(&b'-');
    if negative || bytes.first() == Some(&b'+') {
        at = 1;
    }
    let mut mantissa = 0_u64;
    let first = at;
    while let Some(digit) = bytes.get(at).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
        mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    let mut digits = at - first;
    let mut exponent = 0_i64;
    if bytes.get(at) == Some(&decimal) {
        at += 1;
        let first = at;
        while let Some(digit) = bytes.get(at).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
            mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
            at += 1;
        }
        digits += at - first;
        exponent = first as i64 - at as i64;
    }
    // Nineteen digits cannot overflow; with more the mantissa has wrapped.
    if digits == 0 || digits > 19 || mantissa > 1 << 53 {
        return None;
    }
    if matches!(bytes.get(at), Some(b'e' | b'E')) {
        at += 1;
        let minus = bytes.get(at) == Some(&b'-');
        if minus || bytes.get(at) == Some(&b'+') {
            at += 1;
        }
        let first = at;
        let mut value = 0_i64;
        while let Some(digit) = bytes.get(at).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
            value = (value * 10 + i64::from(digit)).min(10_000);
            at += 1;
        }
        if at == first {
            return None;
        }
        exponent += if minus { -value } else { value };
    }
    let power = *EXACT_POWERS.get(usize::try_from(exponent.abs()).ok()?)?;
    let magnitude = if exponent < 0 { mantissa as f64 / power } else { mantissa as f64 * power };
    Some((if negative { -magnitude } else { magnitude }, at))
}

/// The number that is all of `cell`, which may be infinite or not a number; `None` for any other text.
pub(super) fn parse(cell: &[u8], decimal: u8) -> Option<f64> {
    if let Some((value, length)) = parse_prefix(cell, decimal)
        && length == cell.len()
    {
        return Some(value);
    }
    let text = std::str::from_utf8(cell).ok()?;
    if decimal == b',' {
        if text.contains('.') {
            return None;
        }
        return text.replacen(',', ".", 1).parse().ok();
    }
    text.parse().ok()
}
