//! MCAP files of ROS 2: what Foxglove, rerun and PlotJuggler open.

use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;

use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions, Writer};

use crate::error::RecordingError;

/// Definitions that the messages share, in the form of `ros2msg` schemas.
pub(super) const STAMP_SCHEMAS: &str = "\
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

/// A file that is being written; `path` is what errors name.
pub(super) struct McapWriter<'a> {
    path: &'a Path,
    file: Writer<Cursor<Vec<u8>>>,
}

impl<'a> McapWriter<'a> {
    /// Begins a file of the profile `ros2`.
    pub(super) fn new(path: &'a Path) -> Result<Self, RecordingError> {
        let options =
            WriteOptions::new().profile("ros2").library(concat!("aurt ", env!("CARGO_PKG_VERSION")));
        let file = options.compression(None).create(Cursor::new(Vec::new()));
        Ok(Self { path, file: file.map_err(|error| failed(path, &error))? })
    }

    /// Adds a type of messages, whose definition is the text of its `.msg` files.
    pub(super) fn schema(&mut self, name: &str, definition: &str) -> Result<u16, RecordingError> {
        let schema = self.file.add_schema(name, "ros2msg", definition.as_bytes());
        schema.map_err(|error| failed(self.path, &error))
    }

    /// Adds a topic of messages in CDR.
    pub(super) fn topic(
        &mut self,
        schema: u16,
        name: &str,
        facts: &BTreeMap<String, String>,
    ) -> Result<u16, RecordingError> {
        self.file.add_channel(schema, name, "cdr", facts).map_err(|error| failed(self.path, &error))
    }

    pub(super) fn message(
        &mut self,
        channel_id: u16,
        sequence: u32,
        time_ns: u64,
        message: &[u8],
    ) -> Result<(), RecordingError> {
        let header = MessageHeader { channel_id, sequence, log_time: time_ns, publish_time: time_ns };
        self.file.write_to_known_channel(&header, message).map_err(|error| failed(self.path, &error))
    }

    pub(super) fn finish(mut self) -> Result<Vec<u8>, RecordingError> {
        self.file.finish().map_err(|error| failed(self.path, &error))?;
        Ok(self.file.into_inner().into_inner())
    }
}

fn failed(path: &Path, error: &McapError) -> RecordingError {
    RecordingError::malformed(path, "its messages", error.to_string(), "write Parquet or CSV")
}
