/// What separates the cells of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Delimiter {
    Comma,
    Semicolon,
    Tab,
    /// Runs of spaces (and tabs among them).
    Spaces,
}

impl Delimiter {
    /// The separating byte; a space for [`Self::Spaces`].
    pub(super) const fn byte(self) -> u8 {
        match self {
            Self::Comma => b',',
            Self::Semicolon => b';',
            Self::Tab => b'\t',
            Self::Spaces => b' ',
        }
    }

    const fn in_words(self) -> &'static str {
        match self {
            Self::Comma => "commas",
            Self::Semicolon => "semicolons",
            Self::Tab => "tabs",
            Self::Spaces => "spaces",
        }
    }
}

/// How the cells of a file are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Dialect {
    pub(super) delimiter: Delimiter,
    /// Whether 1,5 means one and a half.
    pub(super) decimal_comma: bool,
}

impl Dialect {
    /// The dialect of some lines of data, the header among them if there is one.
    ///
    /// A delimiter is one that the first line has and that most lines have as often as the first; of equals the one
    /// that leaves the most cells readable as numbers, then in the order below. A comma is a decimal comma where another
    /// delimiter separates the cells and no number has a point.
    pub(super) fn detect(lines: &[&[u8]]) -> Self {
        let mut delimiter = Delimiter::Spaces;
        let mut best = (0, 0.0);
        for candidate in [Delimiter::Tab, Delimiter::Semicolon, Delimiter::Comma, Delimiter::Spaces] {
            let Some(first) = lines.first().map(|l| count(l, candidate)).filter(|c| *c > 0) else { continue };
            let alike = lines.iter().filter(|l| count(l, candidate) == first).count();
            let score = (alike, readable_share(lines, candidate));
            if score > best {
                best = score;
                delimiter = candidate;
            }
        }
        let mut dialect = Self { delimiter, decimal_comma: false };
        if matches!(delimiter, Delimiter::Semicolon | Delimiter::Tab) {
            let (mut commas, mut points) = (false, false);
            for line in lines {
                for cell in dialect.cells(line) {
                    points |= cell.contains(&b'.') && parse_number(cell, b'.').is_some();
                    commas |= cell.contains(&b',') && parse_number(cell, b',').is_some();
                }
            }
            dialect.decimal_comma = commas && !points;
        }
        dialect
    }

    pub(super) const fn decimal(self) -> u8 {
        if self.decimal_comma { b',' } else { b'.' }
    }

    /// The cells of a line, without surrounding blanks and quotes.
    pub(super) fn cells<'a>(self, line: &'a [u8]) -> Cells<'a> {
        Cells { delimiter: self.delimiter, rest: Some(line) }
    }

    pub(super) fn in_words(self) -> String {
        let decimal = if self.decimal_comma { ", decimal commas" } else { "" };
        format!("separated by {}{decimal}", self.delimiter.in_words())
    }
}

fn readable_share(lines: &[&[u8]], delimiter: Delimiter) -> f64 {
    let dialect = Dialect { delimiter, decimal_comma: false };
    let is_number = |cell: &&[u8]| parse_number(cell, b'.').or_else(|| parse_number(cell, b',')).is_some();
    let cells = || lines.iter().flat_map(|line| dialect.cells(line));
    cells().filter(is_number).count() as f64 / cells().count().max(1) as f64
}

/// How often a delimiter stands in a line outside quotes.
fn count(line: &[u8], delimiter: Delimiter) -> usize {
    if delimiter == Delimiter::Spaces {
        return Cells { delimiter, rest: Some(line) }.count().saturating_sub(1);
    }
    let mut quoted = false;
    let mut count = 0;
    for byte in line {
        quoted ^= *byte == b'"';
        count += usize::from(!quoted && *byte == delimiter.byte());
    }
    count
}

pub(super) struct Cells<'a> {
    delimiter: Delimiter,
    rest: Option<&'a [u8]>,
}

impl<'a> Iterator for Cells<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let mut rest = self.rest?;
        let spaces = self.delimiter == Delimiter::Spaces;
        if spaces {
            rest = rest.trim_ascii_start();
            if rest.is_empty() {
                self.rest = None;
                return None;
            }
        }
        let mut quoted = false;
        let end = rest.iter().position(|b| {
            quoted ^= *b == b'"';
            !quoted && if spaces { is_blank(*b) } else { *b == self.delimiter.byte() }
        });
        let cell = match end {
            Some(end) => {
                self.rest = Some(&rest[end + 1..]);
                &rest[..end]
            }
            None => {
                self.rest = None;
                rest
            }
        };
        Some(unquote(cell.trim_ascii()))
    }
}

/// Whether a byte separates cells in a file separated by spaces.
pub(super) const fn is_blank(byte: u8) -> bool {
    byte == b' ' || byte == b'\t'
}

fn unquote(cell: &[u8]) -> &[u8] {
    for quote in [b'"', b'\''] {
        if let [first, inner @ .., last] = cell
            && *first == quote
            && *last == quote
        {
            return inner.trim_ascii();
        }
    }
    cell
}

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
pub(super) fn parse_number(cell: &[u8], decimal: u8) -> Option<f64> {
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
