//! What a format of recordings is, and the file that it reads.

use std::fs::File;
use std::io::{Cursor, Read, Seek};
use std::path::Path;

use crate::error::RecordingError;
use crate::read_options::ReadOptions;
use crate::recording::Recording;

/// Gets the recording piece by piece.
pub(crate) type Visit<'a> = &'a mut dyn FnMut(&Recording) -> Result<(), RecordingError>;

/// Bytes of a file that are looked at to find out what it is.
pub(crate) const BEGINNING_BYTES: usize = 1 << 16;

/// What is read of a recording, and where it goes: pieces of `piece_rows` rows to `visit` as soon as they are complete, each a
/// recording by itself; the last, with the report on all of them, is what reading returns.
pub(crate) struct Reading<'a> {
    pub options: &'a ReadOptions,
    pub piece_rows: usize,
    pub visit: Visit<'a>,
}

/// A format that recordings are read from.
///
/// A file belongs to the first format that recognises its beginning, else to the first that has the ending of its name, else
/// it is read as text ([`CSV`](crate::CSV)).
#[derive(Debug)]
pub struct RecordingFormat {
    /// The format's name, as reports write it.
    pub name: &'static str,
    /// Endings of file names, lower case and without the dot.
    pub endings: &'static [&'static str],
    /// Whether the first 64 KiB of a file (fewer, if it is shorter) can only be this format's.
    pub(crate) recognises: fn(&[u8]) -> bool,
    pub(crate) read: fn(RecordingInput<'_>, Reading<'_>) -> Result<Recording, RecordingError>,
}

/// An open file whose beginning has been read.
#[derive(Debug)]
pub(crate) struct RecordingInput<'a> {
    pub path: &'a Path,
    /// Its first bytes.
    pub beginning: Vec<u8>,
    /// Its length in bytes; 0 for a pipe.
    pub bytes: u64,
    /// The file, after the beginning. Formats that read from several places seek in it.
    pub file: File,
}

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
        let file = aurt_files::open(path).map_err(|source| unreadable(path, source))?;
        let bytes = file.metadata().map_or(0, |m| m.len());
        Self::begun(path, file, bytes)
    }

    /// A file of so many bytes that is called `path`, from where it stands on.
    pub(crate) fn begun(path: &'a Path, mut file: File, bytes: u64) -> Result<Self, RecordingError> {
        let mut beginning = Vec::new();
        let read = file.by_ref().take(BEGINNING_BYTES as u64).read_to_end(&mut beginning);
        read.map_err(|source| unreadable(path, source))?;
        Ok(Self { path, beginning, bytes, file })
    }

    /// The file itself, at its first byte, for formats that read from several places.
    pub(crate) fn rewound(&self) -> Result<&File, RecordingError> {
        let mut file = &self.file;
        file.rewind().map_err(|source| unreadable(self.path, source))?;
        Ok(file)
    }

    /// All of it, from the first byte on.
    pub(crate) fn reader(&self) -> impl Read {
        Cursor::new(self.beginning.as_slice()).chain(&self.file)
    }
}

/// Why a file cannot be read, with what to do.
pub(crate) fn unreadable(path: &Path, source: std::io::Error) -> RecordingError {
    let remedy = match source.kind() {
        std::io::ErrorKind::NotFound => "no such file; check the path",
        std::io::ErrorKind::PermissionDenied => "reading it is not permitted; check the file's permissions",
        std::io::ErrorKind::InvalidInput => {
            "it is not a regular file (a device, a socket or a file of the kernel); save the recording to a file and name that"
        }
        std::io::ErrorKind::NotSeekable => {
            "it is a pipe, which can be read once only; save its contents to a file and name that"
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

/// Formats that are known but not read: their first bytes, their name, and how to get from them to one that is.
const FOREIGN: &[(&[u8], &str, &str)] = &[
    #[cfg(not(feature = "mcap"))]
    (b"\x89MCAP0", "MCAP", "build aurt-recording with its feature `mcap`"),
    #[cfg(not(feature = "mcap"))]
    (b"SQLite format 3\0", "SQLite", "build aurt-recording with its feature `mcap`, if it is a bag of ROS 2"),
    #[cfg(not(feature = "parquet"))]
    (b"PAR1", "Parquet", "build aurt-recording with its feature `parquet`"),
    #[cfg(not(feature = "numpy"))]
    (b"\x93NUMPY", "an array of NumPy", "build aurt-recording with its feature `numpy`"),
    #[cfg(not(feature = "matlab"))]
    (b"MATLAB 5.0", "a MAT-file", "build aurt-recording with its feature `matlab`"),
    (
        b"#ROSBAG V2.0",
        "a bag of ROS 1",
        "convert it to MCAP: `rosbags-convert --src FILE.bag --dst NEW --dst-storage mcap` (pip install rosbags)",
    ),
    (
        b"ARROW1\0\0",
        "an Arrow file (Feather)",
        "write it as Parquet: pandas.read_feather(\"log.arrow\").to_parquet(\"log.parquet\")",
    ),
    (
        b"\x89HDF\r\n\x1a\n",
        "an HDF5 file",
        "write its arrays to .npz: numpy.savez(\"log.npz\", time=…, q=…, current=…), or save from MATLAB with \"-v7\"",
    ),
    (b"PK\x03\x04\x14\0\x06\0", "an Excel workbook", "save it as CSV"),
    (
        b"version https://git-lfs",
        "a Git LFS pointer instead of the file",
        "fetch the file itself: `git lfs pull` in its repository",
    ),
];

/// Refuses a file that is known to be of a format that is not read.
pub(crate) fn refuse_foreign(path: &Path, beginning: &[u8]) -> Result<(), RecordingError> {
    match FOREIGN.iter().find(|(mark, ..)| beginning.starts_with(mark)) {
        None => Ok(()),
        Some((_, name, remedy)) => Err(RecordingError::malformed(
            path,
            "its first bytes",
            format!("it is {name}, which is not supported"),
            *remedy,
        )),
    }
}
