use parquet::basic::{ConvertedType, LogicalType, Repetition, TimeUnit, Type as Physical};
use parquet::file::metadata::{ParquetMetaData, ParquetMetaDataReader};
use parquet::schema::types::SchemaDescriptor;

use crate::guarded::guarded;

/// Structures nest no deeper than this in files that are sound; the crate descends into as many as a file claims.
const DEEPEST: usize = 32;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    Stored,
    Unsigned,
    /// Moments since 1970 in parts of a second, given in seconds from `origin` on.
    Stamp {
        per_second: i64,
        origin: i64,
    },
}

impl Number {
    pub(super) const fn of_long(self, value: i64) -> f64 {
        match self {
            Self::Stored => value as f64,
            Self::Unsigned => value as u64 as f64,
            Self::Stamp { per_second, origin } => value.saturating_sub(origin) as f64 / per_second as f64,
        }
    }

    pub(super) const fn of_int(self, value: i32) -> f64 {
        if matches!(self, Self::Unsigned) { value as u32 as f64 } else { value as f64 }
    }
}

#[derive(Debug, Clone)]
pub(super) struct Leaf {
    /// Its name, with those of the structures around it.
    pub(super) name: String,
    pub(super) place: usize,
    pub(super) number: Number,
    /// Level of a number that is there; below it, it is missing.
    pub(super) defined: i16,
    /// For lists the level from which on there is a place for a number.
    pub(super) listed: Option<i16>,
}

/// The description of a file at its end; none if it cannot be one.
pub(super) fn decode(bytes: &[u8]) -> Option<ParquetMetaData> {
    Compact(bytes).schema()?;
    guarded(|| ParquetMetaDataReader::decode_metadata(bytes).ok()).flatten()
}

/// The columns of numbers, and the names of the others.
pub(super) fn leaves(schema: &SchemaDescriptor) -> (Vec<Leaf>, Vec<String>) {
    let (mut leaves, mut others) = (Vec::new(), Vec::new());
    for (place, column) in schema.columns().iter().enumerate() {
        let mut node = schema.get_column_root(place);
        let mut names = Vec::new();
        for below in column.path().parts().iter().skip(1).map(Some).chain([None]) {
            if node.get_basic_info().repetition() == Repetition::REPEATED {
                break;
            }
            names.push(node.name());
            let next = below.and_then(|name| node.get_fields().iter().find(|field| field.name() == name));
            let Some(next) = next else { break };
            node = next;
        }
        let name = if names.is_empty() { column.name().to_owned() } else { names.join(".") };
        let number = number(column.physical_type(), column.logical_type_ref(), column.converted_type());
        match number.filter(|_| column.max_rep_level() <= 1) {
            Some(number) => leaves.push(Leaf {
                name,
                place,
                number,
                defined: column.max_def_level(),
                listed: (column.max_rep_level() == 1).then(|| column.repeated_ancestor_def_level()),
            }),
            None => others.push(name),
        }
    }
    (leaves, others)
}

fn number(physical: Physical, logical: Option<&LogicalType>, converted: ConvertedType) -> Option<Number> {
    use ConvertedType as Old;
    let stamp = |per_second| Number::Stamp { per_second, origin: 0 };
    match (physical, logical, converted) {
        (_, Some(LogicalType::Decimal(_)), _) | (_, _, Old::DECIMAL) => None,
        (Physical::INT64, Some(LogicalType::Timestamp(of)), _) => Some(stamp(match of.unit {
            TimeUnit::MILLIS => 1_000,
            TimeUnit::MICROS => 1_000_000,
            TimeUnit::NANOS => 1_000_000_000,
        })),
        (Physical::INT64, _, Old::TIMESTAMP_MILLIS) => Some(stamp(1_000)),
        (Physical::INT64, _, Old::TIMESTAMP_MICROS) => Some(stamp(1_000_000)),
        (Physical::INT32 | Physical::INT64, Some(LogicalType::Integer(of)), _) if !of.is_signed => {
            Some(Number::Unsigned)
        }
        (_, _, Old::UINT_8 | Old::UINT_16 | Old::UINT_32 | Old::UINT_64) => Some(Number::Unsigned),
        (Physical::BOOLEAN | Physical::INT32 | Physical::INT64 | Physical::FLOAT | Physical::DOUBLE, ..) => {
            Some(Number::Stored)
        }
        _ => None,
    }
}

/// Structures in Thrift's compact protocol, as far as they have to be looked at before the crate takes room for what they
/// claim. `None` if the bytes end or cannot be what they claim.
///
/// Source: Apache Thrift, "Thrift Compact protocol encoding".
pub(super) struct Compact<'a>(pub(super) &'a [u8]);

