use std::io::{Read, Seek, SeekFrom, copy};

use zstd::stream::read::Decoder;

use crate::bag::mcap::{MCAP_MAGIC, McapFile};
use crate::bag::reading::read;
use crate::bag::records::{Container, ZSTD};
use crate::bag::sqlite::{SQLITE_MAGIC, SqliteFile};
use crate::error::RecordingError;
use crate::format::{BEGINNING_BYTES, RecordingFormat, RecordingInput, Visit, unreadable};
use crate::memory::Memory;
use crate::read_options::ReadOptions;
use crate::recording::Recording;

/// Bags of ROS 2 with `sensor_msgs/msg/JointState` in CDR: MCAP, with chunks uncompressed, lz4 or zstd, and SQLite, which was
/// usual before Jazzy. Files and messages may be compressed with zstd, as rosbag2 does.
///
/// The only topic of joint states is read, or the one that is stated, or `/joint_states` if it is among several. Joints are
/// put in the robot's order by their names where [`joint_names`](crate::RecordedAs::joint_names) gives it, else they stay in
/// the order of the message. Stamps are those of the messages' headers, or of the recorder if headers have none. Messages
/// are decoded one by one, nothing is held. A file that breaks off is read up to there, and a remark says so; a database
/// whose last messages are still in a journal beside it is refused.
#[derive(Debug, Clone, Copy)]
pub struct Bag;

impl RecordingFormat for Bag {
    fn name(&self) -> &'static str {
        "bag of ROS 2"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["mcap", "db3", "zstd", "zst"]
    }

    fn recognises(&self, beginning: &[u8]) -> bool {
        [MCAP_MAGIC, SQLITE_MAGIC, ZSTD].iter().any(|mark| beginning.starts_with(mark))
    }

    fn read(
        &self,
        input: RecordingInput<'_>,
        options: &ReadOptions,
        piece_rows: usize,
        visit: Visit<'_>,
    ) -> Result<Recording, RecordingError> {
        let memory = Memory::of(input.path, input.bytes, options);
        read(memory, vec![container(input, memory)?], options, piece_rows, visit)
    }
}

/// A file of a bag by its first bytes.
///
/// # Errors
/// A file that is neither MCAP nor SQLite, and one that unpacks to more than the allowed memory.
pub(super) fn container<'a>(
    input: RecordingInput<'a>,
    memory: Memory<'a>,
) -> Result<Box<dyn Container + 'a>, RecordingError> {
    let is_named = !input.beginning.starts_with(ZSTD);
    let input = if is_named { input } else { unpacked(&input, memory)? };
    if input.beginning.starts_with(MCAP_MAGIC) {
        return Ok(Box::new(McapFile { input, memory }));
    }
    if input.beginning.starts_with(SQLITE_MAGIC) {
        return Ok(Box::new(SqliteFile::new(&input, is_named)?));
    }
    Err(RecordingError::malformed(
        input.path,
        "its first bytes",
        "it is neither MCAP nor SQLite, which rosbag2 writes",
        "convert a bag with `ros2 bag convert` (storage_id: mcap); unpack other files with `zstd -d`",
    ))
}

/// The file as it was before it was compressed, in a temporary one.
fn unpacked<'a>(
    input: &RecordingInput<'a>,
    memory: Memory<'_>,
) -> Result<RecordingInput<'a>, RecordingError> {
    let path = input.path;
    let damaged = |reason: String| {
        RecordingError::malformed(
            path,
            "its zstd frame",
            format!("it cannot be unpacked: {reason}"),
            "copy the file again",
        )
    };
    let spilled = |source| RecordingError::Spill { path: path.to_owned(), source };
    let decoder = Decoder::new(input.rewound()?).map_err(|error| damaged(error.to_string()))?;
    let mut file = tempfile::tempfile().map_err(spilled)?;
    let bytes = copy(&mut decoder.take(memory.allowed_bytes().saturating_add(1)), &mut file)
        .map_err(|error| damaged(error.to_string()))?;
    memory.claim("the unpacked file", bytes)?;
    let mut beginning = Vec::new();
    file.seek(SeekFrom::Start(0)).map_err(spilled)?;
    file.by_ref()
        .take(BEGINNING_BYTES as u64)
        .read_to_end(&mut beginning)
        .map_err(|e| unreadable(path, e))?;
    Ok(RecordingInput { path, beginning, bytes, file })
}
