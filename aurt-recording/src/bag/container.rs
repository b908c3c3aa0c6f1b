use std::io::{Read, Seek, SeekFrom, copy};
use std::path::{Path, PathBuf};

use zstd::stream::read::Decoder;

use crate::bag::mcap::{MCAP_MAGIC, McapFile};
use crate::bag::reading::read;
use crate::bag::records::{Container, ZSTD};
use crate::bag::sqlite::{SQLITE_MAGIC, SqliteFile};
use crate::error::RecordingError;
use crate::format::{Reading, RecordingFormat, RecordingInput, unreadable};
use crate::memory::Memory;
use crate::recording::Recording;

/// Bags of ROS 2 with `sensor_msgs/msg/JointState` in CDR: MCAP, with chunks uncompressed, lz4 or zstd, and SQLite, which was
/// usual before Jazzy. Files and messages may be compressed with zstd, as rosbag2 does.
///
/// The only topic of joint states is read, or the one that is stated, or `/joint_states` if it is among several. Joints are
/// put in the robot's order by their names where [`joint_names`](crate::RecordedAs::joint_names) gives it, else they stay in
/// the order of the message. Stamps are those of the messages' headers, or of the recorder if headers have none. Messages
/// are decoded one by one, nothing is held. A file that breaks off is read up to there, and a remark says so; a database
/// whose last messages are still in a journal beside it is refused.
pub const BAG: RecordingFormat = RecordingFormat {
    name: "bag of ROS 2",
    endings: &["mcap", "db3", "zstd", "zst"],
    recognises: |beginning| [MCAP_MAGIC, SQLITE_MAGIC, ZSTD].iter().any(|mark| beginning.starts_with(mark)),
    read: |input, reading| {
        let memory = Memory::of(input.path, input.bytes, reading.options);
        read(memory, vec![container(input, memory)?], reading)
    },
};

/// A file of a bag by its first bytes.
fn container<'a>(
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
    file.seek(SeekFrom::Start(0)).map_err(spilled)?;
    RecordingInput::begun(path, file, bytes)
}

/// Where rosbag2 describes a bag.
const METADATA: &str = "metadata.yaml";
/// Its key with the files of the bag, in their order.
const FILES: &str = "relative_file_paths:";

/// The folder of a bag of rosbag2: `metadata.yaml` and one or more files in MCAP or SQLite.
#[derive(Debug)]
pub(crate) struct BagFolder {
    folder: PathBuf,
    files: Vec<PathBuf>,
}

impl BagFolder {
    /// The bag that a path names, if it names one: its folder, or the `metadata.yaml` in it.
    pub(crate) fn named(path: &Path) -> Result<Option<Self>, RecordingError> {
        let Some(file) = described(path) else { return Ok(None) };
        let folder = file.parent().unwrap_or(Path::new("")).to_owned();
        let text = aurt_files::read_text(&file, aurt_files::MOST_TEXT_BYTES)
            .map_err(|source| unreadable(&file, source))?;
        let files: Vec<PathBuf> = listed(&text).map(|name| folder.join(name)).collect();
        if files.is_empty() && path.is_dir() {
            // A recorder that was killed lists nothing; the refusal of the folder names the files in it.
            return Ok(None);
        }
        if files.is_empty() {
            return Err(RecordingError::malformed(
                &file,
                FILES,
                "it lists no files of a bag",
                "write it again with `ros2 bag reindex`, or name a file of the folder",
            ));
        }
        Ok(Some(Self { folder, files }))
    }

    /// Reads the joint states of all files, one after another.
    pub(crate) fn read(&self, reading: Reading<'_>) -> Result<Recording, RecordingError> {
        let files = self.files.iter().map(|file| RecordingInput::open(file));
        let files = files.collect::<Result<Vec<_>, _>>()?;
        let memory = Memory::of(&self.folder, files.iter().map(|file| file.bytes).sum(), reading.options);
        let files = files.into_iter().map(|file| container(file, memory)).collect::<Result<_, _>>()?;
        read(memory, files, reading)
    }
}

/// The description of the bag that a path names: in the folder, or the path itself.
pub(crate) fn described(path: &Path) -> Option<PathBuf> {
    let file = if path.ends_with(METADATA) { path.to_owned() } else { path.join(METADATA) };
    file.is_file().then_some(file)
}

/// The file names in the list of a `metadata.yaml`; older versions put the folder before them.
fn listed(text: &str) -> impl Iterator<Item = &str> {
    let lines = text.lines().map(str::trim).skip_while(|line| *line != FILES).skip(1);
    let items = lines.map_while(|line| line.strip_prefix("- "));
    items.filter_map(|item| Path::new(item.trim_matches(['"', '\'', ' '])).file_name()?.to_str())
}
