//! Text from files of users, fit to be shown.

use std::borrow::Cow;
use std::fmt::Write;

/// Characters of a file that a message quotes at most.
pub const MOST_QUOTED: usize = 80;

/// A quotation from a file: control characters escaped, at most [`MOST_QUOTED`] characters, and the length of what was
/// left out.
///
/// ```
/// assert_eq!(aurt_files::clipped("1.5\u{1b}[2J"), "1.5\\u{1b}[2J");
/// assert_eq!(aurt_files::clipped(&"9".repeat(1000)), format!("{}… ({} bytes in all)", "9".repeat(80), 1000));
/// ```
pub fn clipped(text: &str) -> String {
    let end = text.char_indices().nth(MOST_QUOTED).map_or(text.len(), |(at, _)| at);
    let mut shown = String::with_capacity(end);
    for c in text[..end].chars() {
        if is_harmful(c) || c == '\n' || c == '\t' {
            shown.extend(c.escape_default());
        } else {
            shown.push(c);
        }
    }
    if end < text.len() {
        let _ = write!(shown, "… ({} bytes in all)", text.len());
    }
    shown
}

/// A path as experiments write it: every `$` doubled, so that it stands for itself.
pub fn escaped(path: &str) -> String {
    path.replace('$', "$$")
}

/// Whether a terminal obeys a character rather than showing it, shows it so that other text seems to stand elsewhere, or shows
/// nothing, so that two names look alike: all controls but line feed and tab, the controls of writing direction (Unicode's
/// `Bidi_Control`), spaces without width and separators of lines.
pub fn is_harmful(c: char) -> bool {
    let direction =
        matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let invisible = matches!(c, '\u{200b}' | '\u{2028}' | '\u{2029}' | '\u{2060}'..='\u{2064}' | '\u{feff}');
    direction || invisible || c.is_control() && c != '\n' && c != '\t'
}

/// Text for a terminal, a page or a comment: harmful characters are escaped, those of escape sequences too.
///
/// ```
/// assert_eq!(aurt_files::harmless("a\u{1b}[8mb\u{202e}c"), "a\\u{1b}[8mb\\u{202e}c");
/// ```
pub fn harmless(text: &str) -> Cow<'_, str> {
    if !text.contains(is_harmful) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(is_harmful) {
        shown.push_str(&rest[..at]);
        rest = &rest[at..];
        let Some(c) = rest.chars().next() else { break };
        // A carriage return before a line feed is a line end of another system.
        if !rest.starts_with("\r\n") {
            shown.extend(c.escape_default());
        }
        rest = &rest[c.len_utf8()..];
    }
    shown.push_str(rest);
    Cow::Owned(shown)
}

/// A JSON document of the same value without harmful characters: they can only stand in its texts, where each has an escape.
pub fn harmless_json(document: &str) -> Cow<'_, str> {
    if !document.contains(is_harmful) {
        return Cow::Borrowed(document);
    }
    let mut shown = String::with_capacity(document.len());
    for c in document.chars() {
        if is_harmful(c) {
            let _ = write!(shown, "\\u{:04x}", u32::from(c));
        } else {
            shown.push(c);
        }
    }
    Cow::Owned(shown)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn terminals_are_not_commanded_by_what_is_shown() {
        assert_eq!(harmless("a\tb\nc"), "a\tb\nc");
        assert_eq!(harmless("a\r\n"), "a\n");
        assert_eq!(harmless("\u{1b}[1mtitle\u{1b}[0m"), "\\u{1b}[1mtitle\\u{1b}[0m");
        assert_eq!(
            harmless("x\u{1b}]0;title\u{7}\u{1b}[2J\u{9b}31m"),
            "x\\u{1b}]0;title\\u{7}\\u{1b}[2J\\u{9b}31m"
        );
        let direction = ['\u{61c}', '\u{200e}', '\u{200f}', '\u{202a}', '\u{202e}', '\u{2066}', '\u{2069}'];
        let invisible = ['\u{200b}', '\u{2028}', '\u{2060}', '\u{feff}'];
        for c in direction.into_iter().chain(invisible).chain(['\u{7f}']) {
            assert_eq!(harmless(&format!("a{c}b")), format!("a\\u{{{:x}}}b", u32::from(c)));
        }
    }

    #[test]
    fn documents_for_programs_keep_their_values() {
        let document = "{\"a\u{202e}\u{7f}\u{9b}\": \"\\u001b[8m\"}\n";
        assert_eq!(harmless_json(document), "{\"a\\u202e\\u007f\\u009b\": \"\\u001b[8m\"}\n");
    }

    proptest! {
        #[test]
        fn quotations_are_short_and_without_commands(text in "\\PC*|[\\x00-\\x1f\\u{80}-\\u{9f}a]{0,400}") {
            let shown = clipped(&text);
            prop_assert!(shown.chars().count() <= 8 * MOST_QUOTED + 40);
            prop_assert!(!shown.contains(|c: char| c.is_control()));
            prop_assert!(!harmless(&shown).contains(is_harmful));
        }
    }
}
