use crate::csv::dialect::{Cells, Delimiter, Dialect, is_blank, parse_number, parse_prefix};

/// Reads the wanted cells of a line into a row of numbers.
///
/// It allocates nothing: the caller owns the row, so a file can be read in any order of storage, or streamed.
pub(super) struct RowParser {
    dialect: Dialect,
    /// For each column of the file its place in the row, if it is wanted.
    places: Vec<Option<usize>>,
    /// Places in the row from which on a cell may be no number.
    optional: usize,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RowProblem {
    /// Another number of cells than the file has columns.
    Count { found: usize },
    /// A wanted cell that is no finite number; its column from 0.
    Cell { column: usize },
}

impl RowParser {
    /// A parser for files of `columns` columns; `wanted[k]` is the column of the row's k-th number; the last
    /// `optional` of them may be none.
    pub(super) fn new(dialect: Dialect, columns: usize, wanted: &[usize], optional: usize) -> Self {
        let mut places = vec![None; columns];
        for (place, column) in wanted.iter().enumerate() {
            places[*column] = Some(place);
        }
        Self { dialect, places, optional: wanted.len() - optional }
    }

    pub(super) fn parse(&self, line: &[u8], row: &mut [f64]) -> Result<(), RowProblem> {
        if self.parse_plain(line, row).is_some() { Ok(()) } else { self.parse_carefully(line, row) }
    }

    /// The common case: nothing quoted, all cells plain numbers where they are wanted. `None` for all else.
    fn parse_plain(&self, line: &[u8], row: &mut [f64]) -> Option<()> {
        let spaces = self.dialect.delimiter == Delimiter::Spaces;
        let delimiter = self.dialect.delimiter.byte();
        let decimal = self.dialect.decimal();
        let mut rest = line;
        for (column, place) in self.places.iter().enumerate() {
            while let [b' ', tail @ ..] = rest {
                rest = tail;
            }
            if let Some(place) = place {
                let (value, length) = parse_prefix(rest, decimal)?;
                row[*place] = value;
                rest = &rest[length..];
            } else {
                let end = rest.iter().position(|b| *b == delimiter || *b == b'"' || spaces && is_blank(*b));
                rest = &rest[end.unwrap_or(rest.len())..];
            }
            while let [b' ', tail @ ..] = rest
                && !spaces
            {
                rest = tail;
            }
            let last = column + 1 == self.places.len();
            match rest {
                [] if last => return Some(()),
                [byte, tail @ ..] if !last && *byte == delimiter => rest = tail,
                _ => return None,
            }
        }
        None
    }

    fn parse_carefully(&self, line: &[u8], row: &mut [f64]) -> Result<(), RowProblem> {
        let mut found = 0;
        let mut bad = None;
        let mut last_is_empty = false;
        for cell in self.cells(line) {
            last_is_empty = cell.is_empty();
            if let Some(Some(place)) = self.places.get(found) {
                match parse_number(cell, self.dialect.decimal()).filter(|v| v.is_finite()) {
                    Some(value) => row[*place] = value,
                    None if *place >= self.optional => row[*place] = f64::NAN,
                    None => bad = bad.or(Some(found)),
                }
            }
            found += 1;
        }
        // A delimiter at the end of each line, after the last cell, is a habit of some programs.
        let expected = self.places.len();
        if found != expected && !(found == expected + 1 && last_is_empty) {
            return Err(RowProblem::Count { found });
        }
        bad.map_or(Ok(()), |column| Err(RowProblem::Cell { column }))
    }

    pub(super) fn cells<'a>(&self, line: &'a [u8]) -> Cells<'a> {
        self.dialect.cells(line)
    }
}
