//! The formats that recordings are read from: one a file, and a line in [`FORMATS`].

use std::{
    fmt::Debug,
    fs::File,
    io::{Cursor, Read, Seek},
    path::Path,
};

use crate::{
    ReadOptions, ReadReport, Recording, RecordingError, csv::Csv, foreign, joined, lerobot::DataSet,
    matlab::Matlab, mcap_bag::McapBag, numpy::NumPy, parquet::Parquet,
};

/// Every format, in the order in which their claims to a file are heard.
pub const FORMATS: &[&dyn RecordingFormat] = &[&NumPy, &Matlab, &McapBag, &Parquet, &Csv];

/// Bytes of a file that are looked at to find out what it is.
pub(crate) const BEGINNING_BYTES: usize = 1 << 16;

/// A format that recordings are read from.
///
/// A file belongs to the first format that [recognises](Self::recognises) its beginning, else to the first that has the
/// [ending](Self::endings) of its name, else it is read as text ([`Csv`]).
pub trait RecordingFormat: Debug + Send + Sync {
    /// The format's name, as reports write it.
    fn name(&self) -> &'static str;

    /// Endings of file names, lower case and without the dot.
    fn endings(&self) -> &'static [&'static str];

    /// Whether the first 64 KiB of a file (fewer, if it is shorter) can only be this format's.
    fn recognises(&self, beginning: &[u8]) -> bool;

    /// Reads a recording. Pieces of `piece_rows` rows go to `visit` as soon as they are complete, each a recording by
    /// itself; the last, with the report on all of them, is returned.
    ///
    /// # Errors
    /// What is wrong with the file, with its place and what to do; whatever `visit` returns.
    fn read(
        &self,
        input: RecordingInput<'_>,
        options: &ReadOptions,
        piece_rows: usize,
        visit: &mut dyn FnMut(&Recording) -> Result<(), RecordingError>,
    ) -> Result<Recording, RecordingError>;
}

/// An open file whose beginning has been read.
#[derive(Debug)]
pub struct RecordingInput<'a> {
    /// Its path.
    pub path: &'a Path,
    /// Its first bytes.
    pub beginning: Vec<u8>,
    /// Its length in bytes; 0 for a pipe.
    pub bytes: u64,
    /// The file, after the beginning. Formats that read from several places seek in it.
    pub file: File,
}

/// Endings of files that are recordings.
const ENDINGS: [&str; 8] = ["mcap", "db3", "parquet", "npz", "npy", "mat", "csv", "tsv"];

/// The files of a folder that look like recordings, by their names; those of a bag first, which say what they are.
fn recordings_in(folder: &Path) -> Vec<String> {
    let rank = |name: &str| {
        let ending = Path::new(name).extension()?.to_str()?.to_ascii_lowercase();
        ENDINGS.iter().position(|known| *known == ending)
    };
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter(|e| e.path().is_file()).filter_map(|e| e.file_name().into_string().ok());
    let mut found: Vec<(usize, String)> = names.filter_map(|n| Some((rank(&n)?, n))).collect();
    found.sort();
    found.into_iter().map(|(_, name)| name).collect()
}

impl<'a> RecordingInput<'a> {
    pub(crate) fn open(path: &'a Path) -> Result<Self, RecordingError> {
        if path.is_dir() {
            return Err(RecordingError::Directory { path: path.to_owned(), inside: recordings_in(path) });
        }
        let unreadable = |source| unreadable(path, source);
        let mut file = aurt_files::open(path).map_err(unreadable)?;
        let bytes = file.metadata().map_or(0, |m| m.len());
        let mut beginning = Vec::new();
        file.by_ref().take(BEGINNING_BYTES as u64).read_to_end(&mut beginning).map_err(unreadable)?;
        Ok(Self { path, beginning, bytes, file })
    }

    /// The file itself, at its first byte, for formats that read from several places.
    ///
    /// # Errors
    /// A file that cannot be read again from its beginning, as a pipe.
    pub(crate) fn rewound(&self) -> Result<&File, RecordingError> {
        let mut file = &self.file;
        file.rewind().map_err(|source| unreadable(self.path, source))?;
        Ok(file)
    }

    /// All of it, from the first byte on.
    pub fn reader(&self) -> impl Read {
        Cursor::new(self.beginning.as_slice()).chain(&self.file)
    }

    fn format(&self) -> &'static dyn RecordingFormat {
        let ending = self.path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let by_content = FORMATS.iter().find(|format| format.recognises(&self.beginning));
        let by_name = || FORMATS.iter().find(|f| ending.as_deref().is_some_and(|e| f.endings().contains(&e)));
        *by_content.or_else(by_name).unwrap_or(&(&Csv as &dyn RecordingFormat))
    }
}

