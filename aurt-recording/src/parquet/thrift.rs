use std::io::Read;

/// Structures nest no deeper than this in files that are sound.
const DEEPEST: u32 = 32;
/// Longer texts are none.
const TEXT_LIMIT: u64 = 1 << 20;

pub(super) const TRUE: u8 = 1;
const FALSE: u8 = 2;
const BYTE: u8 = 3;
const I16: u8 = 4;
const I32: u8 = 5;
const I64: u8 = 6;
const DOUBLE: u8 = 7;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const SET: u8 = 10;
const MAP: u8 = 11;
const STRUCT: u8 = 12;
const UUID: u8 = 13;

/// Structures in Thrift's compact protocol, as the footer and the page headers are written.
///
/// Every method gives `None` if the bytes end or cannot be what they claim.
///
/// Source: Apache Thrift, "Thrift Compact protocol encoding".
#[derive(Debug)]
pub(super) struct Thrift<R> {
    source: R,
    /// Bytes that were read.
    pub(super) read: u64,
}

impl<R: Read> Thrift<R> {
    pub(super) const fn new(source: R) -> Self {
        Self { source, read: 0 }
    }

    /// Hands each field of a structure to `take` with its number and kind; fields that it does not read (`false`) are
    /// skipped.
    pub(super) fn fields(&mut self, take: &mut dyn FnMut(&mut Self, i16, u8) -> Option<bool>) -> Option<()> {
        let mut id = 0_i16;
        loop {
            let head = self.byte()?;
            if head == 0 {
                return Some(());
            }
            let (step, kind) = (head >> 4, head & 0x0f);
            id = if step == 0 { i16::try_from(self.int()?).ok()? } else { id.checked_add(i16::from(step))? };
            if !take(self, id, kind)? {
                self.pass_over(kind, 0)?;
            }
        }
    }

    /// Hands each member of a list to `take`.
    pub(super) fn list(&mut self, take: &mut dyn FnMut(&mut Self) -> Option<()>) -> Option<()> {
        for _ in 0..self.list_head()?.0 {
            take(self)?;
        }
        Some(())
    }

    /// An integer of any width.
    pub(super) fn int(&mut self) -> Option<i64> {
        let bits = self.varint()?;
        Some((bits >> 1) as i64 ^ -((bits & 1) as i64))
    }

    pub(super) fn text(&mut self) -> Option<String> {
        let length = self.varint()?;
        let bytes = self.bytes(length.le(&TEXT_LIMIT).then_some(length)?)?;
        Some(String::from_utf8_lossy(&bytes).into_owned())
    }

    fn list_head(&mut self) -> Option<(u64, u8)> {
        let head = self.byte()?;
        let count = if head >> 4 == 15 { self.varint()? } else { u64::from(head >> 4) };
        Some((count, head & 0x0f))
    }

    fn byte(&mut self) -> Option<u8> {
        let mut byte = [0];
        self.source.read_exact(&mut byte).ok()?;
        self.read += 1;
        Some(byte[0])
    }

    fn bytes(&mut self, count: u64) -> Option<Vec<u8>> {
        let mut bytes = Vec::new();
        self.source.by_ref().take(count).read_to_end(&mut bytes).ok()?;
        self.read += count;
        (bytes.len() as u64 == count).then_some(bytes)
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

    fn pass_over(&mut self, kind: u8, depth: u32) -> Option<()> {
        if depth > DEEPEST {
            return None;
        }
        match kind {
            TRUE | FALSE => {}
            BYTE => drop(self.byte()?),
            I16 | I32 | I64 => drop(self.varint()?),
            DOUBLE => drop(self.bytes(8)?),
            UUID => drop(self.bytes(16)?),
            BINARY => {
                let length = self.varint()?;
                let passed =
                    std::io::copy(&mut self.source.by_ref().take(length), &mut std::io::sink()).ok()?;
                self.read += passed;
                (passed == length).then_some(())?;
            }
            LIST | SET => {
                let (count, member) = self.list_head()?;
                for _ in 0..count {
                    self.pass_over_member(member, depth)?;
                }
            }
            MAP => {
                let count = self.varint()?;
                if count > 0 {
                    let kinds = self.byte()?;
                    for _ in 0..count {
                        self.pass_over_member(kinds >> 4, depth)?;
                        self.pass_over_member(kinds & 0x0f, depth)?;
                    }
                }
            }
            STRUCT => loop {
                let head = self.byte()?;
                if head == 0 {
                    break;
                }
                if head >> 4 == 0 {
                    self.int()?;
                }
                self.pass_over(head & 0x0f, depth + 1)?;
            },
            _ => return None,
        }
        Some(())
    }

    /// A member of a list or map: truth values have a byte there, in fields they have none.
    fn pass_over_member(&mut self, kind: u8, depth: u32) -> Option<()> {
        match kind {
            TRUE | FALSE => self.byte().map(drop),
            _ => self.pass_over(kind, depth + 1),
        }
    }
}
