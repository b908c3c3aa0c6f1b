use std::fs::File;
use std::path::Path;

use crate::error::RecordingError;
use crate::mcap_bag::records::{Ending, Record, Records};
use crate::mcap_bag::topics::Topic;

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
                if let Record::Message { channel, log_ns: logged, data } = record
                    && channels.contains(&channel)
                {
                    payload.clear();
                    payload.extend_from_slice(data);
                    *log_ns = i64::try_from(logged).unwrap_or(i64::MAX);
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
                    return Err(
                        self.malformed(reason, "copy the file anew, or repair it with `mcap recover`")
                    );
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
