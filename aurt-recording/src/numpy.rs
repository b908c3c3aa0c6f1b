//! Arrays as NumPy saves them: `.npy`, and `.npz` with one array per quantity.
//!
//! Source: numpy.lib.format, "Format Version 1.0", "2.0" and "3.0".

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;

use zip::ZipArchive;

use crate::arrays::{Array, ArrayFile, Kind, Numbers};
use crate::error::RecordingError;
use crate::format::Visit;
use crate::format::{RecordingFormat, RecordingInput};
use crate::memory::Memory;
use crate::read_options::ReadOptions;
use crate::recording::Recording;

const MAGIC: &[u8] = b"\x93NUMPY";

const HEADER_LIMIT: usize = 1 << 16;

/// Arrays saved by NumPy: `np.savez("log.npz", time=t, q=q, current=i)`, compressed or not, and single arrays (`.npy`),
/// whose columns have to be selected.
///
/// Arrays have one row per sample, or one column; 4- and 8-byte floats, integers and booleans of either byte order are
/// read, 1-D for single columns. Names are those of text columns: `q` of shape (n, 6) is `q_0` … `q_5`. Arrays that
/// hold other things are skipped. Arrays that are needed are held in memory, others are not unpacked.
#[derive(Debug, Clone, Copy)]
pub struct NumPy;

struct Header {
    numbers: Numbers,
    column_major: bool,
    shape: Vec<usize>,
}

impl RecordingFormat for NumPy {
    fn name(&self) -> &'static str {
        "NumPy"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["npy", "npz"]
    }

    fn recognises(&self, beginning: &[u8]) -> bool {
        beginning.starts_with(MAGIC) || is_archive_of_arrays(beginning)
    }

    fn read(
        &self,
        input: RecordingInput<'_>,
        options: &ReadOptions,
        piece_rows: usize,
        visit: Visit<'_>,
    ) -> Result<Recording, RecordingError> {
        let path = input.path;
        let memory = Memory::of(path, input.bytes, options);
        if input.beginning.starts_with(MAGIC) {
            let mut source = BufReader::new(input.rewound()?);
            let header = Header::read(&mut source).map_err(|p| malformed(path, "its header", &p))?;
            let array = header.array(None);
            let count = array.shape.iter().product();
            let file = ArrayFile { memory, format: "NumPy array", options, arrays: vec![array] };
            return file.read(piece_rows, visit, &mut |_| {
                let values = header.numbers.read(&mut source, count);
                Ok(HashMap::from([(0, values.map_err(|e| malformed(path, "the array", &Problem::from(e)))?)]))
            });
        }
        let mut archive = ZipArchive::new(BufReader::new(input.rewound()?))
            .map_err(|e| malformed(path, "the archive", &Problem::Archive(e.to_string())))?;
        let (mut arrays, mut entries) = (Vec::new(), Vec::new());
        for entry in 0..archive.len() {
            let (name, header) = open(&mut archive, entry, path)?;
            // Texts and objects are no reason to refuse what stands beside them.
            if let Ok(header) = header {
                arrays.push(header.array(Some(name)));
                entries.push(entry);
            }
        }
        let found: Vec<usize> = arrays.iter().map(|a| a.shape.iter().product()).collect();
        let file = ArrayFile { memory, format: "NumPy archive", options, arrays };
        file.read(piece_rows, visit, &mut |needed| {
            let mut loaded = HashMap::new();
            for place in needed {
                let mut source = archive
                    .by_index(entries[*place])
                    .map_err(|e| malformed(path, "the archive", &Problem::Archive(e.to_string())))?;
                let name = format!("array `{}`", name_of(source.name_raw()));
                let values = Header::read(&mut source)
                    .and_then(|header| Ok(header.numbers.read(&mut source, found[*place])?));
                loaded.insert(*place, values.map_err(|p| malformed(path, &name, &p))?);
            }
            Ok(loaded)
        })
    }
}

/// The name of an entry and the header of its array.
fn open(
    archive: &mut ZipArchive<BufReader<&File>>,
    entry: usize,
    path: &Path,
) -> Result<(String, Result<Header, Problem>), RecordingError> {
    let mut source = archive
        .by_index(entry)
        .map_err(|e| malformed(path, "the archive", &Problem::Archive(e.to_string())))?;
    let name = name_of(source.name_raw());
    Ok((name, Header::read(&mut source)))
}

fn name_of(entry: &[u8]) -> String {
    String::from_utf8_lossy(entry.strip_suffix(b".npy").unwrap_or(entry)).into_owned()
}

