use std::path::{Path, PathBuf};

use crate::bag::container::container;
use crate::bag::reading::read;
use crate::error::RecordingError;
use crate::format::{RecordingInput, Visit, unreadable};
use crate::memory::Memory;
use crate::read_options::ReadOptions;
use crate::recording::Recording;

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
    ///
    /// # Errors
    /// A description that cannot be read or names no files.
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
    pub(crate) fn read(
        &self,
        options: &ReadOptions,
        piece_rows: usize,
        visit: Visit<'_>,
    ) -> Result<Recording, RecordingError> {
        let files = self.files.iter().map(|file| RecordingInput::open(file));
        let files = files.collect::<Result<Vec<_>, _>>()?;
        let memory = Memory::of(&self.folder, files.iter().map(|file| file.bytes).sum(), options);
        let files = files.into_iter().map(|file| container(file, memory)).collect::<Result<_, _>>()?;
        read(memory, files, options, piece_rows, visit)
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
