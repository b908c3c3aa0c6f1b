//! Tables of right-aligned columns, for terminals of 80 columns.

use super::text::{WIDTH, lines};

#[derive(Debug, Clone, Default)]
pub struct Table {
    groups: Vec<(usize, String)>,
    header: Vec<String>,
    rows: Vec<Vec<String>>,
    /// Columns that are aligned to the left.
    pub(crate) left: Vec<bool>,
    remark: bool,
}

/// The narrowest column of running text.
const LEAST_REMARK: usize = 14;
const GAP: usize = 2;

impl Table {
    pub fn new<S: Into<String>>(header: impl IntoIterator<Item = S>) -> Self {
        Self { header: header.into_iter().map(Into::into).collect(), ..Self::default() }
    }

    /// Puts a title above this many further columns.
    pub fn group(mut self, columns: usize, title: impl Into<String>) -> Self {
        self.groups.push((columns, title.into()));
        self
    }

    pub fn left(mut self, columns: usize) -> Self {
        self.left = vec![true; columns];
        self
    }

    /// Makes the last column running text: aligned to the left, wrapped at the end of the terminal.
    pub fn remark(mut self) -> Self {
        self.remark = true;
        self
    }

    pub const fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    pub fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    /// The table as text, each line indented by two spaces and ended by a newline.
    pub fn render(&self) -> String {
        let mut widths: Vec<usize> = self.header.iter().map(|h| width(h)).collect();
        for row in &self.rows {
            for (w, cell) in widths.iter_mut().zip(row) {
                *w = (*w).max(width(cell));
            }
        }
        let last = widths.len() - 1;
        let is_left = |k: usize| self.left.get(k).is_some_and(|left| *left) || (self.remark && k == last);
        if is_left(last) {
            // The last column takes what is left of the terminal, and wraps.
            let taken = widths[..last].iter().map(|w| w + GAP).sum::<usize>() + GAP;
            widths[last] = widths[last].min(WIDTH.saturating_sub(taken).max(LEAST_REMARK));
        }
        let mut out = String::new();
        if !self.groups.is_empty() {
            let mut first = 0;
            let mut line = String::new();
            for (columns, title) in &self.groups {
                let span = &widths[first..first + columns];
                let total = span.iter().sum::<usize>() + GAP * (columns - 1);
                line.push_str(&" ".repeat(GAP));
                line.push_str(&centred(title, total));
                first += columns;
            }
            out.push_str(line.trim_end());
            out.push('\n');
        }
        for row in std::iter::once(&self.header).chain(&self.rows) {
            let mut indent = 0;
            let mut line = String::new();
            let mut further = Vec::new();
            for (k, (cell, w)) in row.iter().zip(&widths).enumerate() {
                line.push_str(&" ".repeat(GAP));
                indent = width(&line);
                let mut pieces = if width(cell) > *w { lines(cell, *w) } else { vec![cell.clone()] };
                let cell = pieces.remove(0);
                further = pieces;
                let padding = " ".repeat(w.saturating_sub(width(&cell)));
                if is_left(k) {
                    line.push_str(&cell);
                    line.push_str(&padding);
                } else {
                    line.push_str(&padding);
                    line.push_str(&cell);
                }
            }
            out.push_str(line.trim_end());
            out.push('\n');
            out.extend(further.iter().map(|piece| format!("{}{piece}\n", " ".repeat(indent))));
        }
        out
    }
}

/// Characters a text takes on a terminal; the tables use none of double width.
fn width(text: &str) -> usize {
    text.chars().count()
}

fn centred(title: &str, total: usize) -> String {
    if title.is_empty() {
        return " ".repeat(total);
    }
    let rule = total.saturating_sub(width(title) + 2);
    format!("{} {title} {}", "─".repeat(rule / 2), "─".repeat(rule - rule / 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned_under_their_groups() {
        let mut table = Table::new(["joint", "MSE", "NRMS %"]).group(1, "").group(2, "all");
        table.row(["0", "0.08149", "10.4"]);
        table.row(["1", "1.2", "4"]);
        let expected = "         ───── all ─────\n  joint      MSE  NRMS %\n      0  0.08149    10.4\n      1      1.2       4\n";
        assert_eq!(table.render(), expected);
    }
}
