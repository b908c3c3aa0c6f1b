//! Bodies of messages in CDR, as ROS 2 serialises them.
//!
//! Source: OMG, "DDS Interoperability Wire Protocol" 2.5, section 10.

/// Joints of a message that are read, and bytes of the name of each: a machine has some dozens.
pub(super) const MOST_OF_MESSAGE: usize = 1000;
const MOST_NAME_BYTES: usize = 512;

pub(super) const BREAKS_OFF: &str = "it is truncated";
pub(super) const TOO_MANY: &str = "it has more than 1000 joints, or a name of more than 512 bytes";

/// The rest of a message, still to be decoded.
#[derive(Debug, Clone, Copy)]
pub(super) struct CdrBody<'a> {
    bytes: &'a [u8],
    pub(super) at: usize,
    big_endian: bool,
}

impl<'a> CdrBody<'a> {
    pub(super) fn of(message: &'a [u8]) -> Result<Self, &'static str> {
        let (encapsulation, bytes) = message.split_at_checked(4).ok_or(BREAKS_OFF)?;
        let big_endian = match encapsulation {
            [0, 0, ..] => true,
            [0, 1, ..] => false,
            _ => return Err("it is not in the encoding CDR of ROS 2"),
        };
        Ok(Self { bytes, at: 0, big_endian })
    }

    pub(super) const fn from(self, at: usize) -> Self {
        Self { at, ..self }
    }

    pub(super) fn time_ns(&mut self) -> Option<i64> {
        let seconds = i64::from(self.word()? as i32);
        Some(seconds * 1_000_000_000 + i64::from(self.word()?))
    }

    /// Passes over a sequence of names, and returns where the first begins and how many there are.
    pub(super) fn names(&mut self) -> Result<(usize, usize), &'static str> {
        let count = self.word().ok_or(BREAKS_OFF)? as usize;
        let start = self.at;
        for place in 0..count {
            if place == MOST_OF_MESSAGE || self.text().ok_or(BREAKS_OFF)?.len() > MOST_NAME_BYTES {
                return Err(TOO_MANY);
            }
        }
        Ok((start, count))
    }

    /// The bytes from a place up to what comes next.
    pub(super) fn since(&self, start: usize) -> &'a [u8] {
        self.bytes.get(start..self.at).unwrap_or_default()
    }

    fn align(&mut self, to: usize) {
        self.at = self.at.next_multiple_of(to);
    }

    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let end = self.at.checked_add(count)?;
        let bytes = self.bytes.get(self.at..end)?;
        self.at = end;
        Some(bytes)
    }

    /// An integer of 32 bits.
    pub(super) fn word(&mut self) -> Option<u32> {
        self.align(4);
        let bytes = self.take(4)?.try_into().ok()?;
        Some(if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) })
    }

    /// A text, without the zero that ends it.
    pub(super) fn text(&mut self) -> Option<&'a [u8]> {
        let length = self.word()? as usize;
        let bytes = self.take(length)?;
        Some(bytes.strip_suffix(&[0]).unwrap_or(bytes))
    }

    pub(super) fn numbers(&mut self, values: &mut Vec<f64>) -> Option<()> {
        let count = self.word()? as usize;
        values.clear();
        if count == 0 {
            return Some(());
        }
        self.align(8);
        let bytes = self.take(count.checked_mul(8)?)?;
        let value = |b: &[u8]| -> f64 {
            let b: [u8; 8] = b.try_into().unwrap_or_default();
            if self.big_endian { f64::from_be_bytes(b) } else { f64::from_le_bytes(b) }
        };
        values.extend(bytes.chunks_exact(8).map(value));
        Some(())
    }
}
