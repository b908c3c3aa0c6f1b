//! MATLAB's MAT-files of level 5, which `save` writes up to `-v7`.
//!
//! Source: MathWorks, "MAT-File Format", chapter 1.

use std::collections::HashMap;
use std::io::{self, BufReader, Read};
use std::path::Path;

use flate2::read::ZlibDecoder;

use crate::arrays::{Array, ArrayFile, Kind, Numbers};
use crate::error::RecordingError;
use crate::format::{Reading, RecordingFormat, RecordingInput};
use crate::memory::Memory;
use crate::recording::Recording;

/// Bytes before the first variable.
const PREAMBLE: usize = 128;
/// Names and lists of dimensions longer than this are none.
const SMALL_LIMIT: u64 = 1 << 16;
const COMPRESSED: u32 = 15;
const MATRIX: u32 = 14;

/// MATLAB's `.mat` files of versions 5 to 7: `save("log.mat", "t", "q", "current")`.
///
/// Real numeric variables are read, one row or one column per sample, and those in structures of one element (`log.q`
/// is `q`); texts, cells, sparse and complex variables are skipped. Names are those of text columns: `q` of n × 6 is
/// `q_0` … `q_5`. Variables that are needed are held in memory, others are not unpacked. Version 7.3 is HDF5 and is refused.
///
/// The crates that read these files hold all of a file and decompress it without bound, hence this reader.
pub const MATLAB: RecordingFormat = RecordingFormat {
    name: "MATLAB",
    endings: &["mat"],
    recognises: |beginning| is_level_5(beginning) || is_7_3(beginning),
    read,
};

fn read(input: RecordingInput<'_>, reading: Reading<'_>) -> Result<Recording, RecordingError> {
    let path = input.path;
    let memory = Memory::of(path, input.bytes, reading.options);
    let refused = |reason: &str| {
        RecordingError::malformed(
            path,
            "its first bytes",
            reason,
            "save it in MATLAB with save(\"log.mat\", \"t\", \"q\", \"current\", \"-v7\")",
        )
    };
    if is_7_3(&input.beginning) {
        return Err(refused("it is a MAT-file of version 7.3 (HDF5), which is not supported"));
    }
    if !is_level_5(&input.beginning) {
        return Err(refused("it is not a MAT-file of version 5 to 7"));
    }
    let big_endian = input.beginning.get(PREAMBLE - 2..PREAMBLE) == Some(b"MI");
    let mut arrays = Vec::new();
    let mut scan = Scan { big_endian, found: &mut arrays, needed: &[], loaded: HashMap::new() };
    scan.file(BufReader::new(input.rewound()?)).map_err(|p| malformed(path, &p))?;
    let file = ArrayFile { memory, format: "MATLAB, version 5 to 7", arrays };
    file.read(reading, &mut |needed| {
        let mut again = Vec::new();
        let mut scan = Scan { big_endian, found: &mut again, needed, loaded: HashMap::new() };
        scan.file(BufReader::new(input.rewound()?)).map_err(|p| malformed(path, &p))?;
        Ok(scan.loaded)
    })
}

fn is_level_5(beginning: &[u8]) -> bool {
    beginning.starts_with(b"MATLAB 5.0")
        && matches!(beginning.get(PREAMBLE - 2..PREAMBLE), Some(b"IM" | b"MI"))
}

fn is_7_3(beginning: &[u8]) -> bool {
    beginning.starts_with(b"MATLAB 7.3") || beginning.starts_with(b"\x89HDF\r\n\x1a\n")
}

/// What went wrong, after which variable.
struct Problem {
    after: Option<String>,
    error: io::Error,
}

fn malformed(path: &Path, problem: &Problem) -> RecordingError {
    let place =
        problem.after.as_ref().map_or_else(|| "first variable".into(), |n| format!("after variable `{n}`"));
    let reason = match problem.error.kind() {
        io::ErrorKind::UnexpectedEof => "the file is truncated".to_owned(),
        _ => format!("it cannot be read: {}", problem.error),
    };
    let remedy = "copy the file again, or save it again with -v7".to_owned();
    RecordingError::malformed(path, place, reason, remedy)
}

/// A walk through a file: lists its arrays, and loads those that are needed.
struct Scan<'a> {
    big_endian: bool,
    found: &'a mut Vec<Array>,
    needed: &'a [usize],
    loaded: HashMap<usize, Vec<f64>>,
}

/// The tag of an element: type, bytes, and the data where it stands in the tag itself.
struct Tag {
    kind: u32,
    bytes: u64,
    inside: Option<[u8; 4]>,
}

