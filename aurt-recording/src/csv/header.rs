use crate::csv::dialect::{Dialect, parse_number};

#[derive(Debug)]
pub(super) struct Header {
    /// Names as written, without quotes; empty if the file has no header line.
    pub(super) names: Vec<String>,
    pub(super) columns: usize,
    /// Line of the header, or of the first row if there is none; from 1.
    pub(super) line: usize,
    pub(super) is_data: bool,
}

impl Header {
    /// Takes `line` as a header unless all of its cells are numbers.
    ///
    /// `comment` is the text of a comment line just above it, which is the header of a file that has none of its
    /// own if it names as many columns as there are.
    pub(super) fn of(dialect: Dialect, line: &[u8], number: usize, comment: Option<&[u8]>) -> Self {
        let cells: Vec<&[u8]> = dialect.cells(line).collect();
        let is_number = |cell: &&[u8]| parse_number(cell, dialect.decimal()).is_some();
        let is_data = cells.iter().all(|c| is_number(c) || c.is_empty());
        let named: Option<Vec<&[u8]>> = match comment {
            _ if !is_data => Some(cells.clone()),
            Some(comment) => {
                let names: Vec<&[u8]> = dialect.cells(comment).collect();
                let fits = names.len() == cells.len() && !names.iter().any(|n| n.is_empty() || is_number(n));
                fits.then_some(names)
            }
            None => None,
        };
        let text = |cell: &&[u8]| String::from_utf8_lossy(cell).into_owned();
        Self {
            names: named.iter().flatten().map(text).collect(),
            columns: cells.len(),
            line: number,
            is_data,
        }
    }

    pub(super) fn named<'a>(&'a self, name: &'a str) -> impl Iterator<Item = usize> + 'a {
        let same = move |n: &String| n.trim().to_lowercase() == name.trim().to_lowercase();
        self.names.iter().enumerate().filter(move |(_, n)| same(n)).map(|(column, _)| column)
    }

    pub(super) fn name(&self, column: usize) -> String {
        self.names.get(column).cloned().unwrap_or_else(|| format!("column {column}"))
    }

    /// The names of some columns, shortened to the first and the last.
    pub(super) fn span(&self, columns: &[usize]) -> String {
        match columns {
            [] => "none".to_owned(),
            [only] => self.name(*only),
            [first, .., last] => format!("{} … {}", self.name(*first), self.name(*last)),
        }
    }
}
