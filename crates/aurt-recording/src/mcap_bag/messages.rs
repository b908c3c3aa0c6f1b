use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use mcap::records::Record;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{McapError, parse_record};

use crate::RecordingError;
use crate::mcap_bag::topics::Topic;

/// Bytes read at a time; a header may claim any length.
const AT_ONCE: usize = 1 << 18;
/// A longer record is an error, as is a longer stretch of compressed bytes.
const RECORD_LIMIT: usize = 1 << 30;

/// The records of a file, one after the other.
pub(super) struct Records<'a> {
    file: &'a File,
    reader: LinearReader,
}

/// Why reading ended before the file said so.
pub(super) enum Ending {
    /// The file stops in the middle.
    BreaksOff,
    /// Something in it is wrong.
    Wrong(String),
}

impl<'a> Records<'a> {
    /// All records, those in chunks among them; with `chunks_closed` those in chunks are passed over.
    pub(super) fn new(file: &'a File, chunks_closed: bool) -> Self {
        let options = LinearReaderOptions::default()
            .with_emit_chunks(chunks_closed)
            .with_validate_chunk_crcs(true)
            .with_record_length_limit(RECORD_LIMIT);
        Self { file, reader: LinearReader::new_with_options(options) }
    }

    /// Hands the next record to `take`; false at the end.
    pub(super) fn next(&mut self, take: &mut dyn FnMut(Record<'_>)) -> Result<bool, Ending> {
        loop {
            let needed = match self.reader.next_event() {
                None => return Ok(false),
                Some(Err(error)) => return Err(ending(error)),
                Some(Ok(LinearReadEvent::Record { data, opcode })) => {
                    take(parse_record(opcode, data).map_err(ending)?);
                    return Ok(true);
                }
                Some(Ok(LinearReadEvent::ReadRequest(needed))) => needed.clamp(1, AT_ONCE),
            };
            let read = loop {
                match self.file.read(self.reader.insert(needed)) {
                    Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                    Err(error) => return Err(Ending::Wrong(error.to_string())),
                    Ok(read) => break read,
                }
            };
            self.reader.notify_read(read);
        }
    }
}

fn ending(error: McapError) -> Ending {
    match error {
        McapError::UnexpectedEof => Ending::BreaksOff,
        other => Ending::Wrong(other.to_string()),
    }
}

/// The messages of one topic.
pub(super) struct Messages<'a> {
    path: &'a Path,
    topic: String,
    channels: Vec<u16>,
    records: Records<'a>,
    /// Bytes of the message that was read last.
    pub(super) payload: Vec<u8>,
    /// When it was recorded, ns.
    pub(super) log_ns: i64,
    pub(super) read: usize,
    /// Whether the file broke off.
    pub(super) broken_off: bool,
}

impl<'a> Messages<'a> {
    pub(super) fn new(path: &'a Path, file: &'a File, topic: &Topic) -> Self {
        Self {
            path,
            topic: topic.name.clone(),
            channels: topic.channels.clone(),
            records: Records::new(file, false),
            payload: Vec::new(),
            log_ns: 0,
            read: 0,
            broken_off: false,
        }
    }

    /// Reads the next message; false after the last.
    pub(super) fn next(&mut self) -> Result<bool, RecordingError> {
        loop {
            let mut found = false;
            let (channels, payload, log_ns) = (&self.channels, &mut self.payload, &mut self.log_ns);
            let more = self.records.next(&mut |record| {
                if let Record::Message { header, data } = record
                    && channels.contains(&header.channel_id)
                {
                    payload.clear();
                    payload.extend_from_slice(&data);
                    *log_ns = i64::try_from(header.log_time).unwrap_or(i64::MAX);
                    found = true;
                }
            });
            match more {
                Ok(_) if found => {
                    self.read += 1;
                    return Ok(true);
                }
                Ok(true) => {}
                Ok(false) => return Ok(false),
                Err(Ending::BreaksOff) => {
                    self.broken_off = true;
                    return Ok(false);
                }
                Err(Ending::Wrong(reason)) => {
                    return Err(self.malformed(reason, "copy the file anew, or repair it with `mcap recover`"));
                }
            }
        }
    }

    pub(super) fn malformed(&self, reason: String, remedy: &str) -> RecordingError {
        RecordingError::Malformed {
            path: self.path.to_owned(),
            place: format!("after message {} of {}", self.read, self.topic),
            reason,
            remedy: remedy.to_owned(),
        }
    }
}
