//! SQLite, the container that ROS 2 recorded into before Jazzy.

use std::io::{Read, Seek, SeekFrom, copy};
use std::path::{Path, PathBuf};

use rusqlite::limits::Limit;
use rusqlite::types::ValueRef;
use rusqlite::{Connection, Error, ErrorCode, OpenFlags, OptionalExtension, Row, Statement};
use tempfile::{NamedTempFile, TempPath};

use crate::bag::records::{Container, Ending, RECORD_LIMIT, Record, Records, Scan, name_of};
use crate::error::RecordingError;
use crate::format::RecordingInput;

pub(super) const SQLITE_MAGIC: &[u8] = b"SQLite format 3\0";

pub(super) struct SqliteFile<'a> {
    path: &'a Path,
    database: Connection,
    /// Whether the file has fewer pages than it says.
    is_cut: bool,
    /// A copy that is read in place of the file, where open files keep their names.
    _copy: Option<TempPath>,
}

impl<'a> SqliteFile<'a> {
    /// The file, unless parts of it are still in another one; `is_named` says that it stands under its path.
    ///
    /// # Errors
    /// A journal beside the file, which says that its writer was stopped; a file that is no database.
    pub(super) fn new(input: &RecordingInput<'a>, is_named: bool) -> Result<Self, RecordingError> {
        let path = input.path;
        for ending in ["-wal", "-journal"] {
            let mut journal = path.as_os_str().to_owned();
            journal.push(ending);
            let journal = PathBuf::from(journal);
            if journal.metadata().is_ok_and(|m| m.len() > 0) {
                let file = path.display();
                return Err(RecordingError::malformed(
                    path,
                    format!("with {}", journal.display()),
                    "its recorder was stopped before it wrote all messages into the file",
                    format!(
                        "complete the file: sqlite3 \"{file}\" \"PRAGMA journal_mode=DELETE; SELECT count(*) FROM topics\""
                    ),
                ));
            }
        }
        let (whole_bytes, is_cut) = whole_pages(&input.beginning, input.bytes);
        // SQLite takes what a page at the end lacks for zeros, so it is given whole pages only.
        let copy =
            (!is_named || whole_bytes < input.bytes).then(|| copied(input, whole_bytes)).transpose()?;
        let opened = open(copy.as_deref().unwrap_or(path));
        let database = opened.map_err(|error| malformed(path, format!("it cannot be opened: {error}")))?;
        Ok(Self { path, database, is_cut, _copy: copy.filter(|_| cfg!(not(unix))) })
    }
}

/// Bytes of the whole pages of a file, and whether its header counts more of them.
fn whole_pages(beginning: &[u8], bytes: u64) -> (u64, bool) {
    let page_bytes = match beginning.get(16..18) {
        Some([0, 1]) => 1 << 16,
        Some([high, low]) => u64::from(u16::from_be_bytes([*high, *low])),
        _ => 0,
    };
    let counted = beginning.get(28..32).and_then(|count| count.first_chunk());
    let counted = u64::from(counted.map_or(0, |count| u32::from_be_bytes(*count)));
    let whole_bytes = bytes.checked_div(page_bytes).unwrap_or(0) * page_bytes;
    (whole_bytes, whole_bytes < bytes || counted * page_bytes > bytes)
}

fn copied(input: &RecordingInput<'_>, bytes: u64) -> Result<TempPath, RecordingError> {
    let spill = |source| RecordingError::Spill { path: input.path.to_owned(), source };
    let mut file = &input.file;
    file.seek(SeekFrom::Start(0)).map_err(spill)?;
    let mut made = NamedTempFile::new().map_err(spill)?;
    copy(&mut file.take(bytes), &mut made).map_err(spill)?;
    Ok(made.into_temp_path())
}

/// Opens a database as bytes that nobody changes, without locks and files beside it.
fn open(path: &Path) -> Result<Connection, Error> {
    let mut uri = "file:".to_owned();
    for byte in path.as_os_str().as_encoded_bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'.' | b'_' | b'-' | b'/' => {
                uri.push(char::from(*byte))
            }
            b'\\' if cfg!(windows) => uri.push('/'),
            byte => uri.push_str(&format!("%{byte:02x}")),
        }
    }
    uri.push_str("?immutable=1");
    let only =
        OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let database = Connection::open_with_flags(uri, only)?;
    database.set_limit(Limit::SQLITE_LIMIT_LENGTH, RECORD_LIMIT as i32)?;
    // With a schema that may be written, which it is not, files with fewer pages than they say are read as well.
    database.execute_batch(
        "PRAGMA writable_schema = ON; PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON; PRAGMA mmap_size = 0",
    )?;
    Ok(database)
}

fn malformed(path: &Path, reason: String) -> RecordingError {
    RecordingError::malformed(
        path,
        "its tables",
        reason,
        "copy the file again; rosbag2 writes tables `topics` and `messages`",
    )
}

