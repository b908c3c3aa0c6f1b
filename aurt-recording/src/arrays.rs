//! Files that hold arrays under names: one per quantity, one row or one column per sample.

use std::collections::HashMap;
use std::io::{self, Read};

use crate::csv::families::is_time_name;
use crate::csv::table::{MOST_COLUMNS, Table};
use crate::error::RecordingError;
use crate::format::Reading;
use crate::memory::Memory;
use crate::recorded_as::{ColumnRef, ColumnSelection};
use crate::recording::Recording;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Array {
    /// Its name; none where a file is one array.
    pub(crate) name: Option<String>,
    pub(crate) shape: Vec<usize>,
    /// Whether the first axis varies fastest.
    pub(crate) column_major: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Numbers {
    pub(crate) kind: Kind,
    pub(crate) bytes: usize,
    pub(crate) big_endian: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Float,
    Signed,
    Unsigned,
}

/// Loads arrays by their places in the list of arrays, in storage order.
pub(crate) type Load<'a> = &'a mut dyn FnMut(&[usize]) -> Result<HashMap<usize, Vec<f64>>, RecordingError>;

pub(crate) struct ArrayFile<'a> {
    pub(crate) memory: Memory<'a>,
    pub(crate) format: &'a str,
    pub(crate) arrays: Vec<Array>,
}

#[derive(Debug, Clone, Copy)]
struct Column {
    array: usize,
    first: usize,
    stride: usize,
}

impl Array {
    /// Its axes longer than one, at most two of them: samples and joints, in either order.
    fn axes(&self) -> Option<[usize; 2]> {
        let long: Vec<usize> = self.shape.iter().copied().filter(|n| *n != 1).collect();
        match long[..] {
            [] if self.shape.is_empty() => None,
            [] => Some([1, 1]),
            [n] => Some([n, 1]),
            [rows, columns] => Some([rows, columns]),
            _ => None,
        }
    }

    fn numbers(&self) -> usize {
        self.shape.iter().fold(1, |product, n| product.saturating_mul(*n))
    }

    fn described(&self) -> String {
        let shape: Vec<String> = self.shape.iter().map(usize::to_string).collect();
        format!("`{}` ({})", self.name.as_deref().unwrap_or("the array"), shape.join(" × "))
    }
}

