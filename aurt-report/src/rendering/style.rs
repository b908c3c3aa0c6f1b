//! Parts of a text that are set off.

/// A part of a report that is set off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Emphasis {
    /// A title.
    Title,
    /// Something that needs attention.
    Warning,
}

/// How text is set off.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Style {
    /// Whether with the colours of a terminal (ANSI escape sequences).
    pub coloured: bool,
}

impl Style {
    /// Text without escape sequences.
    pub const PLAIN: Self = Self { coloured: false };

    /// `text` set off, if this style is coloured.
    #[must_use]
    pub fn emphasise(self, emphasis: Emphasis, text: &str) -> String {
        let code = match emphasis {
            Emphasis::Title => "1",
            Emphasis::Warning => "33",
        };
        if self.coloured { format!("\u{1b}[{code}m{text}\u{1b}[0m") } else { text.to_owned() }
    }
}
