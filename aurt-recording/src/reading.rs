//! Reading recordings: whole, in pieces, and as they come.

use std::fs::File;
use std::path::Path;

use crate::error::RecordingError;
use crate::format::{Reading, RecordingInput, Visit};
use crate::formats::{format_of, read_in_pieces, read_whole};
use crate::joined;
use crate::read_options::ReadOptions;
use crate::recording::{ReadReport, Recording};

/// Reads a recording from a file of any of the [`FORMATS`](crate::FORMATS), or from the folder (or the `meta/info.json`) of a LeRobot data
/// set, together with those that
/// [belong to it](crate::RecordedAs::joined): rows of the common time span, joined by their stamps.
///
/// # Errors
/// A file that cannot be read, and what its format reports (for text: [`CSV`](crate::CSV)). Each error names the file, the place and
/// what to do.
pub fn read_recording(path: &Path, options: &ReadOptions) -> Result<Recording, RecordingError> {
    if !options.recorded.joined.is_empty() {
        return joined::read(path, options);
    }
    read_whole(path, options)
}

/// Reads rows as they come, from a pipe or from a file that grows, in pieces of `piece_rows` rows; `name` is what
/// messages call it. Returns the report on all of them once the input ends.
///
/// # Errors
/// As [`read_recording`], and what `visit` returns.
pub fn read_running(
    file: File,
    name: &Path,
    options: &ReadOptions,
    piece_rows: usize,
    visit: &mut dyn FnMut(&Recording) -> Result<(), RecordingError>,
) -> Result<ReadReport, RecordingError> {
    options.validate()?;
    let options = &ReadOptions { is_running: true, ..options.clone() };
    let input = RecordingInput::begun(name, file, 0)?;
    let last = (format_of(&input).read)(input, Reading { options, piece_rows, visit: &mut *visit })?;
    visit(&last)?;
    Ok(of_pieces(last.report, options))
}

/// The report on a recording that was handed over in pieces: of the motion beside the chain what measurements contain.
fn of_pieces(report: ReadReport, options: &ReadOptions) -> ReadReport {
    let branches = options.joints.as_ref().map_or_else(Vec::new, |robot| robot.moving(&report.branches, &[]));
    ReadReport { branches, ..report }
}

/// Rows of a piece of a recording that is read piece by piece.
const PIECE_ROWS: usize = 1 << 16;

/// Reads a recording as [`read_recording`] does and hands it over in consecutive pieces.
pub(crate) fn read_pieces(
    path: &Path,
    options: &ReadOptions,
    visit: Visit<'_>,
) -> Result<ReadReport, RecordingError> {
    if let Some(other) = options.recorded.joined.first() {
        return Err(RecordingError::Joined {
            path: path.to_owned(),
            other: other.file.clone(),
            reason: "files are joined as a whole, and the recordings are too large for that".into(),
            remedy: "read them whole with a higher --stream-above, or join them into one file first".into(),
        });
    }
    let last = read_in_pieces(path, Reading { options, piece_rows: PIECE_ROWS, visit: &mut *visit })?;
    visit(&last)?;
    Ok(of_pieces(last.report, options))
}

impl Recording {
    /// Reads a recording whose columns have their usual names.
    ///
    /// # Errors
    /// As [`read_recording`](crate::read_recording).
    pub fn read(path: impl AsRef<Path>) -> Result<Self, RecordingError> {
        read_recording(path.as_ref(), &ReadOptions::default())
    }
}
