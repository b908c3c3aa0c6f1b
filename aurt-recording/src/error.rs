use std::path::{Path, PathBuf};

use aurt_files::suggestion::likely;
use thiserror::Error;

/// What can be wrong with a recording or with a request to it.
///
/// Lines and columns count from 1 in messages, as editors do; fields that end in `index` count from 0.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum RecordingError {
    #[error("{path}: {remedy}")]
    Unreadable {
        path: PathBuf,
        remedy: &'static str,
        #[source]
        source: std::io::Error,
    },
    #[error("{path} is a directory, not a recording; {remedy}", remedy = in_folder(path, inside))]
    Directory { path: PathBuf, inside: Vec<String> },
    #[error("{path} has no data rows ({found}); a recording has a header line and one row per sample")]
    NoRows { path: PathBuf, found: String },
    #[error(
        "{path}{at}: there is no header{row}, so the {columns} columns have no names; \
         say which is which, counting from 0, e.g. columns = {{ time = 0, position = [1, 6], measurement = [13, 18] }}",
        at = at(*line),
        row = if *line == 0 { "" } else { " line" }
    )]
    Headerless { path: PathBuf, line: usize, columns: usize },
    #[error(
        "{path}{at}: no column for {what}{wanted}; the file has {known}{likely}",
        at = at(*line),
        wanted = wanted.as_ref().map(|w| format!(" (`{w}`)")).unwrap_or_default(),
        known = list(known),
        likely = likely.as_ref().map(|l| format!("; {l}")).unwrap_or_default()
    )]
    MissingColumn {
        path: PathBuf,
        line: usize,
        /// The quantity, e.g. "joint positions".
        what: &'static str,
        wanted: Option<String>,
        known: Vec<String>,
        likely: Option<String>,
    },
    #[error(
        "{path}: column {index} (counting from 0) was selected for {what}, but the file has {columns} columns, 0 to {last}", last = columns - 1
    )]
    ColumnIndex {
        path: PathBuf,
        what: &'static str,
        /// The column asked for, from 0.
        index: usize,
        columns: usize,
    },
    /// Columns that do not fit together: holes in a numbering, different joint counts, doubled names.
    #[error("{path}{at}: {reason}; {remedy}", at = at(*line))]
    Columns { path: PathBuf, line: usize, reason: String, remedy: String },
    #[error(
        "{path}: the recording has the joints {recorded}; wanted are {wanted}, and {lacking} of them; {remedy}say which of the \
         recording's joints are the robot's, in the robot's order: joint_names = […] in an experiment, --joint-names on the command \
         line",
        recorded = recorded.join(", "),
        wanted = wanted.join(", "),
        lacking = counted(lacking, recorded),
        remedy = part_or_meant(lacking, recorded, wanted)
    )]
    JointNames {
        path: PathBuf,
        recorded: Vec<String>,
        /// The names that are looked for: the robot's, or those that were stated.
        wanted: Vec<String>,
        /// Those of them that are not there, or there twice.
        lacking: Vec<String>,
    },
    #[error("{path}: {reason}; {remedy}")]
    Unit { path: PathBuf, reason: String, remedy: String },
    #[error(
        "{path}, line {line}, column {column}{name}: {cell}{others}; {remedy}",
        cell = cell(text),
        name = name.as_ref().map(|n| format!(" ({n})")).unwrap_or_default(),
        others = others(*rows)
    )]
    Cell {
        path: PathBuf,
        line: usize,
        column: usize,
        name: Option<String>,
        /// The cell, shortened.
        text: String,
        /// Rows that have such a cell, this one included.
        rows: usize,
        remedy: &'static str,
    },
    #[error(
        "{path}, row {row}: {name} is {value}{others}; {leave_out}, or select another column",
        others = others(*rows),
        leave_out = LEAVE_OUT
    )]
    Value { path: PathBuf, row: usize, name: String, value: f64, rows: usize },
    #[error("{path} with {other}: {reason}; {remedy}", other = other.display())]
    Joined { path: PathBuf, other: PathBuf, reason: String, remedy: String },
    #[error(
        "{path}: {what} would take {needed} MB of memory, and {allowed} MB are allowed for a file of this size (20 times its size \
         and 200 MB); split the recording, or write it as CSV or MCAP and read it in pieces (--stream-above 0)", needed = megabytes(*needed_bytes), allowed = megabytes(*allowed_bytes)
    )]
    TooLarge { path: PathBuf, what: String, needed_bytes: u64, allowed_bytes: u64 },
    /// A file that is not what its format says.
    #[error("{path}, {place}: {reason}; {remedy}")]
    Malformed {
        path: PathBuf,
        /// Where in it: an array, a topic, a message.
        place: String,
        reason: String,
        remedy: String,
    },
    #[error("{path}, line {line}: {found} cells where the file has {expected}; {remedy}")]
    Ragged { path: PathBuf, line: usize, expected: usize, found: usize, remedy: String },
    #[error(
        "{path}, line {line}: the last line breaks off ({reason}); the recording was probably cut while it was written: \
         delete that line"
    )]
    TruncatedLastLine { path: PathBuf, line: usize, reason: String },
    #[error(
        "{path}, {place}: {reason}; {rows} of {total} rows are like this, and at most {allowed} may be \
         dropped ({max_percent} %): repair the file, delete these rows, or cut the recording with a window that leaves them out",
        max_percent = 100.0 * max_share,
        place = if *column == 0 { format!("row {line}") } else { format!("line {line}, column {column}") }
    )]
    CorruptRows {
        path: PathBuf,
        /// Line of the first corrupt row, from 1; in files that are no text its row.
        line: usize,
        /// Its column, from 1; 0 in files that are no text.
        column: usize,
        reason: String,
        rows: usize,
        total: usize,
        allowed: usize,
        max_share: f64,
    },
    /// A value in a recording that was not read from a file.
    #[error("{path}: {reason}; remove such samples first")]
    Sample { path: PathBuf, reason: String },
    #[error(
        "{path}: the window {from_s} s to {to_s} s {reason}; the recording lasts from 0 to {duration_s:.3} s"
    )]
    Window { path: PathBuf, from_s: f64, to_s: f64, reason: &'static str, duration_s: f64 },
    #[error("`{option}` = {value:?}: {remedy}")]
    InvalidOption { option: &'static str, value: f64, remedy: &'static str },
    #[error("{what}: expected {expected}, got {found}")]
    Count { what: String, expected: usize, found: usize },
    #[error("a Butterworth low-pass of order {order}: the order must lie between 1 and 12")]
    FilterOrder { order: usize },
    #[error(
        "a low-pass cut-off of {cutoff_hz} Hz at a sampling rate of {rate_hz} Hz: it must lie between 0.0001 and 0.9999 of half the rate"
    )]
    Cutoff { cutoff_hz: f64, rate_hz: f64 },
    #[error(
        "{path}: the {which} cut-off of {cutoff_hz} Hz is not below half the sampling rate ({rate} Hz / 2); {remedy}",
        rate = (rate_hz * 1e3).round() / 1e3
    )]
    AboveNyquist {
        path: PathBuf,
        which: &'static str,
        cutoff_hz: f64,
        rate_hz: f64,
        largest_f_dyn_hz: f64,
        remedy: String,
    },
    #[error("{samples} samples are too few to filter: the filter needs at least {needed}")]
    TooShortToFilter { samples: usize, needed: usize },
    #[error("{path}: {samples} samples{after} are too few: at least {needed} are needed; {remedy}")]
    TooShort {
        path: PathBuf,
        samples: usize,
        needed: usize,
        /// After which step, e.g. " after cutting the rest".
        after: &'static str,
        remedy: String,
    },
    #[error(
        "{path}: no joint moves faster than {threshold_rad_s} rad/s (fastest: joint {joint} with {fastest_rad_s:.3e} rad/s), \
         so nothing remains after rest is removed; record a motion, or lower rest_velocity_rad_s"
    )]
    AtRest { path: PathBuf, threshold_rad_s: f64, joint: usize, fastest_rad_s: f64 },
    #[error(
        "{path}: the temporary file for its samples fails; it lies in the folder for temporary files (TMPDIR) and takes \
         8 bytes a number"
    )]
    Spill {
        path: PathBuf,
        #[source]
        source: std::io::Error,
    },
    #[error("{path}: {reason}; {remedy}")]
    Clock { path: PathBuf, reason: String, remedy: String },
}