impl ArrayFile<'_> {
    /// Reads the recording: finds out which axis is time, which arrays are needed, and loads those.
    pub(crate) fn read(self, reading: Reading<'_>, load: Load<'_>) -> Result<Recording, RecordingError> {
        let samples = self.samples(&reading.options.columns);
        let mut names = Vec::new();
        let mut columns = Vec::new();
        let mut unfit = Vec::new();
        for (place, array) in self.arrays.iter().enumerate() {
            let Some([rows, others]) = array.axes() else { continue };
            let (count, sample_first) = match samples {
                Some(n) if rows == n && others <= MOST_COLUMNS => (others, true),
                Some(n) if others == n && rows <= MOST_COLUMNS => (rows, false),
                _ => {
                    unfit.push(array.described());
                    continue;
                }
            };
            for column in 0..count {
                // The numbers of a column are neighbours if the axis of samples varies fastest.
                let together = sample_first == array.column_major;
                let (first, stride) =
                    if together { (column * samples.unwrap_or(0), 1) } else { (column, count) };
                columns.push(Column { array: place, first, stride });
                names.extend(array.name.as_ref().map(|n| match array.axes() {
                    Some([_, 1]) => n.clone(),
                    _ => format!("{n}_{column}"),
                }));
            }
        }
        let mut table = Table::new(self.memory, names, columns.len(), reading.options).map_err(|error| {
            let missing = matches!(error, RecordingError::MissingColumn { .. });
            if missing && !unfit.is_empty() { self.misfit(&unfit, samples) } else { error }
        })?;
        if !unfit.is_empty() {
            let samples = samples.unwrap_or(0);
            table.remark(format!(
                "not read, since they do not have one row or column for each of the {samples} samples, or have more than {MOST_COLUMNS} columns: {}",
                unfit.join(", ")
            ));
        }
        let wanted: Vec<Column> = table.wanted().into_iter().map(|c| columns[c]).collect();
        let mut needed: Vec<usize> = wanted.iter().map(|c| c.array).collect();
        needed.sort_unstable();
        needed.dedup();
        let numbers = needed.iter().fold(0_usize, |sum, k| sum.saturating_add(self.arrays[*k].numbers()));
        // The arrays, and the rows that are taken from them.
        let bytes = (numbers as u64).saturating_mul(16);
        self.memory.claim(&format!("the {numbers} numbers of its arrays"), bytes)?;
        let loaded = load(&needed)?;
        let series: Vec<(&[f64], Column)> =
            wanted.iter().map(|c| (loaded.get(&c.array).map_or(&[][..], Vec::as_slice), *c)).collect();
        let rows = samples.unwrap_or(0);
        let mut k = 0;
        table.read(self.format.to_owned(), reading, &mut |row| {
            if k == rows {
                return Ok(false);
            }
            for (value, (series, column)) in row.iter_mut().zip(&series) {
                *value = series.get(column.first + k * column.stride).copied().unwrap_or(f64::NAN);
            }
            k += 1;
            Ok(true)
        })
    }

    /// The number of samples: that of the time stamps, else the longest axis of all.
    fn samples(&self, columns: &ColumnSelection) -> Option<usize> {
        let selected = match &columns.time {
            Some(ColumnRef::Name(name)) => Some(name.trim().to_lowercase()),
            _ => None,
        };
        let holds_time = |array: &&Array| {
            let Some(name) = array.name.as_ref().map(|n| n.to_lowercase()) else { return false };
            selected.as_ref().map_or_else(|| is_time_name(&name), |selected| *selected == name)
        };
        let stamps = self.arrays.iter().filter(holds_time).find_map(|a| a.axes().filter(|x| x[1] == 1));
        stamps.map(|axes| axes[0]).or_else(|| self.arrays.iter().filter_map(Array::axes).flatten().max())
    }

    fn misfit(&self, unfit: &[String], samples: Option<usize>) -> RecordingError {
        RecordingError::Columns {
            path: self.memory.path().to_owned(),
            line: 0,
            reason: format!(
                "the time axis has {} samples, and no axis of {} has as many",
                samples.unwrap_or(0),
                unfit.join(", ")
            ),
            remedy: "save arrays with one row (or one column) for each time stamp, one array per quantity"
                .into(),
        }
    }
}

impl Numbers {
    /// Reads `count` numbers. Memory grows with what arrives, not with what a header claims.
    pub(crate) fn read(self, source: &mut impl Read, count: usize) -> io::Result<Vec<f64>> {
        const AT_ONCE: usize = 1 << 13;
        let mut values = Vec::with_capacity(count.min(AT_ONCE));
        let mut buffer = vec![0; AT_ONCE * self.bytes];
        let mut left = count;
        while left > 0 {
            let now = left.min(AT_ONCE);
            let bytes = &mut buffer[..now * self.bytes];
            source.read_exact(bytes)?;
            values.extend(bytes.chunks_exact(self.bytes).map(|b| self.value(b)));
            left -= now;
        }
        Ok(values)
    }

    fn value(self, bytes: &[u8]) -> f64 {
        let mut wide = [0; 8];
        for (place, byte) in bytes.iter().take(8).enumerate() {
            wide[if self.big_endian { self.bytes - 1 - place } else { place }] = *byte;
        }
        let bits = u64::from_le_bytes(wide);
        match (self.kind, self.bytes) {
            (Kind::Float, 4) => f64::from(f32::from_bits(bits as u32)),
            (Kind::Float, _) => f64::from_bits(bits),
            (Kind::Unsigned, _) => bits as f64,
            (Kind::Signed, bytes) => {
                let unused = 64 - 8 * bytes as u32;
                (((bits << unused) as i64) >> unused) as f64
            }
        }
    }
}