/// Reads a recording from a file of any of the [`FORMATS`], or from the folder (or the `meta/info.json`) of a LeRobot data
/// set, together with those that
/// [belong to it](crate::RecordedAs::joined): rows of the common time span, joined by their stamps.
///
/// # Errors
/// A file that cannot be read, and what its format reports (for text: [`Csv`]). Each error names the file, the place and
/// what to do.
pub fn read_recording(path: &Path, options: &ReadOptions) -> Result<Recording, RecordingError> {
    if !options.recorded.joined.is_empty() {
        return joined::read(path, options);
    }
    read_in_pieces(path, options, usize::MAX, &mut |_| Ok(()))
}

/// Reads rows as they come, from a pipe or from a file that grows, in pieces of `piece_rows` rows; `name` is what
/// messages call it. Returns the report on all of them once the input ends.
///
/// # Errors
/// As [`read_recording`], and what `visit` returns.
pub fn read_running(
    mut file: File,
    name: &Path,
    options: &ReadOptions,
    piece_rows: usize,
    visit: &mut dyn FnMut(&Recording) -> Result<(), RecordingError>,
) -> Result<ReadReport, RecordingError> {
    options.validate()?;
    let mut beginning = Vec::new();
    let read = file.by_ref().take(BEGINNING_BYTES as u64).read_to_end(&mut beginning);
    read.map_err(|source| unreadable(name, source))?;
    let options = ReadOptions { is_running: true, ..options.clone() };
    let input = RecordingInput { path: name, beginning, bytes: 0, file };
    let last = input.format().read(input, &options, piece_rows, visit)?;
    visit(&last)?;
    Ok(last.report)
}

/// Rows of a piece of a recording that is read piece by piece.
const PIECE_ROWS: usize = 1 << 16;

/// Reads a recording as [`read_recording`] does and hands it over in consecutive pieces.
///
/// # Errors
/// As [`read_recording`], and what `visit` returns.
pub(crate) fn read_pieces(
    path: &Path,
    options: &ReadOptions,
    visit: &mut dyn FnMut(&Recording) -> Result<(), RecordingError>,
) -> Result<ReadReport, RecordingError> {
    if let Some(other) = options.recorded.joined.first() {
        return Err(RecordingError::Joined {
            path: path.to_owned(),
            other: other.file.clone(),
            reason: "files are joined as a whole, and the recordings are too large for that".into(),
            remedy: "read them whole with a higher --stream-above, or join them into one file first".into(),
        });
    }
    let last = read_in_pieces(path, options, PIECE_ROWS, visit)?;
    visit(&last)?;
    Ok(last.report)
}

/// Reads one file or data set; pieces of `piece_rows` rows go to `visit`, the last is returned.
pub(crate) fn read_in_pieces(
    path: &Path,
    options: &ReadOptions,
    piece_rows: usize,
    visit: &mut dyn FnMut(&Recording) -> Result<(), RecordingError>,
) -> Result<Recording, RecordingError> {
    options.validate()?;
    if let Some(data_set) = DataSet::named(path)? {
        return data_set.read(options, piece_rows, visit);
    }
    let input = RecordingInput::open(path)?;
    foreign::refuse(path, &input.beginning)?;
    input.format().read(input, options, piece_rows, visit)
}

/// Why a file cannot be read, with what to do.
pub(crate) fn unreadable(path: &Path, source: std::io::Error) -> RecordingError {
    let remedy = match source.kind() {
        std::io::ErrorKind::NotFound => "no such file; check the path",
        std::io::ErrorKind::PermissionDenied => "reading it is not permitted; check the file's permissions",
        std::io::ErrorKind::InvalidInput => {
            "it is a device or a socket; save the recording to a file and name that"
        }
        std::io::ErrorKind::TimedOut => {
            "it is a pipe that nobody writes to within 5 s; start its writer first"
        }
        std::io::ErrorKind::InvalidData => {
            "it has a line of more than 16 MB, so it is no table; recordings have one row per sample and line"
        }
        _ => "it cannot be read",
    };
    RecordingError::Unreadable { path: path.to_owned(), remedy, source }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_endings_are_told_apart() {
        let mut endings: Vec<&str> = FORMATS.iter().flat_map(|f| f.endings().iter().copied()).collect();
        let count = endings.len();
        endings.sort_unstable();
        endings.dedup();
        assert_eq!(endings.len(), count, "two formats have one ending");
        assert!(endings.iter().all(|e| e.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())));
    }

    #[test]
    fn a_file_without_mark_or_known_ending_is_text() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.csv", "a.CSV", "a", "a.unknown"] {
            let path = folder.path().join(name);
            std::fs::write(&path, "time,q_0\n0,1\n").unwrap();
            let input = RecordingInput::open(&path).unwrap();
            assert_eq!(input.format().name(), "CSV");
            let mut text = String::new();
            input.reader().read_to_string(&mut text).unwrap();
            assert_eq!(text, "time,q_0\n0,1\n");
        }
    }
}
