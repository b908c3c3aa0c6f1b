//! Tables of a report.

use std::fmt::Write;

use crate::escape;
use crate::rendering::table as terminal;

/// A table; columns whose title begins with `<` are set to the left, all others to the right.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    pub caption: String,
    pub columns: Vec<String>,
    pub rows: Vec<Vec<Cell>>,
}

#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Cell {
    pub text: String,
    pub strong: bool,
}

/// Text of more characters than this is broken into lines.
const LONG: usize = 32;
const LONG_CLASS: &str = " class=\"left long\"";

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self { text, strong: false }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::from(text.to_owned())
    }
}

impl Table {
    pub fn new<C: Into<String>>(caption: impl Into<String>, columns: impl IntoIterator<Item = C>) -> Self {
        let columns = columns.into_iter().map(Into::into).collect();
        Self { caption: caption.into(), columns, rows: Vec::new() }
    }

    pub fn row<C: Into<Cell>>(&mut self, cells: impl IntoIterator<Item = C>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    /// The same for a terminal, without its caption.
    pub fn to_text(&self) -> String {
        let mut table = terminal::Table::new(self.columns.iter().map(|c| c.strip_prefix('<').unwrap_or(c)));
        table.left = self.columns.iter().map(|title| title.starts_with('<')).collect();
        self.rows.iter().for_each(|row| table.row(row.iter().map(|cell| cell.text.as_str())));
        table.render()
    }

    pub(crate) fn to_html(&self) -> String {
        let left = |k: usize| self.columns.get(k).is_some_and(|c| c.starts_with('<'));
        let class = |k: usize| if left(k) { " class=\"left\"" } else { "" };
        let mut html = String::new();
        // Above the part that scrolls, so that it is read in full on a narrow screen.
        if !self.caption.is_empty() {
            let _ = writeln!(html, "<p class=\"caption\">{}</p>", escape::text(&self.caption));
        }
        let name = if self.caption.is_empty() { "table" } else { &self.caption };
        let _ = write!(
            html,
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{}\"><table>",
            escape::text(name)
        );
        html.push_str("<thead><tr>");
        for (k, title) in self.columns.iter().enumerate() {
            let title = escape::text(title.strip_prefix('<').unwrap_or(title));
            let _ = write!(html, "<th scope=\"col\"{}>{title}</th>", class(k));
        }
        html.push_str("</tr></thead><tbody>\n");
        for row in &self.rows {
            html.push_str("<tr>");
            for (k, cell) in row.iter().enumerate() {
                // Only long text may be broken into lines; names and joints stay whole.
                let class = if left(k) && cell.text.chars().count() > LONG { LONG_CLASS } else { class(k) };
                let text = escape::text(&cell.text);
                let text = if cell.strong { format!("<strong>{text}</strong>") } else { text };
                let _ = write!(html, "<td{class}>{text}</td>");
            }
            html.push_str("</tr>\n");
        }
        html.push_str("</tbody></table></div>\n");
        html
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_text_and_first_columns_can_stand_left() {
        let mut table = Table::new("errors", ["<name", "value"]);
        table.row(["<b>", "1 & 2"]);
        let html = table.to_html();
        assert!(html.contains("<td class=\"left\">&lt;b&gt;</td><td>1 &amp; 2</td>"), "{html}");
        assert!(html.contains("<th scope=\"col\" class=\"left\">name</th>"), "{html}");
    }
}
