//! What listings say of models and libraries.

use std::path::PathBuf;

use aurt_traits::{ModelEntry, Slot};

/// What a listing says of a loaded library.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LibraryListing {
    /// The library's own name.
    pub name: String,
    /// The library's own version.
    pub version: String,
    /// Its file.
    pub path: PathBuf,
    /// The BLAKE3 hash of the file's bytes when it was loaded, in hexadecimal digits.
    pub blake3: String,
}

/// What a listing says of a model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelListing {
    /// Where the model may be named.
    pub slot: Slot,
    /// Its name in experiments.
    pub name: String,
    /// One line for listings.
    pub summary: String,
    /// The equation, in plain text.
    pub equation: String,
    /// When to use the model, and when another.
    pub use_when: String,
    /// Where the equation is from.
    pub source: String,
    /// A working configuration, as a TOML inline table.
    pub example: String,
    /// Who registered it.
    pub origin: Origin,
}

const BUILTIN: &str = "aurt-friction";

/// Who registered a model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// A crate that is part of this program.
    Crate(&'static str),
    /// A dynamic library.
    Library(LibraryListing),
}

impl Origin {
    /// Whether the model comes with AURT.
    pub fn is_builtin(&self) -> bool {
        *self == Self::Crate(BUILTIN)
    }
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Crate(name) => write!(f, "crate {name}"),
            Self::Library(LibraryListing { name, version, path, .. }) => {
                write!(f, "library {name} {version} ({})", path.display())
            }
        }
    }
}

impl From<&ModelEntry> for ModelListing {
    fn from(entry: &ModelEntry) -> Self {
        Self {
            slot: entry.slot,
            name: entry.name.to_owned(),
            summary: entry.summary.to_owned(),
            equation: entry.equation.to_owned(),
            use_when: entry.use_when.to_owned(),
            source: entry.source.to_owned(),
            example: entry.example.to_owned(),
            origin: Origin::Crate(entry.origin),
        }
    }
}