impl Container for SqliteFile<'_> {
    fn kind(&self) -> &'static str {
        "SQLite"
    }

    fn path(&self) -> &Path {
        self.path
    }

    fn records<'a>(&'a self, scan: Scan<'a>) -> Result<Box<dyn Records + 'a>, RecordingError> {
        let wanted = if let Scan::Messages(channels) = scan { Some(channels) } else { None };
        match SqliteRecords::new(self, wanted) {
            Ok(records) => Ok(Box::new(records)),
            Err(_) if self.is_cut => {
                Err(malformed(self.path, "the file ends before its first message".to_owned()))
            }
            Err(error) => {
                Err(malformed(self.path, format!("they are not those of a bag of rosbag2: {error}")))
            }
        }
    }
}

/// The rows of one table, in the order of their numbers.
struct SqliteRecords<'a> {
    file: &'a SqliteFile<'a>,
    /// The row after a number.
    next: Statement<'a>,
    /// Time and bytes of the message of a number; of other messages, which may be pictures, no more is read than stands
    /// beside their topic.
    message: Option<Statement<'a>>,
    /// The topics whose messages are read, in ascending order.
    wanted: &'a [u64],
    row: i64,
    /// The topic whose schema was handed out.
    described: Option<(u64, [String; 2])>,
}

impl<'a> SqliteRecords<'a> {
    fn new(file: &'a SqliteFile<'a>, wanted: Option<&'a [u64]>) -> Result<Self, Error> {
        let (table, columns) = match wanted {
            None => ("topics", "id, name, type, serialization_format"),
            Some(_) => ("messages", "topic_id"),
        };
        // A view can compute without end.
        let known = "SELECT 1 FROM sqlite_schema WHERE type = 'table' AND name = ?1 AND rootpage > 0";
        file.database.query_row(known, [table], |_| Ok(()))?;
        let rows = format!(
            "SELECT rowid, {columns} FROM {table} NOT INDEXED WHERE rowid > ?1 ORDER BY rowid LIMIT 1"
        );
        let message = "SELECT timestamp, data FROM messages WHERE rowid = ?1";
        Ok(Self {
            file,
            next: file.database.prepare(&rows)?,
            message: wanted.map(|_| file.database.prepare(message)).transpose()?,
            wanted: wanted.unwrap_or(&[]),
            row: i64::MIN,
            described: None,
        })
    }

    fn step(&mut self, take: &mut dyn FnMut(Record<'_>)) -> Result<bool, Error> {
        let number = |value: ValueRef<'_>| value.as_i64().ok().and_then(|id| u64::try_from(id).ok());
        let last = self.row;
        // Where numbers are damaged, SQLite may find a row that was before.
        let ascending = |row: &Row<'_>| match row.get(0)? {
            row if row > last => Ok(row),
            row => Err(Error::IntegralValueOutOfRange(0, row)),
        };
        let Some(message) = &mut self.message else {
            let topic = self.next.query_row([self.row], |row| {
                let name = |column| Ok::<_, Error>(name_of(bytes(row.get_ref(column)?).unwrap_or(&[])));
                Ok((ascending(row)?, number(row.get_ref(1)?), [name(2)?, name(4)?], name(3)?))
            });
            let Some((row, id, names, schema)) = topic.optional()? else { return Ok(false) };
            self.row = row;
            if let Some(id) = id {
                take(Record::Schema { id, name: schema });
                self.described = Some((id, names));
            }
            return Ok(true);
        };
        let found = self.next.query_row([self.row], |row| Ok((ascending(row)?, number(row.get_ref(1)?))));
        let Some((row, topic)) = found.optional()? else { return Ok(false) };
        self.row = row;
        let Some(channel) = topic.filter(|topic| self.wanted.binary_search(topic).is_ok()) else {
            take(Record::Other);
            return Ok(true);
        };
        message.query_row([self.row], |row| {
            if let (Ok(log_ns), Some(data)) = (row.get_ref(0)?.as_i64(), bytes(row.get_ref(1)?)) {
                take(Record::Message { channel, log_ns, data });
            }
            Ok(true)
        })
    }
}

fn bytes(value: ValueRef<'_>) -> Option<&[u8]> {
    if let ValueRef::Text(bytes) | ValueRef::Blob(bytes) = value { Some(bytes) } else { None }
}

impl Records for SqliteRecords<'_> {
    fn next(&mut self, take: &mut dyn FnMut(Record<'_>)) -> Result<bool, Ending> {
        if let Some((id, [topic, encoding])) = self.described.take() {
            take(Record::Channel { id, schema: id, topic, encoding });
            return Ok(true);
        }
        self.step(take).map_err(|error| match error.sqlite_error_code() {
            Some(ErrorCode::DatabaseCorrupt) if self.file.is_cut => Ending::BreaksOff,
            _ => Ending::Wrong(error.to_string()),
        })
    }
}