impl RecordingError {
    pub(crate) fn count(what: impl Into<String>, expected: usize, found: usize) -> Self {
        Self::Count { what: what.into(), expected, found }
    }

    pub(crate) const fn option(option: &'static str, value: f64, remedy: &'static str) -> Self {
        Self::InvalidOption { option, value, remedy }
    }

    pub(crate) fn malformed(
        path: &Path,
        place: impl Into<String>,
        reason: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        let (path, place) = (path.to_owned(), place.into());
        Self::Malformed { path, place, reason: reason.into(), remedy: remedy.into() }
    }

    pub(crate) fn clock(path: &Path, reason: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Clock { path: path.to_owned(), reason: reason.into(), remedy: remedy.into() }
    }
}

/// Names in a row, the list and each name shortened.
fn list(names: &[String]) -> String {
    const SHOWN: usize = 20;
    const LENGTH: usize = 40;
    if names.is_empty() {
        return "no named columns".to_owned();
    }
    let short = |name: &String| name.chars().take(LENGTH).collect::<String>();
    let mut text = names.iter().take(SHOWN).map(short).collect::<Vec<_>>().join(", ");
    if names.len() > SHOWN {
        text.push_str(&format!(" and {} more", names.len() - SHOWN));
    }
    text
}

/// Bytes in MB, rounded up.
const fn megabytes(bytes: u64) -> u64 {
    bytes.div_ceil(1_000_000)
}

