//! What can have happened to a file.

use std::iter;

/// A generator that gives the same numbers everywhere (Knuth's constants for a linear congruence).
pub struct Draws(pub u64);

impl Draws {
    pub fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % bound.max(1)
    }
}

/// What is done to a file before a command reads it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damage {
    /// Nothing; the command has to succeed.
    None,
    Missing,
    Empty,
    Folder,
    Device,
    Pipe,
    Truncated,
    Flipped(usize),
    Mark,
    CarriageReturns,
    Utf16,
    Zero,
    Gzip,
    LongLine(usize),
    Number(&'static str),
    DoubledLine,
    MissingLine,
    DoubledColumn,
    MissingColumn,
    Nested(usize),
    Columns(usize),
    Escapes,
    Name(&'static str),
}

/// Every damage; those that draw something come several times.
pub fn all(draws: usize) -> Vec<Damage> {
    use Damage as D;
    let mut list = vec![
        D::None,
        D::Missing,
        D::Empty,
        D::Folder,
        D::Device,
        D::Pipe,
        D::Mark,
        D::CarriageReturns,
        D::Utf16,
        D::Zero,
        D::Gzip,
        D::DoubledColumn,
        D::MissingColumn,
        D::Nested(100),
        D::Nested(100_000),
        D::Columns(1_000),
        D::Columns(100_000),
        D::LongLine(1_000_000),
        D::LongLine(50_000_000),
        D::Escapes,
    ];
    list.extend(
        ["with space", "ünïcode", "of $HOME", "line\nfeed", "-dash", "quote\"", "tab\t"].map(D::Name),
    );
    for _ in 0..draws {
        list.extend([D::Truncated, D::Flipped(1), D::Flipped(20), D::DoubledLine, D::MissingLine]);
        let numbers =
            ["1e308", "-1e308", "nan", "inf", "5e-324", "-1", "0", "18446744073709551615", "1e-300", "3.5"];
        list.extend(numbers.map(D::Number));
    }
    list
}

impl Damage {
    /// The bytes of a file after it; `None` where it is no matter of bytes.
    pub fn of(self, bytes: &[u8], draws: &mut Draws) -> Option<Vec<u8>> {
        let lines = || bytes.split_inclusive(|b| *b == b'\n').collect::<Vec<_>>();
        let cells = |change: fn(&mut Vec<&[u8]>)| -> Vec<u8> {
            let of_line = |line: &[u8]| {
                let mut cells: Vec<&[u8]> = line.split(|b| *b == b',').collect();
                if cells.len() > 1 {
                    change(&mut cells);
                }
                cells.join(&b","[..])
            };
            let lines: Vec<Vec<u8>> = bytes.split(|b| *b == b'\n').map(of_line).collect();
            lines.join(&b"\n"[..])
        };
        let with = |at: usize, more: &mut dyn Iterator<Item = u8>| {
            let mut bytes = bytes.to_vec();
            bytes.splice(at..at, more);
            bytes
        };
        let first = |of: &[u8]| bytes.iter().position(|b| of.contains(b)).unwrap_or(bytes.len());
        let mut anywhere = || draws.below(bytes.len());
        Some(match self {
            Self::None | Self::Missing | Self::Folder | Self::Device | Self::Pipe | Self::Name(_) => {
                return None;
            }
            Self::Empty => Vec::new(),
            Self::Truncated => bytes[..anywhere()].to_vec(),
            Self::Flipped(count) => {
                let mut bytes = bytes.to_vec();
                for _ in 0..count {
                    let at = draws.below(bytes.len());
                    bytes[at] ^= 1 << draws.below(8);
                }
                bytes
            }
            Self::Mark => [b"\xef\xbb\xbf", bytes].concat(),
            Self::CarriageReturns => String::from_utf8_lossy(bytes).replace('\n', "\r\n").into_bytes(),
            Self::Utf16 => {
                let text = String::from_utf8_lossy(bytes).into_owned();
                let units = iter::once(0xfeff).chain(text.encode_utf16());
                units.flat_map(u16::to_le_bytes).collect()
            }
            Self::Zero => with(anywhere(), &mut iter::once(0)),
            Self::Gzip => [b"\x1f\x8b\x08\0\0\0\0\0", bytes].concat(),
            Self::LongLine(length) => with(anywhere(), &mut iter::repeat_n(b'7', length)),
            Self::Number(number) => with_number(bytes, number, draws),
            Self::DoubledLine => {
                let mut lines = lines();
                let at = draws.below(lines.len());
                lines.insert(at, lines[at]);
                lines.concat()
            }
            Self::MissingLine => {
                let mut lines = lines();
                lines.remove(draws.below(lines.len()));
                lines.concat()
            }
            Self::DoubledColumn => cells(|cells| cells.insert(1, cells[1])),
            Self::MissingColumn => cells(|cells| {
                cells.remove(1);
            }),
            Self::Nested(depth) => with(first(b"[{"), &mut iter::repeat_n(b'[', depth)),
            Self::Columns(count) => {
                with(first(b"\n"), &mut (0..count).flat_map(|k| format!(",x{k}").into_bytes()))
            }
            Self::Escapes => with(anywhere(), &mut b"\x1b[2J\x1b]0;x\x07".iter().copied()),
        })
    }
}

/// The text with one of its numbers replaced. Digits of names and of hashes are no numbers.
fn with_number(bytes: &[u8], number: &str, draws: &mut Draws) -> Vec<u8> {
    let part = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'e');
    let end_of = |begin: usize| begin + bytes[begin..].iter().take_while(|b| part(b)).count();
    let word = |b: Option<&u8>| b.is_some_and(|b| b.is_ascii_alphanumeric() || *b == b'_');
    let begins: Vec<usize> = (0..bytes.len())
        .filter(|k| {
            bytes[*k].is_ascii_digit() && (*k == 0 || !part(&bytes[k - 1]) && !word(bytes.get(k - 1)))
        })
        .filter(|k| !word(bytes.get(end_of(*k))))
        .collect();
    if begins.is_empty() {
        return bytes.to_vec();
    }
    let begin = begins[draws.below(begins.len())];
    [&bytes[..begin], number.as_bytes(), &bytes[end_of(begin)..]].concat()
}
