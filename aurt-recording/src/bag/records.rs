//! What the containers of bags have in common: topics and messages as records, one after the other.

use std::io;
use std::path::Path;

use crate::error::RecordingError;

/// First bytes of what zstd compressed; those of a message in CDR are 0.
pub(super) const ZSTD: &[u8] = &[0x28, 0xb5, 0x2f, 0xfd];

/// Largest record, chunk or message, in bytes: one is held in memory.
pub(super) const RECORD_LIMIT: u64 = 1 << 28;

/// Bytes of the name of a topic, a type or an encoding that are kept; ROS allows 255.
const MOST_NAME_BYTES: usize = 512;

pub(super) fn name_of(bytes: &[u8]) -> String {
    String::from_utf8_lossy(&bytes[..bytes.len().min(MOST_NAME_BYTES)]).into_owned()
}

pub(super) trait Container {
    fn kind(&self) -> &'static str;

    fn path(&self) -> &Path;

    /// Its records from the first on.
    ///
    /// # Errors
    /// A file that cannot be read from its beginning.
    fn records<'a>(&'a self, scan: Scan<'a>) -> Result<Box<dyn Records + 'a>, RecordingError>;
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Scan<'a> {
    /// Topics, as far as they are listed apart from messages.
    Summary,
    /// Topics, wherever they are described.
    Topics,
    Messages(&'a [u64]),
}

pub(super) trait Records {
    /// Hands the next record to `take`; false at the end.
    fn next(&mut self, take: &mut dyn FnMut(Record<'_>)) -> Result<bool, Ending>;
}

/// A record, as far as its kind is of interest here.
#[derive(Debug)]
pub(super) enum Record<'a> {
    Schema { id: u64, name: String },
    Channel { id: u64, schema: u64, topic: String, encoding: String },
    Message { channel: u64, log_ns: i64, data: &'a [u8] },
    Other,
}

/// Why reading ended before the file said so.
#[derive(Debug)]
pub(super) enum Ending {
    BreaksOff,
    Wrong(String),
}

impl From<io::Error> for Ending {
    fn from(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::UnexpectedEof {
            Self::BreaksOff
        } else {
            Self::Wrong(error.to_string())
        }
    }
}
