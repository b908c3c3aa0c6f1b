//! The one place where text of others becomes part of markup.

use std::fmt::Write;

/// `text` such that it is text in HTML and SVG, in elements and in quoted attributes. Characters that no page may have or that
/// turn the direction of writing are shown as their escapes.
pub fn text(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in aurt_files::harmless(text).chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// A JSON document such that it can stand in a `script` element: no `<` is left that could end the element or begin a
/// comment, and the line separators that JSON allows and scripts do not and the controls of terminals are written as escapes.
pub fn json(document: &str) -> String {
    let mut out = String::with_capacity(document.len());
    for c in aurt_files::harmless_json(document).chars() {
        match c {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_becomes_text() {
        assert_eq!(text("a<b> & \"c\" 'd'\t"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39; ");
        assert_eq!(text("\u{7}\u{202e}\u{1b}[8m"), "\\u{7}\\u{202e}\\u{1b}[8m");
    }

    #[test]
    fn json_cannot_leave_its_element() {
        let escaped = json("{\"file\":\"</script><!--\"}");
        assert!(!escaped.contains('<'), "{escaped}");
        assert_eq!(json("\"\u{202e}\""), "\"\\u202e\"");
        assert_eq!(escaped, "{\"file\":\"\\u003c/script\\u003e\\u003c!--\"}");
    }
}
