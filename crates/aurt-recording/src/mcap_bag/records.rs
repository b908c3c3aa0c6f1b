use std::fs::File;
use std::io::{self, BufReader, Cursor, Read};

use lz4_flex::frame::FrameDecoder;
use ruzstd::decoding::StreamingDecoder;

const MAGIC_BYTES: usize = 8;
/// A longer record is an error: it would be held in memory.
const RECORD_LIMIT: u64 = 1 << 28;

/// Bytes that are unpacked at once.
const UNPACKED_BYTES: usize = 1 << 16;

const FOOTER: u8 = 0x02;
const SCHEMA: u8 = 0x03;
const CHANNEL: u8 = 0x04;
const MESSAGE: u8 = 0x05;
const CHUNK: u8 = 0x06;

/// A record, as far as its kind is of interest here.
pub(super) enum Record<'a> {
    Schema { id: u16, name: String },
    Channel { id: u16, schema: u16, topic: String, encoding: String },
    Message { channel: u16, log_ns: u64, data: &'a [u8] },
    Other,
}

/// Why reading ended before the file said so.
pub(super) enum Ending {
    /// The file stops in the middle.
    BreaksOff,
    /// Something in it is wrong.
    Wrong(String),
}

impl From<io::Error> for Ending {
    fn from(error: io::Error) -> Self {
        if error.kind() == io::ErrorKind::UnexpectedEof {
            Self::BreaksOff
        } else {
            Self::Wrong(error.to_string())
        }
    }
}

/// The records of a file, one after the other; of chunks one is held in memory, as it is in the file.
pub(super) struct Records<'a> {
    file: BufReader<&'a File>,
    chunk: Option<Chunk>,
    chunks_closed: bool,
    begun: bool,
    ended: bool,
    body: Vec<u8>,
}

/// A chunk that is being read.
struct Chunk {
    source: Box<dyn Read>,
    /// Bytes of records that are still to come.
    left: u64,
    checksum: u32,
    hasher: crc32fast::Hasher,
    /// Whether the file ends within it.
    cut: bool,
}

impl Chunk {
    fn fill(&mut self, count: u64, body: &mut Vec<u8>) -> Result<(), Ending> {
        let cut = self.cut;
        let failed = |error: io::Error| {
            if cut {
                Ending::BreaksOff
            } else {
                Ending::Wrong(format!("a chunk cannot be unpacked: {error}"))
            }
        };
        if count > self.left {
            return Err(Ending::Wrong("a record is longer than its chunk".to_owned()));
        }
        body.clear();
        self.source.by_ref().take(count).read_to_end(body).map_err(failed)?;
        if body.len() as u64 != count {
            return Err(failed(io::ErrorKind::UnexpectedEof.into()));
        }
        self.hasher.update(body);
        self.left -= count;
        Ok(())
    }
}

impl<'a> Records<'a> {
    /// All records, those in chunks among them; with `chunks_closed` those in chunks are passed over.
    pub(super) fn new(file: &'a File, chunks_closed: bool) -> Self {
        let file = BufReader::with_capacity(1 << 16, file);
        Self { file, chunk: None, chunks_closed, begun: false, ended: false, body: Vec::new() }
    }

