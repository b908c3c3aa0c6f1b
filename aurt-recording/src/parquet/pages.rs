use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};

use flate2::read::MultiGzDecoder;
use ruzstd::decoding::StreamingDecoder;

use crate::error::RecordingError;
use crate::memory::Memory;
use crate::parquet::encodings::{Bytes, bits, differences, plain, runs, split};
use crate::parquet::footer::{Chunk, Leaf, Number};
use crate::parquet::thrift::Thrift;

/// A longer page is an error: it would be held in memory.
const PAGE_LIMIT: i64 = 1 << 28;
/// Numbers that a page may have.
const MOST_VALUES: i64 = 1 << 24;

const DATA: i64 = 0;
const DICTIONARY: i64 = 2;
const DATA_2: i64 = 3;

/// Why a column cannot be read on.
#[derive(Debug)]
pub(super) enum Problem {
    /// It ends before it should, or its bytes cannot be what they claim.
    Damaged(&'static str),
    /// It is written in a way that is not read.
    Unknown(String),
    /// A page that would take too much memory.
    TooLarge(RecordingError),
    /// Lists of different lengths.
    Lengths { expected: usize, found: usize },
}

/// A stretch of a file.
#[derive(Debug)]
struct Stretch<'a> {
    file: &'a File,
    at: u64,
    end: u64,
}

impl Read for Stretch<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let most = usize::try_from(self.end - self.at).unwrap_or(usize::MAX).min(buffer.len());
        // Other columns read from the same file in between.
        self.file.seek(SeekFrom::Start(self.at))?;
        let count = self.file.read(&mut buffer[..most])?;
        self.at += count as u64;
        Ok(count)
    }
}

/// The numbers of a column, row by row; a page of it is held at a time.
#[derive(Debug)]
pub(super) struct Column<'a> {
    file: &'a File,
    memory: Memory<'a>,
    /// Columns that hold a page each at the same time.
    open: u64,
    leaf: Leaf,
    /// The chunks still to come, the next one last.
    chunks: Vec<Chunk>,
    source: Option<BufReader<Stretch<'a>>>,
    codec: i64,
    dictionary: Vec<f64>,
    values: Vec<f64>,
    at: usize,
    /// Numbers of a row; for lists none until the first list has been seen.
    width: Option<usize>,
    /// Numbers of the list that is being read, once there is one.
    in_list: Option<usize>,
}

/// The head of a page.
#[derive(Debug, Default)]
struct Head {
    kind: i64,
    unpacked: i64,
    packed: i64,
    count: i64,
    encoding: i64,
    level_encodings: [i64; 2],
    /// Bytes of the levels of definition and of repetition, for pages of version 2.
    level_bytes: [i64; 2],
    is_packed: bool,
}

impl<'a> Column<'a> {
    /// The numbers of a column in lists of `width`, or of as many as the first has.
    pub(super) fn new(
        file: &'a File,
        memory: Memory<'a>,
        leaf: &Leaf,
        chunks: &[Chunk],
        width: Option<usize>,
    ) -> Self {
        let width = if leaf.listed.is_some() { width } else { Some(1) };
        Self {
            file,
            memory,
            open: 1,
            leaf: leaf.clone(),
            chunks: chunks.iter().rev().copied().collect(),
            source: None,
            codec: 0,
            dictionary: Vec::new(),
            values: Vec::new(),
            at: 0,
            width,
            in_list: None,
        }
    }

    /// The same, among so many columns that are read at the same time.
    pub(super) fn among(self, columns: usize) -> Self {
        Self { open: columns as u64, ..self }
    }

    /// The numbers of the first row.
    pub(super) fn first_row(mut self) -> Result<Vec<f64>, Problem> {
        while self.values.is_empty() && self.page()? {}
        self.values.truncate(self.width.unwrap_or(self.values.len()));
        Ok(self.values)
    }

    /// Fills `row` with the numbers of the next row.
    pub(super) fn next(&mut self, row: &mut [f64]) -> Result<(), Problem> {
        while self.values.len() - self.at < row.len() {
            self.values.drain(..self.at);
            self.at = 0;
            if !self.page()? {
                return Err(Problem::Damaged("it ends before the last row"));
            }
        }
        row.copy_from_slice(&self.values[self.at..self.at + row.len()]);
        self.at += row.len();
        Ok(())
    }

