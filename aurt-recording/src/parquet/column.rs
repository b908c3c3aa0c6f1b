use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use bytes::Bytes;
use flate2::read::MultiGzDecoder;
use parquet::basic::Compression;
use parquet::column::page::{Page, PageMetadata, PageReader};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::metadata::{ColumnChunkMetaData, ParquetMetaData};
use parquet::file::reader::{ChunkReader, Length, SerializedPageReader};

use crate::error::RecordingError;
use crate::guarded::guarded;
use crate::memory::Memory;
use crate::parquet::footer::{Compact, Leaf};

/// A longer page is an error: it would be held in memory.
const PAGE_LIMIT: u64 = 1 << 28;
/// Numbers that a page may have.
const MOST_VALUES: u64 = 1 << 24;

#[derive(Debug)]
pub(super) enum Problem {
    /// It ends before it should, or its bytes cannot be what they claim.
    Damaged(String),
    /// It is written in a way that is not read.
    Unknown(String),
    /// A page that would take too much memory.
    TooLarge(RecordingError),
    Lengths {
        expected: usize,
        found: usize,
    },
}

impl From<ParquetError> for Problem {
    fn from(error: ParquetError) -> Self {
        match error {
            ParquetError::NYI(what) => Self::Unknown(format!("pages that the reader refuses ({what})")),
            ParquetError::External(error) => match error.downcast::<RecordingError>() {
                Ok(error) => Self::TooLarge(*error),
                Err(error) => damaged(&error.to_string()),
            },
            error => damaged(&error.to_string()),
        }
    }
}

fn damaged(why: &str) -> Problem {
    Problem::Damaged(format!("a page is truncated or inconsistent with its header ({why})"))
}

/// The numbers of a column, row by row; a page of it is held at a time.
pub(super) struct Column<'a> {
    file: &'a Arc<File>,
    memory: Memory<'a>,
    /// Columns that hold a page each at the same time.
    open: u64,
    leaf: Leaf,
    metadata: &'a ParquetMetaData,
    group: usize,
    reader: Option<ColumnReader>,
    values: Vec<f64>,
    at: usize,
    /// Numbers of a row; for lists none until the first list has been seen.
    width: Option<usize>,
    /// Numbers of the list that is being read, once there is one.
    in_list: Option<usize>,
}

#[derive(Debug, Default)]
struct PageContent {
    definitions: Vec<i16>,
    repetitions: Vec<i16>,
    numbers: Vec<f64>,
    levels: usize,
}