    /// Hands the next record to `take`; false at the end.
    pub(super) fn next(&mut self, take: &mut dyn FnMut(Record<'_>)) -> Result<bool, Ending> {
        if !std::mem::replace(&mut self.begun, true) {
            self.file.read_exact(&mut [0; MAGIC_BYTES])?;
        }
        while !self.ended {
            if let Some(kind) = self.next_in_chunk()? {
                take(parse(kind, &self.body)?);
                return Ok(true);
            }
            let mut head = [0; 9];
            self.file.read_exact(&mut head)?;
            let kind = head[0];
            let length = Fields(&head[1..]).u64()?;
            match kind {
                FOOTER => self.ended = true,
                CHUNK if !self.chunks_closed => self.open(length)?,
                SCHEMA | CHANNEL | MESSAGE => {
                    limited(length)?;
                    self.body.clear();
                    self.file.by_ref().take(length).read_to_end(&mut self.body)?;
                    if self.body.len() as u64 != length {
                        return Err(Ending::BreaksOff);
                    }
                    take(parse(kind, &self.body)?);
                    return Ok(true);
                }
                _ => {
                    let length = i64::try_from(length).map_err(|_| Ending::BreaksOff)?;
                    self.file.seek_relative(length).map_err(|_| Ending::BreaksOff)?;
                }
            }
        }
        Ok(false)
    }

    /// Reads the next record of the open chunk into `body` and gives its kind.
    fn next_in_chunk(&mut self) -> Result<Option<u8>, Ending> {
        let Some(chunk) = &mut self.chunk else { return Ok(None) };
        if chunk.left == 0 {
            let (sum, found) = (chunk.checksum, chunk.hasher.clone().finalize());
            self.chunk = None;
            if sum != 0 && sum != found {
                return Err(Ending::Wrong("the checksum of a chunk is wrong".to_owned()));
            }
            return Ok(None);
        }
        chunk.fill(9, &mut self.body)?;
        let kind = self.body[0];
        let length = Fields(&self.body[1..]).u64()?;
        limited(length)?;
        chunk.fill(length, &mut self.body)?;
        Ok(Some(kind))
    }

    fn open(&mut self, length: u64) -> Result<(), Ending> {
        // Two times, size, checksum, then the name of the compression and the bytes of the records.
        let mut head = [0; 32];
        self.file.read_exact(&mut head)?;
        let mut fields = Fields(&head[16..]);
        let (size, checksum, name_bytes) = (fields.u64()?, fields.u32()?, fields.u32()?);
        if name_bytes > 64 {
            return Err(Ending::Wrong("the compression of a chunk has no sensible name".to_owned()));
        }
        let mut name = vec![0; name_bytes as usize];
        self.file.read_exact(&mut name)?;
        let mut packed_bytes = [0; 8];
        self.file.read_exact(&mut packed_bytes)?;
        let packed_bytes = u64::from_le_bytes(packed_bytes);
        let rest = length.checked_sub(32 + u64::from(name_bytes) + 8);
        let padding = rest.and_then(|rest| rest.checked_sub(packed_bytes));
        let Some(padding) = padding.and_then(|p| i64::try_from(p).ok()) else {
            return Err(Ending::Wrong("a chunk is longer than its record".to_owned()));
        };
        let mut packed = Vec::new();
        self.file.by_ref().take(packed_bytes).read_to_end(&mut packed)?;
        let cut = packed.len() as u64 != packed_bytes;
        self.file.seek_relative(padding).map_err(|_| Ending::BreaksOff)?;
        let packed = Cursor::new(packed);
        let source: Box<dyn Read> = match name.as_slice() {
            b"" => Box::new(packed),
            // Decoders are slow at handing out a message at a time.
            b"lz4" => Box::new(BufReader::with_capacity(UNPACKED_BYTES, FrameDecoder::new(packed))),
            b"zstd" => match StreamingDecoder::new(packed) {
                Ok(decoder) => Box::new(BufReader::with_capacity(UNPACKED_BYTES, decoder)),
                Err(_) if cut => return Err(Ending::BreaksOff),
                Err(error) => return Err(Ending::Wrong(format!("a chunk cannot be unpacked: {error}"))),
            },
            other => {
                let name = String::from_utf8_lossy(other);
                return Err(Ending::Wrong(format!("chunks are packed with `{name}`; lz4 and zstd are read")));
            }
        };
        self.chunk = Some(Chunk { source, left: size, checksum, hasher: crc32fast::Hasher::new(), cut });
        Ok(())
    }
}

fn limited(length: u64) -> Result<(), Ending> {
    if length > RECORD_LIMIT {
        return Err(Ending::Wrong(format!("a record claims {length} bytes")));
    }
    Ok(())
}

fn parse(kind: u8, body: &[u8]) -> Result<Record<'_>, Ending> {
    let mut fields = Fields(body);
    Ok(match kind {
        SCHEMA => Record::Schema { id: fields.u16()?, name: fields.text()? },
        CHANNEL => Record::Channel {
            id: fields.u16()?,
            schema: fields.u16()?,
            topic: fields.text()?,
            encoding: fields.text()?,
        },
        MESSAGE => {
            let (channel, _sequence, log_ns, _published) =
                (fields.u16()?, fields.u32()?, fields.u64()?, fields.u64()?);
            Record::Message { channel, log_ns, data: fields.0 }
        }
        _ => Record::Other,
    })
}

/// The fields of a record, little-endian.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], Ending> {
        let short = || Ending::Wrong("a record is shorter than its fields".to_owned());
        let (bytes, rest) = self.0.split_first_chunk().ok_or_else(short)?;
        self.0 = rest;
        Ok(*bytes)
    }

    fn u16(&mut self) -> Result<u16, Ending> {
        self.bytes().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Result<u32, Ending> {
        self.bytes().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Result<u64, Ending> {
        self.bytes().map(u64::from_le_bytes)
    }

    fn text(&mut self) -> Result<String, Ending> {
        let length = self.u32()? as usize;
        let short = || Ending::Wrong("a text is longer than its record".to_owned());
        let (text, rest) = self.0.split_at_checked(length).ok_or_else(short)?;
        self.0 = rest;
        Ok(String::from_utf8_lossy(text).into_owned())
    }
}