    /// Reads a page of numbers; false after the last.
    fn page(&mut self) -> Result<bool, Problem> {
        const CUT: Problem = Problem::Damaged("a page is truncated or inconsistent with its header");
        loop {
            let ended = match &mut self.source {
                Some(source) => source.fill_buf().map_err(|_| CUT)?.is_empty(),
                None => true,
            };
            if ended {
                let Some(chunk) = self.chunks.pop() else {
                    return self.close_list().map(|()| false);
                };
                let end = chunk.begin.saturating_add(chunk.bytes);
                let stretch = Stretch { file: self.file, at: chunk.begin, end };
                self.source = Some(BufReader::with_capacity(1 << 16, stretch));
                self.codec = chunk.codec;
                self.dictionary.clear();
                continue;
            }
            let Some(source) = &mut self.source else { return Ok(false) };
            let head = head(source).ok_or(CUT)?;
            let sizes = [head.unpacked, head.packed];
            if sizes.iter().any(|n| !(0..=PAGE_LIMIT).contains(n)) || !(0..=MOST_VALUES).contains(&head.count)
            {
                return Err(CUT);
            }
            // The numbers of this page and of those of the other columns; while it is decoded its bytes, levels and places.
            let needed = head.count as u64 * (8 * self.open + 20) + head.unpacked as u64;
            self.memory
                .claim(&format!("a page of column {}", self.leaf.name), needed)
                .map_err(Problem::TooLarge)?;
            let mut packed = Vec::new();
            source.by_ref().take(head.packed as u64).read_to_end(&mut packed).map_err(|_| CUT)?;
            if packed.len() as i64 != head.packed {
                return Err(CUT);
            }
            match head.kind {
                DATA => {
                    let body = unpack(self.codec, packed, head.unpacked as usize)?;
                    self.data(&head, &body)?;
                }
                DATA_2 => {
                    let levels = head.level_bytes.iter().sum::<i64>();
                    let levels = usize::try_from(levels).ok().filter(|n| *n <= packed.len()).ok_or(CUT)?;
                    let numbers = packed.split_off(levels);
                    let size = (head.unpacked as usize).saturating_sub(levels);
                    let codec = if head.is_packed { self.codec } else { 0 };
                    packed.extend(unpack(codec, numbers, size)?);
                    self.data(&head, &packed)?;
                }
                DICTIONARY => {
                    let body = unpack(self.codec, packed, head.unpacked as usize)?;
                    self.dictionary =
                        plain(Bytes(&body), self.leaf.number, head.count as usize).ok_or(CUT)?;
                    continue;
                }
                _ => continue,
            }
            return Ok(true);
        }
    }

    /// Takes the numbers of a page.
    fn data(&mut self, head: &Head, body: &[u8]) -> Result<(), Problem> {
        const CUT: Problem = Problem::Damaged("the levels of a page are inconsistent with its header");
        const RLE: i64 = 3;
        let count = head.count as usize;
        let mut bytes = Bytes(body);
        let mut levels = |place: usize, largest: u32| -> Result<Option<Vec<u32>>, Problem> {
            let length = if head.kind == DATA_2 {
                usize::try_from(head.level_bytes[place]).map_err(|_| CUT)?
            } else if largest == 0 {
                0
            } else if head.level_encodings[place] == RLE {
                bytes.length().ok_or(CUT)?
            } else {
                return Err(Problem::Unknown("levels in an encoding that is no longer written".to_owned()));
            };
            let written = Bytes(bytes.take(length).ok_or(CUT)?);
            if largest == 0 {
                return Ok(None);
            }
            runs(written, bits(u64::from(largest)), count).map(Some).ok_or(CUT)
        };
        let repetitions = levels(1, u32::from(self.leaf.listed.is_some()))?;
        let definitions = levels(0, self.leaf.defined)?;
        let all = self.leaf.defined;
        let there = definitions.as_ref().map_or(count, |d| d.iter().filter(|level| **level == all).count());
        let numbers = self.numbers(bytes, head.encoding, there)?;
        let Some(definitions) = definitions else {
            self.values.extend(numbers);
            return Ok(());
        };
        let Some((repetitions, listed)) = repetitions.zip(self.leaf.listed) else {
            if there == count {
                self.values.extend(numbers);
            } else {
                let mut numbers = numbers.into_iter();
                let value = |level: &u32| if *level == all { numbers.next() } else { None };
                self.values.extend(definitions.iter().map(value).map(|v| v.unwrap_or(f64::NAN)));
            }
            return Ok(());
        };
        let mut numbers = numbers.into_iter();
        for (repetition, definition) in repetitions.iter().zip(&definitions) {
            if *repetition == 0 {
                self.close_list()?;
                self.in_list = Some(0);
            }
            if *definition >= listed {
                let number = if *definition == all { numbers.next() } else { None };
                self.values.push(number.unwrap_or(f64::NAN));
                self.in_list = Some(self.in_list.unwrap_or(0) + 1);
            }
        }
        Ok(())
    }