impl Compact<'_> {
    const INT: u8 = 5;

    fn byte(&mut self) -> Option<u8> {
        let (byte, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*byte)
    }

    fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
        None
    }

    /// An integer in the field after the one before.
    fn next_int(&mut self) -> Option<u64> {
        let head = self.byte()?;
        let value = self.varint()?;
        // Twice the value; negative ones are odd.
        (head == 0x10 | Self::INT && value % 2 == 0).then_some(value / 2)
    }

    /// The fields that a page header begins with: its kind, and the bytes of the page before and after packing.
    pub(super) fn page_sizes(&mut self) -> Option<[u64; 2]> {
        self.next_int()?;
        Some([self.next_int()?, self.next_int()?])
    }

    /// Bytes of a page before those that are packed, from the fields after its sizes: none, or the levels of a page of
    /// version 2.
    pub(super) fn packed_at(&mut self) -> Option<u64> {
        let (mut head, mut id) = (self.byte()?, 3);
        if head == 0x10 | Self::INT {
            self.varint()?;
            (head, id) = (self.byte()?, 4);
        }
        match (id + (head >> 4), head & 0x0f) {
            (5..=7, 12) => Some(0),
            (8, 12) => {
                for _ in 0..4 {
                    self.next_int()?;
                }
                Some(self.next_int()? + self.next_int()?)
            }
            _ => None,
        }
    }

    /// Looks through the nodes of the schema, which stand after the version, for structures within each other.
    fn schema(&mut self) -> Option<()> {
        if self.byte()? != 0x10 | Self::INT || self.varint().is_none() || self.byte()? != 0x19 {
            return None;
        }
        let head = self.byte()?;
        let count = if head >> 4 == 15 { self.varint()? } else { u64::from(head >> 4) };
        // For each open node its children that are still to come.
        let mut open: Vec<u64> = Vec::new();
        for _ in 0..count {
            let children = self.node(4)?;
            while open.last() == Some(&0) {
                open.pop();
            }
            if let Some(left) = open.last_mut() {
                *left -= 1;
            }
            open.push(children);
            if open.len() > DEEPEST {
                return None;
            }
        }
        Some(())
    }

    /// Passes over a structure; its field 5, the children of a node of the schema.
    fn node(&mut self, depth: usize) -> Option<u64> {
        let (mut id, mut children) = (0, 0);
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Some(children);
            }
            id = if head >> 4 == 0 { self.varint()? / 2 } else { id + u64::from(head >> 4) };
            match head & 0x0f {
                1 | 2 => {}
                3 => drop(self.byte()?),
                4..=6 => {
                    let value = self.varint()?;
                    if id == 5 {
                        children = value / 2;
                    }
                }
                8 => {
                    let length = usize::try_from(self.varint()?).ok()?;
                    self.0 = self.0.get(length..)?;
                }
                12 if depth > 0 => drop(self.node(depth - 1)?),
                _ => return None,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A footer whose schema has nodes with so many children.
    fn footer(children: impl Iterator<Item = u8>) -> Vec<u8> {
        let nodes: Vec<[u8; 6]> = children.map(|n| [0x35, 0, 0x18, 0, 0x15, 2 * n]).collect();
        let mut bytes = vec![0x15, 2, 0x19, 0xfc];
        bytes.extend([nodes.len() as u8 | 0x80, (nodes.len() >> 7) as u8]);
        bytes.extend(nodes.iter().flat_map(|node| node.iter().copied().chain([0])));
        bytes
    }

    #[test]
    fn schemas_that_nest_deeply_are_refused_before_they_are_built() {
        let nested = |depth: usize| footer(std::iter::repeat_n(1, depth).chain([0]));
        assert!(Compact(&nested(DEEPEST - 1)).schema().is_some());
        assert!(Compact(&nested(DEEPEST)).schema().is_none());
        assert!(decode(&nested(10_000)).is_none());
        let wide = footer(std::iter::once(60).chain(std::iter::repeat_n(0, 60)));
        assert!(Compact(&wide).schema().is_some());
        for end in 0..wide.len() {
            assert!(Compact(&wide[..end]).schema().is_none(), "{end}");
        }
    }

    #[test]
    fn sizes_of_pages_are_read_from_their_headers() {
        assert_eq!(Compact(&[0x15, 0, 0x15, 0x80, 0x01, 0x15, 6]).page_sizes(), Some([64, 3]));
        for header in [&[0x15, 0, 0x15, 1, 0x15, 6], &[0x15, 0, 0x25, 2, 0x15, 6]] {
            assert_eq!(Compact(header).page_sizes(), None, "negative, or a field left out");
        }
        let levels = [0x15, 2, 0x15, 2, 0x15, 2, 0x15, 0, 0x15, 8, 0x15, 6];
        assert_eq!(Compact(&[&[0x5c][..], &levels].concat()).packed_at(), Some(7));
        assert_eq!(
            Compact(&[&[0x15, 9, 0x4c][..], &levels].concat()).packed_at(),
            Some(7),
            "with a checksum"
        );
        assert_eq!(Compact(&[0x2c, 0x15, 2]).packed_at(), Some(0));
        assert_eq!(Compact(&levels).packed_at(), None);
    }
}