impl<'a> Column<'a> {
    /// The numbers of a column in lists of `width`, or of as many as the first has.
    pub(super) fn new(
        file: &'a Arc<File>,
        memory: Memory<'a>,
        leaf: &Leaf,
        metadata: &'a ParquetMetaData,
        width: Option<usize>,
    ) -> Self {
        let width = if leaf.listed.is_some() { width } else { Some(1) };
        Self {
            file,
            memory,
            open: 1,
            leaf: leaf.clone(),
            metadata,
            group: 0,
            reader: None,
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

    pub(super) fn first_row(mut self) -> Result<Vec<f64>, Problem> {
        while self.values.is_empty() && self.page()? {}
        self.values.truncate(self.width.unwrap_or(self.values.len()));
        Ok(self.values)
    }

    pub(super) fn next(&mut self, row: &mut [f64]) -> Result<(), Problem> {
        while self.values.len() - self.at < row.len() {
            self.values.drain(..self.at);
            self.at = 0;
            if !self.page()? {
                return Err(Problem::Damaged("it ends before the last row".to_owned()));
            }
        }
        row.copy_from_slice(&self.values[self.at..self.at + row.len()]);
        self.at += row.len();
        Ok(())
    }

    fn page(&mut self) -> Result<bool, Problem> {
        const FAILED: &str = "its bytes are none that can be decoded";
        loop {
            let Some(reader) = &mut self.reader else {
                let Some(group) = self.metadata.row_groups().get(self.group) else {
                    return self.close_list().map(|()| false);
                };
                self.group += 1;
                if group.num_rows() > 0 {
                    self.reader = Some(self.open(group.column(self.leaf.place))?);
                }
                continue;
            };
            let leaf = &self.leaf;
            let decoded = guarded(|| decode(reader, leaf)).ok_or_else(|| damaged(FAILED))??;
            if decoded.levels > 0 {
                return self.take(decoded).map(|()| true);
            }
            self.reader = None;
        }
    }

    fn open(&self, chunk: &ColumnChunkMetaData) -> Result<ColumnReader, Problem> {
        let begins = [Some(chunk.data_page_offset()), chunk.dictionary_page_offset()];
        if chunk.compressed_size() < 0 || begins.iter().flatten().any(|begin| *begin < 0) {
            return Err(damaged("its place is negative"));
        }
        match chunk.compression() {
            Compression::UNCOMPRESSED
            | Compression::SNAPPY
            | Compression::GZIP(_)
            | Compression::ZSTD(_)
            | Compression::LZ4_RAW => {}
            other => return Err(Problem::Unknown(format!("pages compressed with {other}"))),
        }
        let source = Arc::new(Source {
            file: Arc::clone(self.file),
            unpacked_bytes: AtomicU64::new(0),
            packed_at: AtomicU64::new(0),
            is_gzip: matches!(chunk.compression(), Compression::GZIP(_)),
            path: self.memory.path().into(),
            allowed_bytes: self.memory.allowed_bytes(),
            column: self.leaf.name.clone(),
            open: self.open,
        });
        let pages = SerializedPageReader::new(Arc::clone(&source), chunk, 0, None)?;
        let pages = Pages { pages, source, pauses: false };
        Ok(get_column_reader(chunk.column_descr_ptr(), Box::new(pages)))
    }

    fn take(&mut self, page: PageContent) -> Result<(), Problem> {
        let defined = self.leaf.defined;
        let mut numbers = page.numbers.into_iter();
        let mut value = |level: &i16| {
            let number = if *level == defined { numbers.next() } else { None };
            number.unwrap_or(f64::NAN)
        };
        let Some(listed) = self.leaf.listed else {
            if defined == 0 {
                self.values.extend(numbers);
            } else {
                self.values.extend(page.definitions.iter().map(value));
            }
            return Ok(());
        };
        for (repetition, definition) in page.repetitions.iter().zip(&page.definitions) {
            if *repetition == 0 {
                self.close_list()?;
                self.in_list = Some(0);
            }
            if *definition >= listed {
                self.values.push(value(definition));
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
}

/// The next page of numbers; without levels after the last.
fn decode(reader: &mut ColumnReader, leaf: &Leaf) -> Result<PageContent, ParquetError> {
    let number = leaf.number;
    match reader {
        ColumnReader::BoolColumnReader(reader) => numbers(reader, |v| f64::from(u8::from(*v))),
        ColumnReader::Int32ColumnReader(reader) => numbers(reader, |v| number.of_int(*v)),
        ColumnReader::Int64ColumnReader(reader) => numbers(reader, |v| number.of_long(*v)),
        ColumnReader::FloatColumnReader(reader) => numbers(reader, |v| f64::from(*v)),
        ColumnReader::DoubleColumnReader(reader) => numbers(reader, |v| *v),
        _ => Err(ParquetError::NYI("columns that are no numbers".to_owned())),
    }
}

fn numbers<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    value: impl Fn(&T::T) -> f64,
) -> Result<PageContent, ParquetError> {
    let (mut page, mut values) = (PageContent::default(), Vec::new());
    let (definitions, repetitions) = (Some(&mut page.definitions), Some(&mut page.repetitions));
    page.levels = reader.read_records(usize::MAX, definitions, repetitions, &mut values)?.2;
    page.numbers = values.iter().map(value).collect();
    Ok(page)
}

/// The pages of a column, one after the other with an end behind each, so that one is decoded at a time.
struct Pages {
    pages: SerializedPageReader<Source>,
    source: Arc<Source>,
    pauses: bool,
}

impl PageReader for Pages {
    fn get_next_page(&mut self) -> Result<Option<Page>, ParquetError> {
        if std::mem::take(&mut self.pauses) {
            return Ok(None);
        }
        while let Some(page) = self.pages.get_next_page()? {
            let (count, bytes) = (u64::from(page.num_values()), page.buffer().len() as u64);
            let is_data = page.is_data_page();
            if count > MOST_VALUES || !is_data && count > bytes {
                return Err(ParquetError::General(format!("it claims {count} numbers")));
            }
            // The bytes and numbers of this page and of those of the other columns; while it is decoded its levels and numbers.
            self.source.claim(count * (8 * self.source.open + 20) + bytes * self.source.open)?;
            if count > 0 || !is_data {
                self.pauses = is_data;
                return Ok(Some(page));
            }
        }
        Ok(None)
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>, ParquetError> {
        self.pages.peek_next_page()
    }

    fn skip_next_page(&mut self) -> Result<(), ParquetError> {
        self.pages.skip_next_page()
    }

    /// Levels tell where lists begin.
    fn at_record_boundary(&mut self) -> Result<bool, ParquetError> {
        Ok(false)
    }
}

impl Iterator for Pages {
    type Item = Result<Page, ParquetError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

/// The file that pages of a column are read from. What they claim is bounded before the crate makes room for it.
struct Source {
    file: Arc<File>,
    /// Bytes that the page whose header was read last unpacks to.
    unpacked_bytes: AtomicU64,
    /// Its bytes before those that are packed.
    packed_at: AtomicU64,
    is_gzip: bool,
    path: Box<Path>,
    allowed_bytes: u64,
    column: String,
    open: u64,
}

impl Source {
    fn claim(&self, needed_bytes: u64) -> Result<(), ParquetError> {
        Memory::bounded(&self.path, self.allowed_bytes)
            .claim(&format!("a page of column {}", self.column), needed_bytes)
            .map_err(|error| ParquetError::External(Box::new(error)))
    }

    fn read(&self, at: u64, most: u64) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        (&*self.file).seek(SeekFrom::Start(at))?;
        (&*self.file).take(most).read_to_end(&mut bytes)?;
        Ok(bytes)
    }
}

impl Length for Source {
    fn len(&self) -> u64 {
        self.file.len()
    }
}

impl ChunkReader for Source {
    type T = BufReader<Arc<File>>;

    /// The file from the header of a page on.
    fn get_read(&self, start: u64) -> Result<Self::T, ParquetError> {
        let no_header = || ParquetError::General("it has no header".to_owned());
        let bytes = self.read(start, 96)?;
        let mut header = Compact(&bytes);
        let [unpacked, packed] = header.page_sizes().ok_or_else(no_header)?;
        if unpacked.max(packed) > PAGE_LIMIT {
            return Err(ParquetError::General(format!("it claims {} bytes", unpacked.max(packed))));
        }
        self.claim(unpacked)?;
        self.unpacked_bytes.store(unpacked, Ordering::Relaxed);
        if self.is_gzip {
            self.packed_at.store(header.packed_at().ok_or_else(no_header)?, Ordering::Relaxed);
        }
        let mut file = Arc::clone(&self.file);
        file.seek(SeekFrom::Start(start))?;
        Ok(BufReader::with_capacity(256, file))
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes, ParquetError> {
        let bytes = self.read(start, length as u64)?;
        if bytes.len() < length {
            return Err(ParquetError::EOF("the file ends in it".to_owned()));
        }
        // Of gzip the crate unpacks as much as there is. Bytes that are none are not packed, or the crate refuses them.
        if self.is_gzip {
            let most = self.unpacked_bytes.load(Ordering::Relaxed);
            let packed = usize::try_from(self.packed_at.load(Ordering::Relaxed)).ok();
            let packed = packed.and_then(|at| bytes.get(at..)).unwrap_or(&[]);
            let mut unpacked = MultiGzDecoder::new(packed).take(most + 1);
            if io::copy(&mut unpacked, &mut io::sink()).is_ok_and(|count| count > most) {
                return Err(ParquetError::General(format!("it unpacks to more than {most} bytes")));
            }
        }
        Ok(bytes.into())
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::GzEncoder;

    use super::*;

    /// A file that a page is read from, of which its header says that it unpacks to so many bytes.
    fn source(bytes: &[u8], unpacked_bytes: u64) -> Source {
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(bytes).unwrap();
        Source {
            file: Arc::new(file),
            unpacked_bytes: AtomicU64::new(unpacked_bytes),
            packed_at: AtomicU64::new(0),
            is_gzip: true,
            path: Path::new("a.parquet").into(),
            allowed_bytes: 1 << 20,
            column: "q".to_owned(),
            open: 1,
        }
    }

    #[test]
    fn gzip_unpacks_to_no_more_than_its_header_says() {
        let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
        packed.write_all(&[0; 1000]).unwrap();
        let packed = packed.finish().unwrap();
        assert_eq!(source(&packed, 1000).get_bytes(0, packed.len()).unwrap(), packed);
        let error = source(&packed, 999).get_bytes(0, packed.len()).unwrap_err().to_string();
        assert!(error.contains("more than 999 bytes"), "{error}");
        assert!(source(&packed, 1000).get_bytes(1, packed.len()).is_err(), "the file ends");
    }

    #[test]
    fn pages_larger_than_the_allowed_memory_are_refused_by_their_headers() {
        let header = |unpacked: [u8; 4]| [&[0x15, 0, 0x15][..], &unpacked, &[0x15, 6, 0x2c]].concat();
        assert!(source(&header([0x80, 0x80, 0x80, 1]), 0).get_read(0).is_ok());
        let error = source(&header([0x82, 0x80, 0x80, 1]), 0).get_read(0).err().map(Problem::from);
        assert!(matches!(error, Some(Problem::TooLarge(RecordingError::TooLarge { .. }))), "{error:?}");
        assert!(source(&[0; 8], 0).get_read(0).is_err(), "no header");
    }
}
