//! Arrays as NumPy saves them: `.npy`, and `.npz` with one array per quantity.
//!
//! Source: numpy.lib.format, "Format Version 1.0", "2.0" and "3.0".

use std::collections::HashMap;
use std::io::{self, BufReader, Read};
use std::path::Path;

use zip::ZipArchive;
use zip::result::ZipError;

use crate::arrays::{Array, ArrayFile, Kind, Numbers};
use crate::error::RecordingError;
use crate::format::{Reading, RecordingFormat, RecordingInput};
use crate::memory::Memory;
use crate::recording::Recording;

const MAGIC: &[u8] = b"\x93NUMPY";

const HEADER_LIMIT: usize = 1 << 16;

/// Arrays saved by NumPy: `np.savez("log.npz", time=t, q=q, current=i)`, compressed or not, and single arrays (`.npy`),
/// whose columns have to be selected.
///
/// Arrays have one row per sample, or one column; 4- and 8-byte floats, integers and booleans of either byte order are
/// read, 1-D for single columns. Names are those of text columns: `q` of shape (n, 6) is `q_0` … `q_5`. Arrays that
/// hold other things are skipped. Arrays that are needed are held in memory, others are not unpacked.
pub const NUMPY: RecordingFormat = RecordingFormat {
    name: "NumPy",
    endings: &["npy", "npz"],
    recognises: |beginning| beginning.starts_with(MAGIC) || is_archive_of_arrays(beginning),
    read,
};

struct Header {
    numbers: Numbers,
    column_major: bool,
    shape: Vec<usize>,
}

fn read(input: RecordingInput<'_>, reading: Reading<'_>) -> Result<Recording, RecordingError> {
    let path = input.path;
    let memory = Memory::of(path, input.bytes, reading.options);
    if input.beginning.starts_with(MAGIC) {
        let mut source = BufReader::new(input.rewound()?);
        let header = Header::read(&mut source).map_err(|p| p.at(path, "its header"))?;
        let array = header.array(None);
        let count = array.shape.iter().product();
        let file = ArrayFile { memory, format: "NumPy array", arrays: vec![array] };
        return file.read(reading, &mut |_| {
            let values = header.numbers.read(&mut source, count);
            Ok(HashMap::from([(0, values.map_err(|e| Problem::from(e).at(path, "the array"))?)]))
        });
    }
    let damaged = |error: ZipError| {
        let reason = format!("the zip archive cannot be read: {error}");
        RecordingError::malformed(path, "the archive", reason, "copy it again, or save it again")
    };
    let mut archive = ZipArchive::new(BufReader::new(input.rewound()?)).map_err(damaged)?;
    let (mut arrays, mut entries) = (Vec::new(), Vec::new());
    for entry in 0..archive.len() {
        let mut source = archive.by_index(entry).map_err(damaged)?;
        let name = name_of(source.name_raw());
        // Texts and objects are no reason to refuse what stands beside them.
        if let Ok(header) = Header::read(&mut source) {
            arrays.push(header.array(Some(name)));
            entries.push(entry);
        }
    }
    let found: Vec<usize> = arrays.iter().map(|a| a.shape.iter().product()).collect();
    let file = ArrayFile { memory, format: "NumPy archive", arrays };
    file.read(reading, &mut |needed| {
        let mut loaded = HashMap::new();
        for place in needed {
            let mut source = archive.by_index(entries[*place]).map_err(damaged)?;
            let name = format!("array `{}`", name_of(source.name_raw()));
            let values = Header::read(&mut source)
                .and_then(|header| Ok(header.numbers.read(&mut source, found[*place])?));
            loaded.insert(*place, values.map_err(|p| p.at(path, &name))?);
        }
        Ok(loaded)
    })
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

/// Why an array cannot be read, and what to do.
struct Problem(String, &'static str);

impl Problem {
    fn no_array() -> Self {
        Self("the header of the array is missing".to_owned(), "save it again with numpy.savez")
    }

    fn kind(kind: &str) -> Self {
        let remedy = "save floats or integers, the fields of a structured array as arrays of their own";
        Self(format!("numbers of type {kind} are not supported"), remedy)
    }

    fn at(self, path: &Path, place: &str) -> RecordingError {
        RecordingError::malformed(path, place, self.0, self.1)
    }
}

impl From<io::Error> for Problem {
    fn from(error: io::Error) -> Self {
        let reason = match error.kind() {
            io::ErrorKind::UnexpectedEof => "it is shorter than its header states".to_owned(),
            _ => format!("it cannot be read: {error}"),
        };
        Self(reason, "copy the file again")
    }
}

impl Header {
    fn read(source: &mut impl Read) -> Result<Self, Problem> {
        let mut start = [0; 8];
        source.read_exact(&mut start)?;
        if !start.starts_with(MAGIC) {
            return Err(Problem::no_array());
        }
        let mut length = [0; 4];
        let digits = if start[6] == 1 { 2 } else { 4 };
        source.read_exact(&mut length[..digits])?;
        let length = u32::from_le_bytes(length) as usize;
        if length > HEADER_LIMIT {
            return Err(Problem::no_array());
        }
        let mut text = vec![0; length];
        source.read_exact(&mut text)?;
        Self::parse(&String::from_utf8_lossy(&text))
    }

    /// Parses `{'descr': '<f8', 'fortran_order': False, 'shape': (100, 6), }`.
    fn parse(text: &str) -> Result<Self, Problem> {
        let value =
            |key: &str| text.split_once(key).map(|(_, rest)| rest.trim_start()).ok_or_else(Problem::no_array);
        let kind = value("'descr':")?;
        let kind = match kind.strip_prefix('\'').and_then(|k| k.split_once('\'')) {
            Some((kind, _)) => kind,
            None => return Err(Problem::kind("with fields")),
        };
        let column_major = value("'fortran_order':")?.starts_with("True");
        let shape = value("'shape':")?
            .strip_prefix('(')
            .and_then(|s| s.split_once(')'))
            .ok_or_else(Problem::no_array)?
            .0;
        let axes = shape.split(',').map(str::trim).filter(|axis| !axis.is_empty());
        let shape: Vec<usize> = axes
            .map(|axis| axis.trim_end_matches('L').parse())
            .collect::<Result<_, _>>()
            .map_err(|_| Problem::no_array())?;
        if shape.iter().try_fold(8_usize, |product, n| product.checked_mul(*n)).is_none() {
            return Err(Problem::no_array());
        }
        Ok(Self { numbers: numbers(kind)?, column_major, shape })
    }

    fn array(&self, name: Option<String>) -> Array {
        Array { name, shape: self.shape.clone(), column_major: self.column_major }
    }
}

/// How numbers of a NumPy type such as `<f8` are stored.
fn numbers(kind: &str) -> Result<Numbers, Problem> {
    let unknown = || Problem::kind(&format!("`{kind}`"));
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
