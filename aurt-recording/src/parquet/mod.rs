//! Apache Parquet, the tables of pandas, Polars, Spark and LeRobot.
//!
//! The crate `parquet` decodes it; the sizes that footers and pages claim are bounded before it makes room for them.

mod column;
mod footer;

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

use parquet::file::metadata::ParquetMetaData;

use crate::csv::table::{MOST_COLUMNS, Table};
use crate::error::RecordingError;
use crate::format::{Reading, RecordingFormat, RecordingInput, unreadable};
use crate::memory::Memory;
use crate::parquet::column::{Column, Problem};
use crate::parquet::footer::{Leaf, Number, leaves};
use crate::read_options::ReadOptions;
use crate::recorded_as::TimeUnit;
use crate::recording::Recording;

const MAGIC: &[u8] = b"PAR1";
/// Memory that each byte of a footer may take once it is decoded.
const FOOTER_FACTOR: u64 = 64;
/// The column that LeRobot counts its episodes in.
const EPISODE: &str = "episode_index";
/// Time between two episodes; no filter reaches across it.
pub(crate) const BETWEEN_EPISODES_S: f64 = 10.0;

/// Parquet files: columns of numbers, one row per sample, or columns of lists with a number for each joint.
///
/// A column `q` of lists of 6 is `q_0` … `q_5`, as arrays are. Stamps that the file knows to be moments are turned into
/// seconds; those since 1970 count from the first whole second. Episodes of a LeRobot data set, whose stamps begin at zero
/// each, follow each other at a distance of 10 s. Pages are decoded one by one for each column that is needed:
/// uncompressed, Snappy, gzip, zstd, LZ4 (raw).
pub const PARQUET: RecordingFormat = RecordingFormat {
    name: "Parquet",
    endings: &["parquet"],
    recognises: |beginning| beginning.starts_with(MAGIC) || beginning.starts_with(b"PARE"),
    read: |input, reading| {
        let memory = Memory::of(input.path, input.bytes, reading.options);
        let metadata = footer(&input, memory)?;
        let file = input.rewound()?.try_clone().map_err(|source| unreadable(input.path, source))?;
        let options = reading.options;
        Reader { path: input.path, memory, file: Arc::new(file), options, metadata }.read(reading)
    },
};

fn footer(input: &RecordingInput<'_>, memory: Memory<'_>) -> Result<ParquetMetaData, RecordingError> {
    let refused =
        |reason: &str, remedy: &str| RecordingError::malformed(input.path, "its footer", reason, remedy);
    let cut = || {
        refused(
            "the file is truncated or not Parquet: its footer, which lists the columns, is missing",
            "copy or write the file again; for recordings that may be truncated use MCAP or CSV",
        )
    };
    if input.beginning.starts_with(b"PARE") {
        return Err(refused("the file is encrypted", "write it without encryption"));
    }
    let mut file = input.rewound()?;
    let unreadable = |source| unreadable(input.path, source);
    let end = file.seek(SeekFrom::End(0)).map_err(unreadable)?;
    let begin = end.checked_sub(8).ok_or_else(cut)?;
    file.seek(SeekFrom::Start(begin)).map_err(unreadable)?;
    let mut tail = [0; 8];
    file.read_exact(&mut tail).map_err(unreadable)?;
    let [length @ .., b'P', b'A', b'R', b'1'] = tail else { return Err(cut()) };
    let length = u64::from(u32::from_le_bytes(length));
    let begin = begin.checked_sub(length).ok_or_else(cut)?;
    memory.claim("its footer", FOOTER_FACTOR * length)?;
    file.seek(SeekFrom::Start(begin)).map_err(unreadable)?;
    let mut bytes = Vec::new();
    file.take(length).read_to_end(&mut bytes).map_err(unreadable)?;
    footer::decode(&bytes).ok_or_else(cut)
}

struct Reader<'a> {
    path: &'a Path,
    memory: Memory<'a>,
    file: Arc<File>,
    options: &'a ReadOptions,
    metadata: ParquetMetaData,
}

