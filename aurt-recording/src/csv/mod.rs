//! Text files with one row per sample.

mod clock;
mod collector;
mod columns;
mod dialect;
pub(crate) mod families;
mod header;
mod lines;
mod plausibility;
mod rows;
mod search;
pub(crate) mod table;

use std::io::Read;
use std::path::Path;

use crate::csv::collector::Collector;
use crate::csv::dialect::Dialect;
use crate::csv::header::Header;
use crate::csv::lines::{Line, Lines};
use crate::csv::rows::{RowParser, RowProblem};
use crate::csv::search::Search;
use crate::error::{LEAVE_OUT, RecordingError};
use crate::format::{BEGINNING_BYTES, Reading, RecordingFormat, RecordingInput, unreadable};
use crate::read_options::ReadOptions;
use crate::recording::{ReadReport, Recording};

/// Text files with one row per sample.
///
/// Positions that jump by whole turns between two rows are unwrapped. Rows with absurd values, single rows in which a
/// position leaps away and back, and stamps that go backwards are dropped and reported, up to a share of all rows.
///
/// Cells are separated by commas, semicolons, tabs or runs of spaces; which, whether decimals have commas, and
/// whether there is a header is found out. Blank lines and lines that start with `#` are skipped. Columns are known
/// by their usual names (`actual_q_0`, `q1`, `tau[3]`, …; numbered from 0 or 1) or selected in the options. Columns
/// that are not read may hold anything.
///
/// If the file has both motor currents and joint torques, the unit in the options decides; without it that is an error
/// where a measurement is needed, and otherwise neither is read.
///
/// Errors are columns that are missing or ambiguous; a cell that is needed and no finite number, a line with too few or
/// too many cells, a last line that breaks off; more corrupt rows than `max_corrupt_share`. Each names file, line, column
/// and remedy.
pub const CSV: RecordingFormat = RecordingFormat {
    name: "CSV",
    endings: &["csv", "tsv", "txt", "dat"],
    // Text has no signature; it is what remains when no other format recognises a file.
    recognises: |_| false,
    read: |input, reading| Reader { path: input.path, options: reading.options }.read(&input, reading),
};

struct Reader<'a> {
    path: &'a Path,
    options: &'a ReadOptions,
}

impl Reader<'_> {
    fn read(&self, input: &RecordingInput<'_>, reading: Reading<'_>) -> Result<Recording, RecordingError> {
        let Reading { piece_rows, visit, .. } = reading;
        let sample = input.beginning.as_slice();
        if sample.starts_with(&[0xff, 0xfe]) || sample.starts_with(&[0xfe, 0xff]) {
            return Err(self.no_rows("it is UTF-16 text; save it as UTF-8"));
        }
        if sample.starts_with(&[0x1f, 0x8b]) {
            return Err(self.no_rows("it is compressed with gzip; unpack it first, with gunzip"));
        }
        if sample.contains(&0) {
            return Err(self.no_rows("it is a binary file of no known format; recordings are read from text (CSV), .npy, .npz, .mat, .mcap and .parquet"));
        }
        if !sample.contains(&b'\n') && sample.contains(&b'\r') {
            return Err(self.no_rows("its lines end in bare carriage returns; save it with line feeds"));
        }
        let content = content_lines(sample);
        let dialect = Dialect::detect(&content);
        let mut lines = Lines::new(input.reader());
        let Some((header, first)) = self.header(dialect, &mut lines)? else {
            let found = if sample.is_empty() { "it is empty" } else { "only blank lines and comments" };
            return Err(self.no_rows(found));
        };
        let selected = Search { path: self.path, header: &header, options: self.options }.run()?;
        let wanted = selected.all();
        let parser = RowParser::new(dialect, header.columns, &wanted, selected.branches.len());
        let mean_length = sample.len().div_ceil(content.len().max(1)).max(1);
        let rows = (input.bytes as usize / mean_length).min(piece_rows);
        let mut collector = Collector::new(&selected, self.options, rows);
        let mut row = vec![0.0; wanted.len() + usize::from(selected.time.is_none())];
        let decimals =
            wanted.contains(&(header.columns - 1)).then(|| fixed_decimals(dialect, &content)).flatten();
        if header.is_data {
            let line = Line { number: header.line, bytes: &first, terminated: true };
            self.take(&parser, &header, &line, &mut row, &mut collector)?;
        }
        while let Some(line) = lines.next().map_err(|e| self.unreadable(e))? {
            if !is_content(line.bytes) {
                continue;
            }
            self.take(&parser, &header, &line, &mut row, &mut collector)?;
            if collector.held() >= piece_rows {
                if self.options.is_running {
                    collector.judge_latest(self.path, &header, self.options.max_corrupt_share)?;
                }
                visit(&selected.recording(self.path, collector.piece(false), ReadReport::default()))?;
            }
            if let Some(reason) =
                decimals.filter(|_| !line.terminated).and_then(|d| cut_off(dialect, line.bytes, d))
            {
                let path = self.path.to_owned();
                return Err(RecordingError::TruncatedLastLine { path, line: line.number, reason });
            }
        }
        if collector.rows() == 0 {
            return Err(self.no_rows("there is a header, but no row follows"));
        }
        let named = if header.names.is_empty() { "without header" } else { "with header" };
        let format = format!("{}, {named}", dialect.in_words());
        collector.finish(self.path, &header, format, self.options.max_corrupt_share)
    }

    fn header(
        &self,
        dialect: Dialect,
        lines: &mut Lines<impl Read>,
    ) -> Result<Option<(Header, Vec<u8>)>, RecordingError> {
        let mut comment: Option<Vec<u8>> = None;
        while let Some(line) = lines.next().map_err(|e| self.unreadable(e))? {
            let bytes = without_mark(line.bytes, line.number);
            if is_content(bytes) {
                let header = Header::of(dialect, bytes, line.number, comment.as_deref());
                return Ok(Some((header, bytes.to_vec())));
            }
            comment = bytes.trim_ascii().strip_prefix(b"#").map(|c| c.trim_ascii().to_vec());
        }
        Ok(None)
    }

    fn take(
        &self,
        parser: &RowParser,
        header: &Header,
        line: &Line<'_>,
        row: &mut [f64],
        collector: &mut Collector<'_>,
    ) -> Result<(), RecordingError> {
        let Err(problem) = parser.parse(line.bytes, &mut row[collector.first_read()..]) else {
            collector.add(row, line.number);
            return Ok(());
        };
        let path = self.path.to_owned();
        let number = line.number;
        match problem {
            RowProblem::Count { found } if found < header.columns && !line.terminated => {
                let reason = format!("{found} cells of {}", header.columns);
                Err(RecordingError::TruncatedLastLine { path, line: number, reason })
            }
            RowProblem::Count { found } => {
                let remedy = if found == 1 {
                    "all lines must be separated alike; correct or delete the line"
                } else {
                    "correct or delete the line"
                };
                let remedy = remedy.to_owned();
                Err(RecordingError::Ragged { path, line: number, expected: header.columns, found, remedy })
            }
            RowProblem::Cell { column } => {
                let cell = parser.cells(line.bytes).nth(column).unwrap_or_default();
                let text: String = String::from_utf8_lossy(cell).chars().take(40).collect();
                let skips = self.options.recorded.drops_rows() || self.options.is_running && line.terminated;
                if skips && is_no_number(&text) {
                    collector.skip(number, column);
                    return Ok(());
                }
                if !line.terminated && column + 1 == header.columns {
                    let reason = format!("its last cell is `{text}`");
                    return Err(RecordingError::TruncatedLastLine { path, line: number, reason });
                }
                let remedy = remedy_for(&text);
                let name = header.names.get(column).cloned();
                let counts = is_no_number(&text);
                let error = RecordingError::Cell {
                    path,
                    line: number,
                    column: column + 1,
                    name,
                    text,
                    rows: 1,
                    remedy,
                };
                // How many rows there are of the kind says what to do about them.
                if counts { collector.refuse(error) } else { Err(error) }
            }
        }
    }

    fn unreadable(&self, source: std::io::Error) -> RecordingError {
        unreadable(self.path, source)
    }

    fn no_rows(&self, found: &str) -> RecordingError {
        RecordingError::NoRows { path: self.path.to_owned(), found: found.to_owned() }
    }
}