/// Whether the bytes begin a zip archive whose first entry is an array.
fn is_archive_of_arrays(beginning: &[u8]) -> bool {
    const NAME: usize = 30;
    let [low, high] = [26, 27].map(|at| beginning.get(at).copied().unwrap_or(0));
    let length = usize::from(u16::from_le_bytes([low, high]));
    beginning.starts_with(b"PK\x03\x04")
        && beginning.get(NAME..NAME + length).is_some_and(|name| name.ends_with(b".npy"))
}

/// Why an array cannot be read.
enum Problem {
    CutOff,
    Unreadable(io::Error),
    Archive(String),
    NoArray,
    Kind(String),
}

impl From<io::Error> for Problem {
    fn from(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::UnexpectedEof { Self::CutOff } else { Self::Unreadable(error) }
    }
}

fn malformed(path: &Path, place: &str, problem: &Problem) -> RecordingError {
    let again = "save it again with numpy.savez";
    let (reason, remedy) = match problem {
        Problem::CutOff => ("it is shorter than its header states".to_owned(), "copy the file again"),
        Problem::Unreadable(error) => (format!("it cannot be read: {error}"), "copy the file again"),
        Problem::Archive(error) => {
            (format!("the zip archive cannot be read: {error}"), "copy it again, or save it again")
        }
        Problem::NoArray => ("the header of the array is missing".to_owned(), again),
        Problem::Kind(kind) => (
            format!("numbers of type {kind} are not supported"),
            "save floats or integers, the fields of a structured array as arrays of their own",
        ),
    };
    RecordingError::malformed(path, place, reason, remedy)
}

impl Header {
    fn read(source: &mut impl Read) -> Result<Self, Problem> {
        let mut start = [0; 8];
        source.read_exact(&mut start)?;
        if !start.starts_with(MAGIC) {
            return Err(Problem::NoArray);
        }
        let mut length = [0; 4];
        let digits = if start[6] == 1 { 2 } else { 4 };
        source.read_exact(&mut length[..digits])?;
        let length = u32::from_le_bytes(length) as usize;
        if length > HEADER_LIMIT {
            return Err(Problem::NoArray);
        }
        let mut text = vec![0; length];
        source.read_exact(&mut text)?;
        Self::parse(&String::from_utf8_lossy(&text))
    }

    /// Parses `{'descr': '<f8', 'fortran_order': False, 'shape': (100, 6), }`.
    fn parse(text: &str) -> Result<Self, Problem> {
        let value =
            |key: &str| text.split_once(key).map(|(_, rest)| rest.trim_start()).ok_or(Problem::NoArray);
        let kind = value("'descr':")?;
        let kind = match kind.strip_prefix('\'').and_then(|k| k.split_once('\'')) {
            Some((kind, _)) => kind,
            None => return Err(Problem::Kind("with fields".to_owned())),
        };
        let column_major = value("'fortran_order':")?.starts_with("True");
        let shape =
            value("'shape':")?.strip_prefix('(').and_then(|s| s.split_once(')')).ok_or(Problem::NoArray)?.0;
        let axes = shape.split(',').map(str::trim).filter(|axis| !axis.is_empty());
        let shape: Vec<usize> = axes
            .map(|axis| axis.trim_end_matches('L').parse())
            .collect::<Result<_, _>>()
            .map_err(|_| Problem::NoArray)?;
        if shape.iter().try_fold(8_usize, |product, n| product.checked_mul(*n)).is_none() {
            return Err(Problem::NoArray);
        }
        Ok(Self { numbers: numbers(kind)?, column_major, shape })
    }

    fn array(&self, name: Option<String>) -> Array {
        Array { name, shape: self.shape.clone(), column_major: self.column_major }
    }
}

/// How numbers of a NumPy type such as `<f8` are stored.
fn numbers(kind: &str) -> Result<Numbers, Problem> {
    let unknown = || Problem::Kind(format!("`{kind}`"));
    let (order, rest) = kind.split_at_checked(1).ok_or_else(unknown)?;
    let (letter, bytes) = rest.split_at_checked(1).ok_or_else(unknown)?;
    let bytes: usize = bytes.parse().map_err(|_| unknown())?;
    let kind = match (letter, bytes) {
        ("f", 4 | 8) => Kind::Float,
        ("i", 1 | 2 | 4 | 8) => Kind::Signed,
        ("u", 1 | 2 | 4 | 8) | ("b", 1) => Kind::Unsigned,
        _ => return Err(unknown()),
    };
    Ok(Numbers { kind, bytes, big_endian: order == ">" })
}