impl Reader<'_> {
    fn read(self, reading: Reading<'_>) -> Result<Recording, RecordingError> {
        let (leaves, others) = leaves(self.metadata.file_metadata().schema_descr());
        let (mut names, mut places, mut unfit) = (Vec::new(), Vec::new(), Vec::new());
        for (k, leaf) in leaves.iter().enumerate() {
            let width = if leaf.listed.is_some() { self.first_row(leaf)?.len() } else { 1 };
            if width > MOST_COLUMNS {
                unfit.push(format!("{} (lists of {width})", leaf.name));
                continue;
            }
            places.extend((0..width).map(|part| (k, part)));
            match leaf.listed {
                Some(_) if width != 1 => names.extend((0..width).map(|n| format!("{}_{n}", leaf.name))),
                _ => names.push(leaf.name.clone()),
            }
        }
        if names.is_empty() {
            let found = format!("none of its columns are numbers: {}", others.join(", "));
            return Err(RecordingError::NoRows { path: self.path.to_owned(), found });
        }
        let count = names.len();
        let mut table = Table::new(self.memory, names, count, self.options)?;
        let wanted: Vec<(usize, usize)> = table.wanted().iter().map(|column| places[*column]).collect();
        if !unfit.is_empty() {
            table.remark(format!("not read: {}", unfit.join(", ")));
        }
        let mut needed: Vec<usize> = wanted.iter().map(|(leaf, _)| *leaf).collect();
        needed.sort_unstable();
        needed.dedup();
        let time = table.time().map(|column| places[column].0);
        let (mut columns, open) = (Vec::new(), needed.len());
        let mut begins = vec![0; leaves.len()];
        let (mut row_width, mut origin_s) = (0, 0.0);
        for k in needed {
            let mut leaf = leaves[k].clone();
            let width = places.iter().filter(|(of, _)| *of == k).count();
            if time == Some(k) {
                origin_s = self.count_from_first_second(&mut leaf, &mut table)?;
            }
            begins[k] = row_width;
            row_width += width;
            columns.push((self.column(&leaf, Some(width)).among(open), width, leaf.name));
        }
        let mut episodes = self.episodes(&leaves, time.is_some());
        if episodes.is_some() {
            table.remark(format!(
                "episodes by `{EPISODE}` follow each other at a distance of {BETWEEN_EPISODES_S} s"
            ));
        }
        let rows = u64::try_from(self.metadata.file_metadata().num_rows()).unwrap_or(0);
        table.make_room(rows, reading.piece_rows)?;
        let (mut left, mut values) = (rows, vec![0.0; row_width]);
        let sources: Vec<usize> = wanted.iter().map(|(leaf, part)| begins[*leaf] + part).collect();
        let mut recording = table.read("Parquet".to_owned(), reading, &mut |row| {
            if left == 0 {
                return Ok(false);
            }
            left -= 1;
            let mut begin = 0;
            for (column, width, name) in &mut columns {
                column.next(&mut values[begin..begin + *width]).map_err(|p| self.failed(name, p))?;
                begin += *width;
            }
            for (value, source) in row.iter_mut().zip(&sources) {
                *value = values[*source];
            }
            if let (Some(episodes), Some(stamp)) = (&mut episodes, row.first_mut()) {
                episodes.place(stamp).map_err(|p| self.failed(EPISODE, p))?;
            }
            Ok(true)
        })?;
        recording.report.origin_s = origin_s;
        Ok(recording)
    }

    fn column(&self, leaf: &Leaf, width: Option<usize>) -> Column<'_> {
        Column::new(&self.file, self.memory, leaf, &self.metadata, width)
    }

    fn first_row(&self, leaf: &Leaf) -> Result<Vec<f64>, RecordingError> {
        self.column(leaf, None).first_row().map_err(|p| self.failed(&leaf.name, p))
    }

    /// Lets moments count from the first whole second, which is returned, so that they keep their nanoseconds.
    fn count_from_first_second(&self, leaf: &mut Leaf, table: &mut Table<'_>) -> Result<f64, RecordingError> {
        let Number::Stamp { per_second, .. } = leaf.number else { return Ok(0.0) };
        if self.options.recorded.time.is_some_and(|unit| unit != TimeUnit::Second) {
            return Err(RecordingError::Columns {
                path: self.path.to_owned(),
                line: 0,
                reason: format!("the file itself says in what unit the moments of `{}` are", leaf.name),
                remedy: "remove the key `time`".to_owned(),
            });
        }
        let begin = self.first_row(leaf)?;
        // Up to 2⁵³ ns all stamps are exact.
        let second =
            begin.first().copied().filter(|s| s.abs() * 1e9 > 9_007_199_254_740_992.0).map(f64::floor);
        if let Some(second) = second {
            leaf.number = Number::Stamp { per_second, origin: (second as i64).saturating_mul(per_second) };
            table.remark(format!("time starts at {second} s, so that stamps keep nanosecond resolution"));
        }
        Ok(second.unwrap_or(0.0))
    }

    fn episodes<'a>(&'a self, leaves: &[Leaf], timed: bool) -> Option<Episodes<'a>> {
        let scaled = self.options.recorded.time.is_some_and(|unit| unit != TimeUnit::Second);
        let leaf =
            leaves.iter().find(|l| l.name == EPISODE && l.listed.is_none()).filter(|_| timed && !scaled)?;
        let column = self.column(leaf, Some(1));
        Some(Episodes { column, current: None, shift_s: 0.0, last_s: 0.0 })
    }

    fn failed(&self, column: &str, problem: Problem) -> RecordingError {
        let (reason, remedy) = match problem {
            Problem::TooLarge(error) => return error,
            Problem::Damaged(reason) => (reason, "copy or write the file again"),
            Problem::Unknown(what) => (
                format!("it has {what}, which are not supported"),
                "write it as pandas does, with compression \"snappy\", \"gzip\" or \"zstd\"",
            ),
            Problem::Lengths { expected, found } => (
                format!("its first list has {expected} numbers, another has {found}"),
                "write lists with a number for each joint",
            ),
        };
        RecordingError::malformed(self.path, format!("column {column}"), reason, remedy)
    }
}

/// Episodes whose stamps begin again.
struct Episodes<'a> {
    column: Column<'a>,
    current: Option<u64>,
    shift_s: f64,
    last_s: f64,
}

impl Episodes<'_> {
    /// Moves a stamp to after the episodes before.
    fn place(&mut self, stamp_s: &mut f64) -> Result<(), Problem> {
        let mut episode = [0.0];
        self.column.next(&mut episode)?;
        let episode = episode[0].to_bits();
        if self.current.is_some_and(|current| current != episode) {
            self.shift_s = self.last_s + BETWEEN_EPISODES_S - *stamp_s;
        }
        self.current = Some(episode);
        if self.shift_s != 0.0 {
            *stamp_s += self.shift_s;
        }
        self.last_s = *stamp_s;
        Ok(())
    }
}
