//! Tables of an SQLite database, read row by row: no index, no query, no writing.
//!
//! A bag needs two tables from their first row to their last. `rusqlite` compiles 250 000 lines of C for that, and a C
//! compiler cannot be assumed.
//!
//! Source: SQLite, "Database File Format", <https://www.sqlite.org/fileformat2.html>.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};

use crate::bag::records::{Ending, RECORD_LIMIT};

pub(super) const SQLITE_MAGIC: &[u8] = b"SQLite format 3\0";
/// Bytes before the b-tree of the first page.
const HEADER: usize = 100;
const INTERIOR: u8 = 0x05;
const LEAF: u8 = 0x0d;
/// Deeper trees have more pages than a file can have.
const DEEPEST: usize = 24;

/// An open database.
#[derive(Debug, Clone, Copy)]
pub(super) struct Database<'a> {
    file: &'a File,
    page_bytes: usize,
    /// Bytes of a page without those that are reserved for extensions.
    usable: usize,
    /// Pages that the file has room for.
    pages: u64,
}

/// The value of a cell, as far as bags have it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Value<'a> {
    Integer(i64),
    /// A text or a blob.
    Bytes(&'a [u8]),
    /// NULL or a number with decimals.
    Other,
}

impl<'a> Value<'a> {
    pub(super) const fn integer(self) -> Option<i64> {
        if let Self::Integer(value) = self { Some(value) } else { None }
    }

    pub(super) const fn bytes(self) -> &'a [u8] {
        if let Self::Bytes(bytes) = self { bytes } else { &[] }
    }
}

fn wrong(reason: &str) -> Ending {
    Ending::Wrong(reason.to_owned())
}

impl<'a> Database<'a> {
    /// Reads the header.
    pub(super) fn open(file: &'a File) -> Result<Self, Ending> {
        let mut file_at_start = file;
        file_at_start.seek(SeekFrom::Start(0))?;
        let mut header = [0; HEADER];
        file_at_start.read_exact(&mut header)?;
        let page_bytes = match u16::from_be_bytes([header[16], header[17]]) {
            1 => 1 << 16,
            bytes => usize::from(bytes),
        };
        let usable = page_bytes.saturating_sub(usize::from(header[20]));
        if !header.starts_with(SQLITE_MAGIC) || !page_bytes.is_power_of_two() || usable < 480 {
            return Err(wrong("its header is not that of an SQLite database"));
        }
        if header[56..60] != [0, 0, 0, 1] {
            return Err(wrong("its texts are UTF-16, those of rosbag2 are UTF-8"));
        }
        let pages = file.metadata()?.len().div_ceil(page_bytes as u64);
        Ok(Self { file, page_bytes, usable, pages })
    }

    /// The root page and the columns of a table.
    pub(super) fn table(&self, name: &str) -> Result<Option<(u64, Vec<String>)>, Ending> {
        let mut rows = self.rows(1);
        while rows.advance()? {
            rows.complete()?;
            let row = rows.values();
            let Some(&[kind, of, _, root, sql]) = row.first_chunk() else { continue };
            if kind == Value::Bytes(b"table") && of == Value::Bytes(name.as_bytes()) {
                let root = root.integer().and_then(|page| u64::try_from(page).ok());
                return Ok(root.map(|root| (root, columns(&String::from_utf8_lossy(sql.bytes())))));
            }
        }
        Ok(None)
    }

    /// The rows of the table whose root is that page, in the order of their numbers.
    pub(super) fn rows(&self, root: u64) -> Rows<'a> {
        let pages_left = self.pages;
        Rows { database: *self, path: Vec::new(), next: Some(root), pages_left, row: Row::default() }
    }

    fn page(&self, number: u64, page: &mut Vec<u8>) -> Result<(), Ending> {
        if number == 0 {
            return Err(wrong("it refers to page 0, which does not exist"));
        }
        if number > self.pages {
            return Err(Ending::BreaksOff);
        }
        let mut file = self.file;
        file.seek(SeekFrom::Start((number - 1) * self.page_bytes as u64))?;
        page.resize(self.page_bytes, 0);
        Ok(file.read_exact(page)?)
    }

    /// Bytes of a payload that stand in its leaf; the rest is on overflow pages.
    const fn local(&self, payload: usize) -> usize {
        let most = self.usable - 35;
        if payload <= most {
            return payload;
        }
        let least = (self.usable - 12) * 32 / 255 - 23;
        let fitting = least + (payload - least) % (self.usable - 4);
        if fitting <= most { fitting } else { least }
    }
}

/// The names of the columns in `CREATE TABLE name(id INTEGER PRIMARY KEY, …)`.
fn columns(sql: &str) -> Vec<String> {
    let list = sql.split_once('(').map_or("", |(_, list)| list);
    let name = |column: &str| {
        column.split_whitespace().next().unwrap_or("").trim_matches(['"', '`', '[', ']']).to_owned()
    };
    list.split(',').map(name).collect()
}

/// A walk through the rows of a table.
pub(super) struct Rows<'a> {
    database: Database<'a>,
    /// Pages from the root to the present leaf, with the cell of each that is next.
    path: Vec<(Vec<u8>, usize, usize)>,
    /// The page that the walk goes down to next.
    next: Option<u64>,
    /// Pages that may still be visited: a tree has none twice.
    pages_left: u64,
    row: Row,
}

/// A row as it is stored.
#[derive(Debug, Default)]
struct Row {
    number: i64,
    payload: Vec<u8>,
    bytes: usize,
    /// The first of the pages with the rest of it.
    overflow: Option<u64>,
}

