//! The line of a file that a problem is about.

use std::borrow::Cow;
use std::io::{BufRead, BufReader, Read};
use std::ops::Range;
use std::path::Path;

/// Characters shown on either side of the place, where a line is longer than fits.
const CONTEXT: usize = 36;

/// Longest text that is shown without being cropped around the place, bytes.
const LONGEST_SHOWN: usize = 2000;
const LONGEST_LINE: u64 = 1 << 22;

/// A piece of a text file with a part of it to be underlined.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Excerpt {
    pub name: String,
    pub text: String,
    /// Line of the file on which the piece begins, from 1.
    pub first_line: usize,
    /// The part to be underlined, in bytes of the piece.
    pub span: Range<usize>,
}

impl Excerpt {
    /// The lines of a whole text in which its part `span` stands.
    pub fn of_text(path: &Path, text: &str, span: Range<usize>) -> Self {
        let end = span.end.min(text.len());
        let start = span.start.min(end);
        let from = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let to = text[end..].find('\n').map_or(text.len(), |at| end + at);
        let line = text[..from].matches('\n').count() + 1;
        if to - from > LONGEST_SHOWN {
            return Self::cropped(path, line, &text[from..to], start - from..end - from);
        }
        Self {
            name: path.display().to_string(),
            text: text[from..to].to_owned(),
            first_line: line,
            span: start - from..end - from,
        }
    }

    /// Control characters replaced one by one, so that the underlined part stays where it is in characters.
    pub fn harmless(self) -> Self {
        if matches!(aurt_files::harmless(&self.text), Cow::Borrowed(_)) {
            return self;
        }
        let replaced = |text: &str| -> String {
            text.chars().map(|c| if aurt_files::is_harmful(c) { '\u{fffd}' } else { c }).collect()
        };
        let (before, marked) = (&self.text[..self.span.start], &self.text[self.span.clone()]);
        let (before, marked, after) =
            (replaced(before), replaced(marked), replaced(&self.text[self.span.end..]));
        let span = before.len()..before.len() + marked.len();
        Self { text: before + &marked + &after, span, ..self }
    }

    /// A cell of a line of a table, or the whole line; `None` if it cannot be read again.
    pub fn of_line(path: &Path, line: usize, cell: Option<usize>) -> Option<Self> {
        let text = read_line(path, line)?;
        let span = match cell {
            Some(number) => cell_span(&text, number)?,
            None => 0..text.trim_end().len(),
        };
        Some(Self::cropped(path, line, &text, span))
    }

    /// The character at a line and column; `None` if there is none.
    pub fn of_place(path: &Path, line: usize, column: usize) -> Option<Self> {
        let text = read_line(path, line)?;
        let start = text.char_indices().nth(column.saturating_sub(1)).map_or(text.len(), |(at, _)| at);
        let end = text[start..].chars().next().map_or(start, |c| start + c.len_utf8());
        Some(Self::cropped(path, line, &text, start..end))
    }

    /// Rows of recordings are longer than a terminal is wide: keeps what is near the place.
    fn cropped(path: &Path, line: usize, text: &str, span: Range<usize>) -> Self {
        let from = text[..span.start].char_indices().rev().nth(CONTEXT).map_or(0, |(at, _)| at);
        let shown_end = text[span.start..]
            .char_indices()
            .nth(2 * CONTEXT)
            .map_or(span.end, |(at, _)| span.end.min(span.start + at));
        let to = text[shown_end..].char_indices().nth(CONTEXT).map_or(text.len(), |(at, _)| shown_end + at);
        let (left, right) = (if from > 0 { "…" } else { "" }, if to < text.len() { "…" } else { "" });
        let shift = |at: usize| at - from + left.len();
        Self {
            name: path.display().to_string(),
            text: format!("{left}{}{right}", &text[from..to]),
            first_line: line,
            span: shift(span.start)..shift(shown_end),
        }
    }
}

fn read_line(path: &Path, line: usize) -> Option<String> {
    // A pipe cannot be read again.
    let mut reader = BufReader::new(aurt_files::open_regular(path).ok()?);
    let mut bytes = Vec::new();
    for _ in 0..line {
        bytes.clear();
        let read = reader.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut bytes).ok()?;
        if read == 0 || read as u64 == LONGEST_LINE {
            return None;
        }
    }
    let text = String::from_utf8_lossy(&bytes);
    Some(text.trim_end_matches(['\n', '\r']).replace('\t', " "))
}

/// Where the cell of that number, from 1, stands.
fn cell_span(text: &str, number: usize) -> Option<Range<usize>> {
    let separator = [';', ','].into_iter().find(|c| text.contains(*c));
    let is_separator = |c: char| separator.map_or(c.is_whitespace(), |s| c == s);
    let mut cells = Vec::new();
    let mut start = 0;
    for (at, c) in text.char_indices().chain([(text.len(), separator.unwrap_or(' '))]) {
        if is_separator(c) {
            // Runs of spaces separate once; between two commas there is an empty cell.
            if separator.is_some() || at > start {
                cells.push(start..at);
            }
            start = at + c.len_utf8();
        }
    }
    let cell = cells.get(number.checked_sub(1)?)?.clone();
    let inner = &text[cell.clone()];
    let lead = inner.len() - inner.trim_start().len();
    Some(cell.start + lead..(cell.start + lead + inner.trim().len()))
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    fn excerpt(line: &str, number: usize) -> String {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        write!(file, "a,b\n{line}\n1,2\n").unwrap();
        let excerpt = Excerpt::of_line(file.path(), 2, Some(number)).unwrap();
        assert_eq!(excerpt.first_line, 2);
        assert!(excerpt.text.chars().count() <= 150);
        excerpt.text[excerpt.span].to_owned()
    }

    #[test]
    fn cells_are_found_whatever_separates_them() {
        assert_eq!(excerpt("1, pi/x ,3", 2), "pi/x");
        assert_eq!(excerpt("1  nan   3", 2), "nan");
        assert_eq!(excerpt("1\tnan\t3", 2), "nan");
        assert_eq!(excerpt("1;;oops", 3), "oops");
    }

    #[test]
    fn long_rows_are_cropped_around_the_cell() {
        let row = (0..90).map(|i| format!("{i}.00000")).collect::<Vec<_>>().join(",");
        assert_eq!(excerpt(&row, 51), "50.00000");
    }

    #[test]
    fn what_is_not_there_is_no_excerpt() {
        assert_eq!(Excerpt::of_line(Path::new("/no/such/file"), 1, None), None);
    }
}
