//! SQLite, the container that ROS 2 recorded into before Jazzy.

use std::path::{Path, PathBuf};

use crate::bag::btree::{Database, Rows, Value};
use crate::bag::records::{Container, Ending, Record, Records, Scan, name_of};
use crate::error::RecordingError;
use crate::format::RecordingInput;

/// An open file.
pub(super) struct SqliteFile<'a>(RecordingInput<'a>);

impl<'a> SqliteFile<'a> {
    /// The file, unless parts of it are still in another one.
    ///
    /// # Errors
    /// A journal beside the file, which says that its writer was stopped.
    pub(super) fn new(input: RecordingInput<'a>) -> Result<Self, RecordingError> {
        for ending in ["-wal", "-journal"] {
            let mut journal = input.path.as_os_str().to_owned();
            journal.push(ending);
            let journal = PathBuf::from(journal);
            if journal.metadata().is_ok_and(|m| m.len() > 0) {
                let file = input.path.display();
                return Err(RecordingError::Malformed {
                    path: input.path.to_owned(),
                    place: format!("with {}", journal.display()),
                    reason: "its recorder was stopped before it wrote all messages into the file".to_owned(),
                    remedy: format!(
                        "complete the file: sqlite3 \"{file}\" \"PRAGMA journal_mode=DELETE; SELECT count(*) FROM topics\""
                    ),
                });
            }
        }
        Ok(Self(input))
    }
}

impl Container for SqliteFile<'_> {
    fn kind(&self) -> &'static str {
        "SQLite"
    }

    fn path(&self) -> &Path {
        self.0.path
    }

    fn records<'a>(&'a self, scan: Scan<'a>) -> Result<Box<dyn Records + 'a>, RecordingError> {
        let file = self.0.rewound()?;
        let wanted = if let Scan::Messages(channels) = scan { Some(channels) } else { None };
        let opened = Database::open(file).and_then(|database| SqliteRecords::new(&database, wanted));
        opened.map(|records| Box::new(records) as Box<dyn Records + 'a>).map_err(|ending| {
            let reason = match ending {
                Ending::BreaksOff => "the file ends before its first message".to_owned(),
                Ending::Wrong(reason) => reason,
            };
            RecordingError::Malformed {
                path: self.0.path.to_owned(),
                place: "its tables".to_owned(),
                reason,
                remedy: "copy the file again; rosbag2 writes tables `topics` and `messages`".to_owned(),
            }
        })
    }
}

/// The rows of one table.
struct SqliteRecords<'a> {
    rows: Rows<'a>,
    /// Where the values are in a row: number, name, type and encoding of a topic; topic, time and bytes of a message.
    places: Vec<usize>,
    /// The topics whose messages are read, in ascending order; none where topics are read.
    wanted: Option<&'a [u64]>,
    /// The topic whose schema was handed out.
    described: Option<(u64, [String; 2])>,
}

impl<'a> SqliteRecords<'a> {
    fn new(database: &Database<'a>, wanted: Option<&'a [u64]>) -> Result<Self, Ending> {
        let (table, columns): (_, &[&str]) = match wanted {
            None => ("topics", &["id", "name", "type", "serialization_format"]),
            Some(_) => ("messages", &["topic_id", "timestamp", "data"]),
        };
        let lacking = |what: &str| Ending::Wrong(format!("it has no {what}, so it is not a bag of rosbag2"));
        let (root, known) = database.table(table)?.ok_or_else(|| lacking(&format!("table `{table}`")))?;
        let place = |name: &&str| {
            let place = known.iter().position(|column| column == name);
            place.ok_or_else(|| lacking(&format!("column `{name}` in its table `{table}`")))
        };
        let places = columns.iter().map(place).collect::<Result<_, _>>()?;
        Ok(Self { rows: database.rows(root), places, wanted, described: None })
    }
}

impl Records for SqliteRecords<'_> {
    fn next(&mut self, take: &mut dyn FnMut(Record<'_>)) -> Result<bool, Ending> {
        if let Some((id, [topic, encoding])) = self.described.take() {
            take(Record::Channel { id, schema: id, topic, encoding });
            return Ok(true);
        }
        if !self.rows.advance()? {
            return Ok(false);
        }
        let number = |value: Option<i64>| value.and_then(|v| u64::try_from(v).ok());
        let Some(wanted) = self.wanted else {
            self.rows.complete()?;
            let values = self.rows.values();
            let value = |k: usize| values.get(self.places[k]).copied().unwrap_or(Value::Other);
            let Some(id) = number(value(0).integer()) else { return Ok(true) };
            take(Record::Schema { id, name: name_of(value(2).bytes()) });
            self.described = Some((id, [name_of(value(1).bytes()), name_of(value(3).bytes())]));
            return Ok(true);
        };
        // Of other messages, which may be pictures, no more is read than stands beside their topic.
        let topic = self.rows.values().get(self.places[0]).and_then(|v| number(v.integer()));
        let Some(channel) = topic.filter(|topic| wanted.binary_search(topic).is_ok()) else {
            take(Record::Other);
            return Ok(true);
        };
        self.rows.complete()?;
        let values = self.rows.values();
        let value = |k: usize| values.get(self.places[k]).copied().unwrap_or(Value::Other);
        if let (Some(log_ns), Value::Bytes(data)) = (value(1).integer(), value(2)) {
            take(Record::Message { channel, log_ns, data });
        }
        Ok(true)
    }
}