impl Rows<'_> {
    /// Goes to the next row and reads what its leaf has of it; false after the last.
    pub(super) fn advance(&mut self) -> Result<bool, Ending> {
        loop {
            if let Some(number) = self.next.take() {
                self.descend(number)?;
            }
            let Some((page, begin, cell)) = self.path.last_mut() else { return Ok(false) };
            let interior = page[*begin] == INTERIOR;
            let cells = usize::from(u16::from_be_bytes([page[*begin + 3], page[*begin + 4]]));
            let at = *cell;
            *cell += 1;
            if interior && at == cells {
                self.next = Some(word(page, *begin + 8)?.into());
                continue;
            }
            if at >= cells {
                self.path.pop();
                continue;
            }
            let head = if interior { 12 } else { 8 };
            let pointer = *begin + head + 2 * at;
            let pointer =
                page.get(pointer..pointer + 2).ok_or_else(|| wrong("a page has more cells than fit"))?;
            let at = usize::from(u16::from_be_bytes([pointer[0], pointer[1]]));
            if interior {
                self.next = Some(word(page, at)?.into());
                continue;
            }
            let cell =
                page.get(at..self.database.usable).ok_or_else(|| wrong("a cell is beyond its page"))?;
            self.row.take(cell, &self.database)?;
            return Ok(true);
        }
    }

    fn descend(&mut self, number: u64) -> Result<(), Ending> {
        self.pages_left = self
            .pages_left
            .checked_sub(1)
            .ok_or_else(|| wrong("its pages refer to each other in a circle"))?;
        if self.path.len() >= DEEPEST {
            return Err(wrong("its pages are nested too deeply"));
        }
        let mut page = Vec::new();
        self.database.page(number, &mut page)?;
        let begin = if number == 1 { HEADER } else { 0 };
        if ![INTERIOR, LEAF].contains(&page[begin]) {
            return Err(wrong("a page of a table is damaged"));
        }
        self.path.push((page, begin, 0));
        Ok(())
    }

    /// Reads what the leaf does not have of the row.
    pub(super) fn complete(&mut self) -> Result<(), Ending> {
        let mut page = Vec::new();
        while let Some(number) = self.row.overflow.take() {
            self.pages_left = self
                .pages_left
                .checked_sub(1)
                .ok_or_else(|| wrong("its pages refer to each other in a circle"))?;
            self.database.page(number, &mut page)?;
            let left = self.row.bytes - self.row.payload.len();
            let here = left.min(self.database.usable - 4);
            self.row.payload.extend_from_slice(&page[4..4 + here]);
            if here < left {
                self.row.overflow = Some(word(&page, 0)?.into());
            }
        }
        Ok(())
    }

    /// The values of the row, as far as it was read; the number of the row stands for a key that is stored with it.
    pub(super) fn values(&self) -> Vec<Value<'_>> {
        let payload = self.row.payload.as_slice();
        let mut at = 0;
        let header = varint(payload, &mut at).and_then(|bytes| usize::try_from(bytes).ok()).unwrap_or(0);
        let (mut values, mut body) = (Vec::new(), header);
        while at < header.min(payload.len()) {
            let Some(kind) = varint(payload, &mut at) else { break };
            let bytes = match kind {
                0 | 8 | 9 | 10 | 11 => 0,
                1..=4 => kind as usize,
                5 => 6,
                6 | 7 => 8,
                blob => usize::try_from((blob - 12) / 2).unwrap_or(usize::MAX),
            };
            let Some(stored) = body.checked_add(bytes).and_then(|end| payload.get(body..end)) else { break };
            body += bytes;
            values.push(match kind {
                0 if values.is_empty() => Value::Integer(self.row.number),
                1..=6 => {
                    let sign = if stored[0] & 0x80 == 0 { 0 } else { -1 };
                    Value::Integer(stored.iter().fold(sign, |value, byte| value << 8 | i64::from(*byte)))
                }
                8 => Value::Integer(0),
                9 => Value::Integer(1),
                12.. => Value::Bytes(stored),
                _ => Value::Other,
            });
        }
        values
    }
}

impl Row {
    fn take(&mut self, cell: &[u8], database: &Database<'_>) -> Result<(), Ending> {
        let mut at = 0;
        let head = varint(cell, &mut at).zip(varint(cell, &mut at));
        let (bytes, number) = head.ok_or_else(|| wrong("a cell breaks off"))?;
        if bytes > RECORD_LIMIT {
            return Err(wrong("a row claims more than 256 MB"));
        }
        (self.number, self.bytes) = (number as i64, bytes as usize);
        let local = database.local(self.bytes);
        let stored = cell.get(at..at + local).ok_or_else(|| wrong("a cell breaks off"))?;
        self.payload.clear();
        self.payload.extend_from_slice(stored);
        self.overflow = if local < self.bytes { Some(word(cell, at + local)?.into()) } else { None };
        Ok(())
    }
}

fn word(bytes: &[u8], at: usize) -> Result<u32, Ending> {
    let word = bytes.get(at..).and_then(|rest| rest.first_chunk()).ok_or_else(|| wrong("a page is cut"))?;
    Ok(u32::from_be_bytes(*word))
}

/// A number of one to nine bytes, the most significant first.
fn varint(bytes: &[u8], at: &mut usize) -> Option<u64> {
    let mut value = 0_u64;
    for k in 0..9 {
        let byte = *bytes.get(*at)?;
        *at += 1;
        if k == 8 {
            return Some(value << 8 | u64::from(byte));
        }
        value = value << 7 | u64::from(byte & 0x7f);
        if byte & 0x80 == 0 {
            break;
        }
    }
    Some(value)
}
