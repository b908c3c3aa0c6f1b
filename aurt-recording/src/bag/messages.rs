use std::io::Read;
use std::path::Path;

use zstd::stream::read::Decoder;

use crate::bag::records::{Container, Ending, RECORD_LIMIT, Record, Records, Scan, ZSTD};
use crate::bag::topics::Topic;
use crate::error::RecordingError;

/// The messages of one topic, from all files of a bag in their order.
pub(super) struct Messages<'a> {
    path: &'a Path,
    name: String,
    /// For each file still to come, the next one last, its channels of the topic.
    files: Vec<(&'a dyn Container, &'a [u64])>,
    channels: &'a [u64],
    records: Option<Box<dyn Records + 'a>>,
    /// Bytes of the message that was read last.
    pub(super) payload: Vec<u8>,
    /// When it was recorded, ns.
    pub(super) log_ns: i64,
    pub(super) read: usize,
    pub(super) broken_off: bool,
}

impl<'a> Messages<'a> {
    pub(super) fn new(
        path: &'a Path,
        files: impl DoubleEndedIterator<Item = (&'a dyn Container, &'a Topic)> + Clone,
    ) -> Self {
        Self {
            path,
            name: files.clone().next().map(|(_, topic)| topic.name.clone()).unwrap_or_default(),
            files: files.rev().map(|(file, topic)| (file, topic.channels.as_slice())).collect(),
            channels: &[],
            records: None,
            payload: Vec::new(),
            log_ns: 0,
            read: 0,
            broken_off: false,
        }
    }

    /// Reads the next message; false after the last.
    pub(super) fn next(&mut self) -> Result<bool, RecordingError> {
        loop {
            let Some(records) = &mut self.records else {
                let Some((file, channels)) = self.files.pop() else { return Ok(false) };
                self.channels = channels;
                self.records = Some(file.records(Scan::Messages(channels))?);
                continue;
            };
            let mut found = false;
            let (channels, payload, log_ns) = (self.channels, &mut self.payload, &mut self.log_ns);
            let more = records.next(&mut |record| {
                if let Record::Message { channel, log_ns: logged, data } = record
                    && channels.binary_search(&channel).is_ok()
                {
                    payload.clear();
                    payload.extend_from_slice(data);
                    *log_ns = logged;
                    found = true;
                }
            });
            match more {
                Ok(_) if found => {
                    self.unpack()?;
                    self.read += 1;
                    return Ok(true);
                }
                Ok(true) => {}
                Ok(false) => self.records = None,
                Err(Ending::BreaksOff) => {
                    self.broken_off = true;
                    self.records = None;
                }
                Err(Ending::Wrong(reason)) => {
                    return Err(self.malformed(
                        reason,
                        "copy the file again, or repair it with `mcap recover` or `ros2 bag reindex`",
                    ));
                }
            }
        }
    }

    /// Unpacks a message that was compressed by itself (`compression_mode: MESSAGE`).
    fn unpack(&mut self) -> Result<(), RecordingError> {
        if !self.payload.starts_with(ZSTD) {
            return Ok(());
        }
        let packed = std::mem::take(&mut self.payload);
        let unpacked = Decoder::new(packed.as_slice())
            .and_then(|decoder| decoder.take(RECORD_LIMIT).read_to_end(&mut self.payload));
        match unpacked {
            Ok(_) => Ok(()),
            Err(error) => {
                let reason = format!("a compressed message cannot be unpacked: {error}");
                Err(self.malformed(reason, "copy the file again"))
            }
        }
    }

    pub(super) fn malformed(&self, reason: String, remedy: &str) -> RecordingError {
        RecordingError::malformed(
            self.path,
            format!("after message {} of {}", self.read, self.name),
            reason,
            remedy,
        )
    }
}
