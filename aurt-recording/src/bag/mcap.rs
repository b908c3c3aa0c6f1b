//! MCAP, the container that ROS 2 records into since Jazzy.
//!
//! Source: the MCAP specification, <https://mcap.dev/spec>.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::ops::Range;
use std::path::Path;

use lz4_flex::frame::FrameDecoder;
use zstd::stream::read::Decoder;

use crate::bag::records::{Container, Ending, RECORD_LIMIT, Record, Records, Scan, name_of};
use crate::error::RecordingError;
use crate::format::RecordingInput;
use crate::memory::Memory;

pub(super) const MCAP_MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// Room that is made for the records of a chunk before they have arrived, at most.
const CHUNK_ROOM: u64 = 1 << 22;

const FOOTER: u8 = 0x02;
const SCHEMA: u8 = 0x03;
const CHANNEL: u8 = 0x04;
const MESSAGE: u8 = 0x05;
const CHUNK: u8 = 0x06;

pub(super) struct McapFile<'a> {
    pub(super) input: RecordingInput<'a>,
    pub(super) memory: Memory<'a>,
}

impl Container for McapFile<'_> {
    fn kind(&self) -> &'static str {
        "MCAP"
    }

    fn path(&self) -> &Path {
        self.input.path
    }

    fn records<'a>(&'a self, scan: Scan<'a>) -> Result<Box<dyn Records + 'a>, RecordingError> {
        let chunks_closed = matches!(scan, Scan::Summary);
        Ok(Box::new(McapRecords::new(self.input.rewound()?, self.memory.allowed_bytes(), chunks_closed)))
    }
}

/// The records of a file, one after the other; of chunks one is held in memory, unpacked.
struct McapRecords<'a> {
    file: BufReader<&'a File>,
    /// The records of the present chunk, and how far they are read.
    chunk: Vec<u8>,
    at: usize,
    /// Why the present chunk has no more than that.
    chunk_ending: Option<Ending>,
    most_bytes: u64,
    chunks_closed: bool,
    begun: bool,
    ended: bool,
    body: Vec<u8>,
}

impl<'a> McapRecords<'a> {
    /// All records, those in chunks among them; with `chunks_closed` those in chunks are skipped.
    fn new(file: &'a File, most_bytes: u64, chunks_closed: bool) -> Self {
        let most_bytes = most_bytes.min(RECORD_LIMIT);
        let file = BufReader::with_capacity(1 << 16, file);
        let (chunk, body) = (Vec::new(), Vec::new());
        Self {
            file,
            chunk,
            at: 0,
            chunk_ending: None,
            most_bytes,
            chunks_closed,
            begun: false,
            ended: false,
            body,
        }
    }

    /// The next record of the open chunk: its kind, and where it is in it.
    fn next_in_chunk(&mut self) -> Result<Option<(u8, Range<usize>)>, Ending> {
        let rest = &self.chunk[self.at..];
        let head = rest.split_first_chunk::<9>().map(|(head, rest)| (head[0], &head[1..], rest));
        if let Some((kind, length, rest)) = head {
            let length = Fields(length).u64()?;
            limited(length, self.most_bytes)?;
            if length <= rest.len() as u64 {
                let begin = self.at + 9;
                self.at = begin + length as usize;
                return Ok(Some((kind, begin..self.at)));
            }
        }
        if let Some(ending) = self.chunk_ending.take() {
            return Err(ending);
        }
        if !rest.is_empty() {
            return Err(Ending::Wrong("a record is longer than its chunk".to_owned()));
        }
        Ok(None)
    }

    fn open(&mut self, length: u64) -> Result<(), Ending> {
        // Two times, size, checksum, then the name of the compression and the bytes of the records.
        let mut head = [0; 32];
        self.file.read_exact(&mut head)?;
        let mut fields = Fields(&head[16..]);
        let (size, checksum, name_bytes) = (fields.u64()?, fields.u32()?, fields.u32()?);
        if name_bytes > 64 {
            return Err(Ending::Wrong("the compression of a chunk has an invalid name".to_owned()));
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
        limited(size, self.most_bytes)?;
        self.chunk.clear();
        self.at = 0;
        let cut;
        let unpacked = if name.is_empty() {
            let read = self.file.by_ref().take(packed_bytes).read_to_end(&mut self.chunk);
            cut = self.chunk.len() as u64 != packed_bytes;
            read
        } else {
            self.body.clear();
            self.file.by_ref().take(packed_bytes).read_to_end(&mut self.body)?;
            cut = self.body.len() as u64 != packed_bytes;
            self.chunk.reserve(size.min(CHUNK_ROOM) as usize);
            unpack(&name, &self.body, size, &mut self.chunk)?
        };
        let failed = |reason: String| Ending::Wrong(format!("a chunk cannot be unpacked: {reason}"));
        self.chunk_ending = match unpacked {
            _ if cut => Some(Ending::BreaksOff),
            Err(error) => Some(failed(error.to_string())),
            Ok(_) if self.chunk.len() as u64 != size => {
                Some(failed(format!("it has {} bytes instead of {size}", self.chunk.len())))
            }
            Ok(_) if checksum != 0 && checksum != crc32fast::hash(&self.chunk) => {
                Some(Ending::Wrong("the checksum of a chunk is wrong".to_owned()))
            }
            Ok(_) => None,
        };
        self.file.seek_relative(padding).map_err(|_| Ending::BreaksOff)
    }
}

impl Records for McapRecords<'_> {
    fn next(&mut self, take: &mut dyn FnMut(Record<'_>)) -> Result<bool, Ending> {
        if !std::mem::replace(&mut self.begun, true) {
            self.file.read_exact(&mut [0; MCAP_MAGIC.len()])?;
        }
        while !self.ended {
            if let Some((kind, bytes)) = self.next_in_chunk()? {
                take(parse(kind, &self.chunk[bytes])?);
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
                    limited(length, self.most_bytes)?;
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
}

/// Unpacks a chunk as far as that goes, into `size` bytes at most; why no further is within the result.
fn unpack(name: &[u8], packed: &[u8], size: u64, chunk: &mut Vec<u8>) -> Result<io::Result<usize>, Ending> {
    Ok(match name {
        b"lz4" => FrameDecoder::new(packed).take(size).read_to_end(chunk),
        b"zstd" => Decoder::new(packed).and_then(|decoder| decoder.take(size).read_to_end(chunk)),
        other => {
            let name = String::from_utf8_lossy(other);
            return Err(Ending::Wrong(format!("chunks are packed with `{name}`; lz4 and zstd are read")));
        }
    })
}

fn limited(length: u64, most: u64) -> Result<(), Ending> {
    if length > most {
        return Err(Ending::Wrong(format!(
            "a record or chunk claims {length} bytes, and {most} are allowed"
        )));
    }
    Ok(())
}

fn parse(kind: u8, body: &[u8]) -> Result<Record<'_>, Ending> {
    let mut fields = Fields(body);
    Ok(match kind {
        SCHEMA => Record::Schema { id: fields.u16()?.into(), name: fields.text()? },
        CHANNEL => Record::Channel {
            id: fields.u16()?.into(),
            schema: fields.u16()?.into(),
            topic: fields.text()?,
            encoding: fields.text()?,
        },
        MESSAGE => {
            let (channel, _sequence, log_ns, _published) =
                (fields.u16()?, fields.u32()?, fields.u64()?, fields.u64()?);
            let log_ns = i64::try_from(log_ns).unwrap_or(i64::MAX);
            Record::Message { channel: channel.into(), log_ns, data: fields.0 }
        }
        _ => Record::Other,
    })
}

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
        Ok(name_of(text))
    }
}