/// The place of a header; files that are no text have none (line 0).
fn at(line: usize) -> String {
    if line == 0 { String::new() } else { format!(", line {line}") }
}

fn in_folder(folder: &Path, inside: &[String]) -> String {
    match inside {
        [] => "name a file in it (or the folder of a LeRobot data set, which has meta/info.json)".into(),
        [one] => format!("name the recording in it: {}", folder.join(one).display()),
        [first, ..] => {
            let first = folder.join(first);
            format!("name one of the {} recordings in it, e.g. {}", inside.len(), first.display())
        }
    }
}

/// "`a`, `b` are none", of the names that a recording lacks or has twice.
fn counted(lacking: &[String], recorded: &[String]) -> String {
    let verb = if lacking.len() == 1 { "is" } else { "are" };
    let number = if lacking.iter().any(|name| recorded.contains(name)) { "two" } else { "none" };
    format!("`{}` {verb} {number}", lacking.join("`, `"))
}

/// The name that was meant, or, where the recording has some of the joints, that a part of the robot can be chosen.
fn part_or_meant(lacking: &[String], recorded: &[String], wanted: &[String]) -> String {
    let free = || recorded.iter().filter(|name| !wanted.contains(name)).map(String::as_str);
    if let Some(name) = lacking.iter().find_map(|lacking| likely(lacking, free())) {
        return format!("did you mean `{name}`? ");
    }
    if wanted.iter().all(|name| lacking.contains(name)) {
        return String::new();
    }
    "if they are of a part of the robot that was not recorded, choose the part that was: `tip`, `tips` or `joints` in `[robot]`, \
     --tip or --tips on the command line; else "
        .to_owned()
}

/// The way to read a file some of whose rows lack a number.
pub(crate) const LEAVE_OUT: &str =
    "write drop = \"nan\" in [recordings] to leave such rows out, or correct them";

fn cell(text: &str) -> String {
    if text.is_empty() { "the cell is empty".to_owned() } else { format!("`{text}` is not a finite number") }
}

/// How many rows beside the first have the same problem.
fn others(rows: usize) -> String {
    match rows.saturating_sub(1) {
        0 => String::new(),
        1 => ", and 1 more row has such a cell".to_owned(),
        n => format!(", and {n} more rows have such cells"),
    }
}