impl Scan<'_> {
    fn file(&mut self, mut source: impl Read) -> Result<(), Problem> {
        let at = |found: &[Array], error| Problem { after: found.last().and_then(|a| a.name.clone()), error };
        let mut preamble = [0; PREAMBLE];
        source.read_exact(&mut preamble).map_err(|e| at(self.found, e))?;
        loop {
            let Some(tag) = self.first_tag(&mut source).map_err(|e| at(self.found, e))? else {
                return Ok(());
            };
            let mut element = source.by_ref().take(tag.bytes);
            let done = match tag.kind {
                COMPRESSED => {
                    let mut inner = ZlibDecoder::new(&mut element);
                    self.tag(&mut inner).and_then(|tag| match tag.kind {
                        MATRIX => self.matrix(&mut inner.take(tag.bytes), None, 0),
                        _ => Ok(()),
                    })
                }
                MATRIX => self.matrix(&mut element, None, 0),
                _ => Ok(()),
            };
            done.and_then(|()| skip(&mut element)).map_err(|e| at(self.found, e))?;
            let padding = if tag.kind == COMPRESSED { 0 } else { tag.bytes.next_multiple_of(8) - tag.bytes };
            skip(&mut source.by_ref().take(padding)).map_err(|e| at(self.found, e))?;
        }
    }

    fn first_tag(&self, source: &mut impl Read) -> io::Result<Option<Tag>> {
        let mut first = [0; 1];
        if source.read(&mut first)? == 0 {
            return Ok(None);
        }
        self.tag(&mut first.as_slice().chain(source)).map(Some)
    }

    fn tag(&self, source: &mut impl Read) -> io::Result<Tag> {
        let mut words = [[0; 4]; 2];
        for word in &mut words {
            source.read_exact(word)?;
        }
        let first = self.word(words[0]);
        Ok(match first >> 16 {
            0 => Tag { kind: first, bytes: u64::from(self.word(words[1])), inside: None },
            bytes => Tag { kind: first & 0xffff, bytes: u64::from(bytes), inside: Some(words[1]) },
        })
    }

    const fn word(&self, bytes: [u8; 4]) -> u32 {
        if self.big_endian { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }
    }

    /// A short element: its type and bytes.
    fn small(&self, source: &mut impl Read) -> io::Result<Vec<u8>> {
        let tag = self.tag(source)?;
        if let Some(inside) = tag.inside {
            return Ok(inside[..(tag.bytes as usize).min(4)].to_vec());
        }
        if tag.bytes > SMALL_LIMIT {
            return Err(io::Error::other("a name or a list of dimensions is too long"));
        }
        let mut bytes = vec![0; tag.bytes as usize];
        source.read_exact(&mut bytes)?;
        skip(&mut source.take(tag.bytes.next_multiple_of(8) - tag.bytes))?;
        Ok(bytes)
    }

    fn matrix(&mut self, source: &mut dyn Read, field: Option<&str>, depth: usize) -> io::Result<()> {
        const STRUCTURE: u8 = 2;
        const COMPLEX: u8 = 0x08;
        let mut source = source;
        let flags = self.small(&mut source)?;
        let flags = <[u8; 4]>::try_from(flags.get(..4).unwrap_or(&[])).map_err(io::Error::other)?;
        let [class, bits, ..] = self.word(flags).to_le_bytes();
        let shape: Vec<usize> = self
            .small(&mut source)?
            .chunks_exact(4)
            .map(|b| self.word([b[0], b[1], b[2], b[3]]) as usize)
            .collect();
        let written = self.small(&mut source)?;
        let name = field.map_or_else(|| String::from_utf8_lossy(&written).into_owned(), str::to_owned);
        let numbers = shape.iter().try_fold(1_usize, |product, n| product.checked_mul(*n));
        let numbers =
            numbers.ok_or_else(|| io::Error::other(format!("the dimensions of `{name}` are too large")))?;
        match class {
            6..=15 if bits & COMPLEX == 0 => self.numeric(&mut source, name, shape, numbers)?,
            STRUCTURE if numbers == 1 && depth < 4 => {
                let length = self.small(&mut source)?;
                let length = <[u8; 4]>::try_from(length.get(..4).unwrap_or(&[])).map_err(io::Error::other)?;
                let length = (self.word(length) as usize).max(1);
                let fields = self.small(&mut source)?;
                for field in fields.chunks(length) {
                    let end = field.iter().position(|b| *b == 0).unwrap_or(field.len());
                    let field = String::from_utf8_lossy(&field[..end]).into_owned();
                    let tag = self.tag(&mut source)?;
                    let mut element = (&mut source).take(tag.bytes);
                    if tag.kind == MATRIX && tag.bytes > 0 {
                        self.matrix(&mut element, Some(&field), depth + 1)?;
                    }
                    skip(&mut element)?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// The numbers of a variable, which may be stored in a smaller type than the variable has.
    fn numeric(
        &mut self,
        source: &mut dyn Read,
        name: String,
        shape: Vec<usize>,
        count: usize,
    ) -> io::Result<()> {
        let mut source = source;
        let place = self.found.len();
        let tag = self.tag(&mut source)?;
        let (kind, bytes) = match tag.kind {
            1 => (Kind::Signed, 1),
            2 => (Kind::Unsigned, 1),
            3 => (Kind::Signed, 2),
            4 => (Kind::Unsigned, 2),
            5 => (Kind::Signed, 4),
            6 => (Kind::Unsigned, 4),
            7 => (Kind::Float, 4),
            9 => (Kind::Float, 8),
            12 => (Kind::Signed, 8),
            13 => (Kind::Unsigned, 8),
            other => {
                return Err(io::Error::other(format!("`{name}` has numbers of the unknown type {other}")));
            }
        };
        if tag.bytes != (count as u64).saturating_mul(bytes as u64) {
            return Err(io::Error::other(format!("`{name}` has {} bytes for {count} numbers", tag.bytes)));
        }
        self.found.push(Array { name: Some(name), shape, column_major: true });
        if self.needed.contains(&place) {
            let numbers = Numbers { kind, bytes, big_endian: self.big_endian };
            let values = match tag.inside {
                Some(inside) => numbers.read(&mut inside.as_slice(), count)?,
                None => numbers.read(&mut source, count)?,
            };
            self.loaded.insert(place, values);
        }
        Ok(())
    }
}

/// Reads an element to its end; less than it should hold shows with the next tag.
fn skip(source: &mut dyn Read) -> io::Result<()> {
    io::copy(source, &mut io::sink()).map(|_| ())
}