fn is_no_number(text: &str) -> bool {
    let lower = text.trim().to_lowercase();
    ["", "nan", "inf", "infinity", "null", "none", "na"].contains(&lower.trim_start_matches(['-', '+']))
}

/// What to do about a cell that is no number.
fn remedy_for(text: &str) -> &'static str {
    if is_no_number(text) {
        LEAVE_OUT
    } else if text.contains(',') {
        "numbers need a decimal point, or decimal commas throughout and semicolons between cells"
    } else if text.contains('.') && text.starts_with(|c: char| c.is_ascii_digit() || c == '-') {
        "the file's decimal sign is a comma, or the number is garbled: write all numbers alike"
    } else {
        "correct the cell, delete the row, or select another column"
    }
}

fn is_content(line: &[u8]) -> bool {
    line.trim_ascii_start().first().is_some_and(|b| *b != b'#')
}

/// The line without a UTF-8 byte order mark, which only the first may have.
fn without_mark(line: &[u8], number: usize) -> &[u8] {
    const MARK: &[u8] = b"\xef\xbb\xbf";
    if number == 1 { line.strip_prefix(MARK).unwrap_or(line) } else { line }
}

/// The lines of a sample of a file that hold cells; the last one may be cut by the sample's end and is left out
/// unless it is the only one.
fn content_lines(sample: &[u8]) -> Vec<&[u8]> {
    let mut lines: Vec<&[u8]> = sample
        .split(|b| *b == b'\n')
        .enumerate()
        .map(|(k, line)| without_mark(line.strip_suffix(b"\r").unwrap_or(line), k + 1))
        .filter(|line| is_content(line))
        .collect();
    if lines.len() > 1 && sample.len() == BEGINNING_BYTES {
        lines.pop();
    }
    lines
}

/// The number of decimals of the last cell of a line, if it is a plain decimal number.
fn decimals(dialect: Dialect, line: &[u8]) -> Option<usize> {
    let cell = dialect.cells(line).last()?;
    let point = cell.iter().position(|b| *b == dialect.decimal())?;
    let digits = &cell[point + 1..];
    digits.iter().all(u8::is_ascii_digit).then_some(digits.len())
}

/// The number of decimals that all last cells have, if they have the same.
fn fixed_decimals(dialect: Dialect, content: &[&[u8]]) -> Option<usize> {
    const LINES: usize = 50;
    // The header, and the very last line, which may be the one that breaks off.
    let rows = content.get(1..content.len().saturating_sub(1))?;
    let mut counts = rows.iter().take(LINES).map(|line| decimals(dialect, line));
    let first = counts.next().flatten()?;
    (rows.len() > 2 && counts.all(|c| c == Some(first))).then_some(first)
}

/// How it shows that a last line without line feed breaks off within its last number, if it does.
fn cut_off(dialect: Dialect, line: &[u8], usual: usize) -> Option<String> {
    let found = decimals(dialect, line).unwrap_or(0);
    (found < usual).then(|| format!("its last number has {found} decimals, others have {usual}"))
}
