//! How numbers are written in pages.
//!
//! Source: Apache Parquet, "Encodings" (`Encodings.md` of the format).

use crate::parquet::footer::Number;

/// Bytes that are taken from the front.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bytes<'a>(pub(super) &'a [u8]);

impl<'a> Bytes<'a> {
    pub(super) fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    pub(super) fn length(&mut self) -> Option<usize> {
        let bytes: [u8; 4] = self.take(4)?.try_into().ok()?;
        usize::try_from(u32::from_le_bytes(bytes)).ok()
    }

    fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.take(1)?[0];
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }

    fn zigzag(&mut self) -> Option<i64> {
        let bits = self.varint()?;
        Some((bits >> 1) as i64 ^ -((bits & 1) as i64))
    }
}

/// Bits that a number up to `largest` needs.
pub(super) const fn bits(largest: u64) -> u32 {
    64 - largest.leading_zeros()
}

/// Number `k` of those that are packed with `width` bits each, the least significant first.
fn packed(bytes: &[u8], k: usize, width: u32) -> u64 {
    let (begin, mut value, mut have) = (k * width as usize, 0_u64, 0);
    let (mut at, mut shift) = (begin / 8, (begin % 8) as u32);
    while have < width {
        let byte = bytes.get(at).copied().unwrap_or(0);
        value |= u64::from(byte >> shift) << have;
        have += 8 - shift;
        (at, shift) = (at + 1, 0);
    }
    if width == 64 { value } else { value & ((1 << width) - 1) }
}

/// `count` numbers in runs and packed groups of eight (`RLE`), each of `width` bits.
pub(super) fn runs(mut bytes: Bytes<'_>, width: u32, count: usize) -> Option<Vec<u32>> {
    if width > 32 {
        return None;
    }
    let mut values = Vec::new();
    if width == 0 {
        values.resize(count, 0);
    }
    while values.len() < count {
        let (head, left) = (bytes.varint()?, count - values.len());
        let groups = usize::try_from(head >> 1).ok()?;
        if head & 1 == 0 {
            let raw = bytes.take(width.div_ceil(8) as usize)?;
            let value = raw.iter().rev().fold(0_u32, |v, b| v << 8 | u32::from(*b));
            values.resize(values.len() + groups.min(left), value);
        } else {
            // The last group may lack values that are not needed.
            let most = groups.checked_mul(width as usize)?;
            let group = bytes.take(most.min(bytes.0.len()))?;
            let there = (group.len() * 8 / width as usize).min(left);
            if there == 0 {
                return None;
            }
            values.extend((0..there).map(|k| packed(group, k, width) as u32));
        }
    }
    Some(values)
}

/// `count` numbers one after the other (`PLAIN`).
pub(super) fn plain(bytes: Bytes<'_>, number: Number, count: usize) -> Option<Vec<f64>> {
    let mut bytes = bytes;
    if number == Number::Truth {
        let packed_bytes = bytes.take(count.div_ceil(8))?;
        return Some((0..count).map(|k| packed(packed_bytes, k, 1) as f64).collect());
    }
    let raw = bytes.take(count.checked_mul(number.bytes())?)?;
    Some(match number {
        Number::Truth => Vec::new(),
        Number::Double => fixed(raw, f64::from_le_bytes),
        Number::Single => fixed(raw, |b| f64::from(f32::from_le_bytes(b))),
        Number::Int { bytes: 4, .. } => fixed(raw, |b| number.of_int(i64::from(i32::from_le_bytes(b)))),
        Number::Int { .. } | Number::Stamp { .. } => fixed(raw, |b| number.of_int(i64::from_le_bytes(b))),
    })
}

fn fixed<const N: usize>(raw: &[u8], value: impl Fn([u8; N]) -> f64) -> Vec<f64> {
    raw.as_chunks().0.iter().map(|bytes| value(*bytes)).collect()
}

/// `count` numbers whose first bytes stand together, then their second (`BYTE_STREAM_SPLIT`).
pub(super) fn split(bytes: Bytes<'_>, number: Number, count: usize) -> Option<Vec<f64>> {
    let width = number.bytes();
    let raw = Bytes(bytes.0).take(count.checked_mul(width)?)?;
    let together: Vec<u8> = (0..raw.len()).map(|k| raw[k % width * count + k / width]).collect();
    plain(Bytes(&together), number, count)
}

/// `count` integers as differences of those before them (`DELTA_BINARY_PACKED`).
pub(super) fn differences(mut bytes: Bytes<'_>, number: Number, count: usize) -> Option<Vec<f64>> {
    let block = usize::try_from(bytes.varint()?).ok()?;
    let parts = usize::try_from(bytes.varint()?).ok()?;
    let total = usize::try_from(bytes.varint()?).ok()?;
    let mut last = bytes.zigzag()?;
    let of_part = block.checked_div(parts)?;
    if of_part == 0 || of_part % 8 != 0 || total < count {
        return None;
    }
    let mut values = Vec::new();
    let keep = |value: i64| number.of_int(if number.bytes() == 4 { i64::from(value as i32) } else { value });
    if count > 0 {
        values.push(keep(last));
    }
    while values.len() < count {
        let least = bytes.zigzag()?;
        let widths = bytes.take(parts)?;
        for width in widths {
            if values.len() >= count {
                break;
            }
            let width = u32::from(*width);
            if width > 64 {
                return None;
            }
            let part = bytes.take(of_part.checked_mul(width as usize)? / 8)?;
            for k in 0..of_part.min(count - values.len()) {
                last = last.wrapping_add(least).wrapping_add(packed(part, k, width) as i64);
                values.push(keep(last));
            }
        }
    }
    Some(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_and_groups_are_those_of_the_specification() {
        // 0 … 7 in three bits each, the example of the specification; then five times 4.
        let bytes = [0b11, 0b1000_1000, 0b1100_0110, 0b1111_1010, 5 << 1, 4];
        assert_eq!(runs(Bytes(&bytes), 3, 13).unwrap(), [0, 1, 2, 3, 4, 5, 6, 7, 4, 4, 4, 4, 4]);
        assert_eq!(runs(Bytes(&[]), 0, 3).unwrap(), [0; 3]);
        assert!(runs(Bytes(&bytes), 3, 14).is_none());
    }

    #[test]
    fn differences_are_summed() {
        // 7, 5, 3, 1, 2, 3, 4, 5, the second example of the specification: differences −2 −2 −2 1 1 1 1 are written as
        // −2 and 0 0 0 3 3 3 3 in two bits.
        let bytes = [0x80, 0x01, 4, 8, 14, 3, 2, 0, 0, 0, 0b1100_0000, 0b1111_1111, 0, 0, 0, 0, 0, 0];
        let number = Number::Int { bytes: 8, signed: true };
        assert_eq!(differences(Bytes(&bytes), number, 8).unwrap(), [7.0, 5.0, 3.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        for end in 0..10 {
            assert!(differences(Bytes(&bytes[..end]), number, 8).is_none(), "{end}");
        }
    }

    #[test]
    fn bytes_of_a_column_that_stand_apart_come_together() {
        let values = [1.5_f64, -2.25, 1e300];
        let split_bytes: Vec<u8> = (0..8).flat_map(|byte| values.map(|v| v.to_le_bytes()[byte])).collect();
        assert_eq!(split(Bytes(&split_bytes), Number::Double, 3).unwrap(), values);
        assert!(split(Bytes(&split_bytes), Number::Double, 4).is_none());
    }
}
