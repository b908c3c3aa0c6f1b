//! Parts of a text that are set off.
//!
//! They stand between marks until [`Style::finished`] has escaped everything else. Each process draws its own marks, so that no
//! text of a file can contain them.

use std::borrow::Cow;
use std::hash::{BuildHasher, RandomState};
use std::sync::LazyLock;

use aurt_files::harmless;

/// A part of a report that is set off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Emphasis {
    Title,
    Warning,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Style {
    /// Whether with the colours of a terminal (ANSI escape sequences).
    pub coloured: bool,
}

/// Beginning of all marks: 64 random bits as four characters for private use.
static MARK: LazyLock<String> = LazyLock::new(|| {
    let bits = RandomState::new().hash_one("marks").to_le_bytes();
    let private = |pair: &[u8]| char::from_u32(0xf_0000 + u32::from(pair[0]) + (u32::from(pair[1]) << 8));
    bits.chunks_exact(2).filter_map(private).collect()
});

/// Ends of the marks, each with the sequence that a terminal obeys.
const SEQUENCES: [(char, &str); 3] = [('t', "\u{1b}[1m"), ('w', "\u{1b}[33m"), ('e', "\u{1b}[0m")];

impl Style {
    pub const PLAIN: Self = Self { coloured: false };

    /// `text` between marks, if this style is coloured.
    pub fn emphasise(self, emphasis: Emphasis, text: &str) -> String {
        let kind = match emphasis {
            Emphasis::Title => 't',
            Emphasis::Warning => 'w',
        };
        let mark = MARK.as_str();
        if self.coloured { format!("{mark}{kind}{text}{mark}e") } else { text.to_owned() }
    }

    /// A whole text for a terminal: harmful characters escaped, and marks replaced by sequences, or by nothing
    /// if this style is not coloured.
    pub fn finished(self, text: &str) -> Cow<'_, str> {
        let mut pieces = text.split(MARK.as_str());
        let first = harmless(pieces.next().unwrap_or_default());
        let mut pieces = pieces.peekable();
        if pieces.peek().is_none() {
            return first;
        }
        let mut finished = first.into_owned();
        for piece in pieces {
            let known =
                SEQUENCES.iter().find_map(|(end, sequence)| Some((piece.strip_prefix(*end)?, *sequence)));
            let (rest, sequence) = known.unwrap_or((piece, ""));
            finished.push_str(if self.coloured { sequence } else { "" });
            finished.push_str(&harmless(rest));
        }
        Cow::Owned(finished)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terminals_obey_what_we_set_off_and_nothing_else() {
        let style = Style { coloured: true };
        let own =
            style.emphasise(Emphasis::Title, "a\u{1b}[31mb") + " " + &style.emphasise(Emphasis::Warning, "c");
        assert_eq!(style.finished(&own), "\u{1b}[1ma\\u{1b}[31mb\u{1b}[0m \u{1b}[33mc\u{1b}[0m");
        assert_eq!(Style::PLAIN.finished(&own), "a\\u{1b}[31mb c");
        assert_eq!(style.finished("plain"), "plain");
        let foreign =
            ["\u{1b}[1m", "\u{1b}[38;5;15;8m", "\u{1b}[38;2;0;0;0m", "\u{1b}[0m", "\u{9b}1m", "\u{202e}"];
        for text in foreign {
            let name = format!("n{text}HIDDEN");
            for style in [style, Style::PLAIN] {
                assert_eq!(style.finished(&name), harmless(&name));
                assert!(!style.finished(&name).contains(text), "{text:?}");
            }
        }
    }
}