    /// Checks the length of the list that has ended.
    fn close_list(&mut self) -> Result<(), Problem> {
        let (Some(found), Some(_)) = (self.in_list.take(), self.leaf.listed) else { return Ok(()) };
        match *self.width.get_or_insert(found) {
            expected if expected != found => Err(Problem::Lengths { expected, found }),
            _ => Ok(()),
        }
    }

    fn numbers(&self, mut bytes: Bytes<'_>, encoding: i64, count: usize) -> Result<Vec<f64>, Problem> {
        const CUT: Problem =
            Problem::Damaged("the numbers of a page are truncated or inconsistent with its header");
        let number = self.leaf.number;
        match encoding {
            0 => plain(bytes, number, count),
            2 | 8 => {
                let width = if count == 0 { 0 } else { u32::from(bytes.take(1).ok_or(CUT)?[0]) };
                let places = runs(bytes, width, count).ok_or(CUT)?;
                places.iter().map(|place| self.dictionary.get(*place as usize).copied()).collect()
            }
            3 if number == Number::Truth => {
                let length = bytes.length().ok_or(CUT)?;
                let written = Bytes(bytes.take(length).ok_or(CUT)?);
                runs(written, 1, count).map(|bits| bits.into_iter().map(f64::from).collect())
            }
            5 => differences(bytes, number, count),
            9 => split(bytes, number, count),
            other => return Err(Problem::Unknown(format!("numbers in encoding {other}"))),
        }
        .ok_or(CUT)
    }
}

fn head(source: &mut impl Read) -> Option<Head> {
    let mut head = Head { is_packed: true, ..Head::default() };
    Thrift::new(source).fields(&mut |t, id, _| {
        match id {
            1 => head.kind = t.int()?,
            2 => head.unpacked = t.int()?,
            3 => head.packed = t.int()?,
            5 => t.fields(&mut |t, id, _| {
                match id {
                    1 => head.count = t.int()?,
                    2 => head.encoding = t.int()?,
                    3 => head.level_encodings[0] = t.int()?,
                    4 => head.level_encodings[1] = t.int()?,
                    _ => return Some(false),
                }
                Some(true)
            })?,
            7 => t.fields(&mut |t, id, _| {
                if id == 1 {
                    head.count = t.int()?;
                }
                Some(id == 1)
            })?,
            8 => t.fields(&mut |t, id, kind| {
                match id {
                    1 => head.count = t.int()?,
                    4 => head.encoding = t.int()?,
                    5 => head.level_bytes[0] = t.int()?,
                    6 => head.level_bytes[1] = t.int()?,
                    7 => {
                        head.is_packed = kind == crate::parquet::thrift::TRUE;
                        return Some(false);
                    }
                    _ => return Some(false),
                }
                Some(true)
            })?,
            _ => return Some(false),
        }
        Some(true)
    })?;
    head.level_bytes.iter().all(|n| *n >= 0).then_some(head)
}

/// The bytes of a page as they were before they were compressed to `packed`.
fn unpack(codec: i64, packed: Vec<u8>, size: usize) -> Result<Vec<u8>, Problem> {
    const CUT: Problem = Problem::Damaged("a page cannot be unpacked");
    // What is announced bounds what is made, whatever the compressed bytes say.
    let drain = |source: &mut dyn Read| {
        let mut body = Vec::new();
        source.take(size as u64).read_to_end(&mut body).map_err(|_| CUT)?;
        Ok(body)
    };
    let body = match codec {
        0 => packed,
        1 => {
            if snap::raw::decompress_len(&packed).map_err(|_| CUT)? != size {
                return Err(CUT);
            }
            snap::raw::Decoder::new().decompress_vec(&packed).map_err(|_| CUT)?
        }
        2 => drain(&mut MultiGzDecoder::new(packed.as_slice()))?,
        6 => drain(&mut StreamingDecoder::new(packed.as_slice()).map_err(|_| CUT)?)?,
        7 => lz4_flex::block::decompress(&packed, size).map_err(|_| CUT)?,
        other => {
            let name = match other {
                3 => "LZO",
                4 => "Brotli",
                5 => "the old LZ4",
                _ => "an unknown codec",
            };
            return Err(Problem::Unknown(format!("pages compressed with {name}")));
        }
    };
    if body.len() == size { Ok(body) } else { Err(CUT) }
}
