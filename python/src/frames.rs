//! Recordings in data frames.
//!
//! What a column is, is told by its name, by the rules for files: a frame is written as a table and read as one.

use std::fmt::Write;
use std::fs;

use aurt_recording::{ColumnRef, ReadOptions, Recording, TimeUnit, is_time_name, read_recording};
use pyo3::prelude::*;

use crate::arrays::vector;
use crate::error::{raised, refused};

/// Whether something is a data frame: it has columns.
pub fn is_frame(given: &Bound<'_, PyAny>) -> PyResult<bool> {
    Ok(given.hasattr("columns")? && given.hasattr("shape")?)
}

/// The recording in a frame.
///
/// # Errors
/// As of a file; lines count from 1 with the header, so that row k of the frame is line k + 2.
pub fn read(frame: &Bound<'_, PyAny>, options: &ReadOptions, name: &str) -> PyResult<Recording> {
    let py = frame.py();
    let mut columns: Vec<Column<'_>> =
        py.import("aurt._plain")?.call_method1("columns", (frame,))?.extract()?;
    // An index of dates without a name is the clock where no column is.
    if columns.first().is_some_and(|(name, ..)| name.is_empty()) {
        if columns.iter().any(|(name, ..)| is_time_name(name)) {
            columns.remove(0);
        } else {
            "time".clone_into(&mut columns[0].0);
        }
    }
    let (options, origin_s) = dated(&columns, options)?;
    let mut numbers = Vec::new();
    for (name, values, _) in &columns {
        numbers.push(vector(&format!("the column `{name}`"), values)?);
    }
    let header: Vec<String> = columns.iter().map(|(name, ..)| quoted(name)).collect();
    let text = || {
        let mut text = header.join(",") + "\n";
        for row in 0..numbers.first().map_or(0, Vec::len) {
            for (k, column) in numbers.iter().enumerate() {
                let comma = if k == 0 { "" } else { "," };
                // Rust writes a number with as many digits as it takes to read the same number.
                let _ = write!(text, "{comma}{}", column[row]);
            }
            text.push('\n');
        }
        text
    };
    let text = py.detach(text);
    let failed = |error: std::io::Error| refused(format!("the table of the frame cannot be kept: {error}"));
    let folder = tempfile::tempdir().map_err(failed)?;
    let path = folder.path().join(file_name(name));
    fs::write(&path, text).map_err(failed)?;
    let read = py.detach(|| read_recording(&path, &options));
    let mut recording = read.map_err(|error| {
        // Messages name the frame, not the table that it was for a moment.
        let message = raised(error).value(py).to_string();
        refused(message.replace(&path.display().to_string(), name))
    })?;
    recording.report.origin_s += origin_s;
    Ok(recording.named(name))
}

/// Name, numbers, and, of dates and durations, which are in s, what they count from, s from 1970.
type Column<'py> = (String, Bound<'py, PyAny>, Option<f64>);

/// The options for a frame in which the clock may be dates or durations, and what these count from.
fn dated(columns: &[Column<'_>], options: &ReadOptions) -> PyResult<(ReadOptions, f64)> {
    let mut options = options.clone();
    let place = match &options.columns.time {
        Some(ColumnRef::Index(index)) => Some(*index),
        Some(ColumnRef::Name(wanted)) => columns.iter().position(|(name, ..)| name == wanted),
        None => columns.iter().position(|(name, _, origin_s)| origin_s.is_some() && is_time_name(name)),
    };
    let found = place.and_then(|place| Some((place, columns.get(place)?)));
    let Some((place, (name, _, Some(origin_s)))) = found else { return Ok((options, 0.0)) };
    if options.recorded.time.is_some_and(|unit| unit != TimeUnit::Second) {
        return Err(refused(format!(
            "the column `{name}` holds dates or durations, whose unit is known; leave out the argument time"
        )));
    }
    options.columns.time = Some(ColumnRef::Index(place));
    options.recorded.time = Some(TimeUnit::Second);
    Ok((options, *origin_s))
}

/// A name as a cell of a header.
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r', ';', '\t', ' ']) {
        format!("\"{}\"", name.replace('"', "\"\"").replace(['\n', '\r'], " "))
    } else {
        name.to_owned()
    }
}

/// A name that can be a file's.
fn file_name(name: &str) -> String {
    let plain: String = name
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() || matches!(c, '-' | '_') { c } else { '_' })
        .collect();
    format!("{plain}.csv")
}
