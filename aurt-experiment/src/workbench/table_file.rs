//! Tables of numbers other than recordings: a header, and rows of exactly as many cells.

use std::path::{Path, PathBuf};

use aurt_files::{MOST_MODEL_BYTES, clipped, read_text};

use crate::workbench::failure::Failure;

/// A table that was read from a file; cells are parsed when they are asked for.
#[derive(Debug)]
pub struct TableFile {
    path: PathBuf,
    text: String,
    separator: Option<char>,
    remedy: &'static str,
    /// Line of the header, from 1.
    pub header_line: usize,
    pub names: Vec<String>,
}

#[derive(Debug)]
pub struct Row<'t> {
    table: &'t TableFile,
    /// Its line, from 1.
    pub line: usize,
    cells: Vec<&'t str>,
}

impl TableFile {
    /// Reads a table; `remedy` is what to do where it is not what is needed. Cells are separated by `;`, `,`, tabs or
    /// spaces, whichever the header has first in that order; lines that begin with `#` and blank ones are skipped.
    pub fn read(path: &Path, remedy: &'static str) -> Result<Self, Failure> {
        let refuse = |line, reason: String| {
            let path = path.to_owned();
            Failure::Table { path, line, cell: None, reason, remedy: remedy.to_owned() }
        };
        let text = read_text(path, MOST_MODEL_BYTES)
            .map_err(|error| refuse(None, format!("cannot be read: {error}")))?;
        let path = path.to_owned();
        let mut table = Self { path, text, separator: None, remedy, header_line: 1, names: Vec::new() };
        let Some((line, header)) = lines(&table.text).next() else {
            return Err(refuse(None, "is empty".into()));
        };
        table.header_line = line;
        table.separator = [';', ',', '\t'].into_iter().find(|c| header.contains(*c));
        let names: Vec<String> = table.cells(header).into_iter().map(str::to_owned).collect();
        let mut sorted: Vec<&String> = names.iter().collect();
        sorted.sort_unstable();
        if let Some(twice) = sorted.windows(2).find(|w| w[0] == w[1]) {
            return Err(refuse(Some(line), format!("two columns are called `{}`", clipped(twice[0]))));
        }
        table.names = names;
        Ok(table)
    }

    pub fn column(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }

    /// What is wrong, at a line and a cell of it, from 0, if it is at any.
    pub fn refuse(&self, line: Option<usize>, cell: Option<usize>, reason: String) -> Failure {
        let cell = cell.map(|cell| cell + 1);
        Failure::Table { path: self.path.clone(), line, cell, reason, remedy: self.remedy.to_owned() }
    }

    fn cells<'l>(&self, line: &'l str) -> Vec<&'l str> {
        match self.separator {
            Some(separator) => line.split(separator).map(str::trim).collect(),
            None => line.split_whitespace().collect(),
        }
    }

    pub fn rows(&self) -> impl Iterator<Item = Result<Row<'_>, Failure>> {
        lines(&self.text).skip(1).map(|(line, text)| {
            let cells = self.cells(text);
            if cells.len() == self.names.len() {
                return Ok(Row { table: self, line, cells });
            }
            let (found, expected) = (cells.len(), self.names.len());
            // `1,5` for 1.5 between commas is one cell too many.
            let reason = format!("the row has {found} cells, the header has {expected}");
            Err(self.refuse(Some(line), None, reason))
        })
    }
}

impl Row<'_> {
    /// The finite number in a column.
    pub fn number(&self, column: usize) -> Result<f64, Failure> {
        let cell = self.cells.get(column).copied().unwrap_or_default();
        let value = cell.parse::<f64>().ok().filter(|v| v.is_finite());
        value.ok_or_else(|| {
            let name = self.table.names.get(column).map(|n| clipped(n)).unwrap_or_default();
            let reason = format!("column `{name}`: `{}` is no finite number", clipped(cell));
            self.table.refuse(Some(self.line), Some(column), reason)
        })
    }
}

/// Lines that say something, with their numbers from 1.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let numbered = text.lines().enumerate().map(|(k, line)| (k + 1, line.trim()));
    numbered.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}
