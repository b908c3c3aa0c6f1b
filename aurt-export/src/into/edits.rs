//! Changes of a text at the places of its elements; all else stays byte for byte.

use std::fmt::Write;
use std::ops::Range;

use roxmltree::Node;

/// A text with pieces to be replaced.
#[derive(Debug)]
pub(super) struct Edits<'t> {
    text: &'t str,
    pieces: Vec<(Range<usize>, String)>,
}

impl<'t> Edits<'t> {
    pub const fn new(text: &'t str) -> Self {
        Self { text, pieces: Vec::new() }
    }

    /// Gives an element attributes: those that it has get another value, others come behind its last. Those in `without`
    /// are taken away, with the blanks before them.
    pub fn set(&mut self, node: Node<'_, '_>, with: &[(&str, String)], without: &[&str]) {
        // Behind the name of the element, where it has no attributes.
        let name_end = node.range().start + 1 + self.name(node).len();
        let end = node.attributes().map(|a| a.range().end).max().unwrap_or(name_end);
        let mut added = String::new();
        for (name, value) in with {
            match node.attribute_node(*name) {
                Some(attribute) if attribute.value() != value => {
                    self.pieces.push((attribute.range_value(), value.clone()));
                }
                Some(_) => {}
                None => {
                    let _ = write!(added, " {name}=\"{value}\"");
                }
            }
        }
        for attribute in node.attributes().filter(|a| without.contains(&a.name())) {
            let range = attribute.range();
            let begin = self.text[..range.start].trim_end().len();
            self.pieces.push((begin..range.end, String::new()));
        }
        if !added.is_empty() {
            self.pieces.push((end..end, added));
        }
    }

    /// Puts a text at a place.
    pub fn insert(&mut self, at: usize, text: String) {
        self.pieces.push((at..at, text));
    }

    /// Puts an element before all that an element contains, behind the blanks that its first child has before it.
    pub fn insert_first(&mut self, node: Node<'_, '_>, element: &str) {
        let range = node.range();
        if let Some(first) = node.first_child() {
            let blank = first.text().filter(|t| first.is_text() && t.trim().is_empty()).unwrap_or_default();
            self.insert(first.range().start, format!("{blank}{element}"));
        } else if self.text[range.clone()].ends_with("/>") {
            let name = self.name(node);
            self.pieces.push((range.end - 2..range.end, format!(">{element}</{name}>")));
        } else if let Some(end) = self.text[range.clone()].rfind("</") {
            self.insert(range.start + end, element.to_owned());
        }
    }

    /// The text with all changes.
    pub fn apply(mut self) -> String {
        let text = self.text;
        self.pieces.sort_by_key(|(range, _)| (range.start, range.end));
        let mut out = String::with_capacity(text.len() + 4096);
        let mut at = 0;
        for (range, replacement) in self.pieces {
            out.push_str(&text[at..range.start.max(at)]);
            out.push_str(&replacement);
            at = range.end.max(at);
        }
        out.push_str(&text[at..]);
        out
    }

    fn name(&self, node: Node<'_, '_>) -> &'t str {
        let behind = &self.text[node.range().start + 1..];
        let end = behind.find(|c: char| c.is_whitespace() || c == '/' || c == '>');
        &behind[..end.unwrap_or_default()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_change_come_and_go_and_the_rest_stays() {
        let text = "<a>\n  <!-- b c='1' -->\n  <b x = '1'\n     y=\"2\" z='3' /> <c/>\u{e9}<d></d>\n</a>";
        let document = roxmltree::Document::parse(text).unwrap();
        let node = |name| document.descendants().find(|n| n.has_tag_name(name)).unwrap();
        let mut edits = Edits::new(text);
        let of = |name, value: &str| (name, value.to_owned());
        edits.set(node("d"), &[of("v", "5")], &[]);
        edits.set(node("b"), &[of("x", "10"), of("w", "4"), of("y", "2")], &["z", "u"]);
        edits.set(node("c"), &[of("v", "6"), of("u", "7")], &[]);
        let wanted = "<a>\n  <!-- b c='1' -->\n  <b x = '10'\n     y=\"2\" w=\"4\" /> <c v=\"6\" u=\"7\"/>\u{e9}<d v=\"5\"></d>\n</a>";
        assert_eq!(edits.apply(), wanted);
        let mut edits = Edits::new(text);
        for (at, new) in [("a", "<n/>"), ("b", "<o/>"), ("c", "<p/>"), ("d", "<q/>")] {
            edits.insert_first(node(at), new);
        }
        let wanted = "<a>\n  <n/>\n  <!-- b c='1' -->\n  <b x = '1'\n     y=\"2\" z='3' ><o/></b> <c><p/></c>\u{e9}<d><q/></d>\n</a>";
        assert_eq!(edits.apply(), wanted);
        assert_eq!(Edits::new(text).apply(), text);
    }
}
