use std::path::PathBuf;

use aurt_traits::{ModelError, Slot, abi};
use thiserror::Error;

use crate::listing::LibraryListing;
use crate::{Node, Span, place, suggestion};

/// Why a library could not be loaded.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages say all")]
pub enum LibraryProblem {
    #[error(
        "does not exist; build it (`cargo build --release` for a Rust crate) and give the path of the built file"
    )]
    Missing,
    /// A file names it, and nobody has said that its code may run.
    #[error(
        "is not trusted, and loading it runs its code with your rights; if you know where it is from, allow it once \
         (`--plugin` with its path, or `--allow-plugins`) or from now on (`aurt trust` with its path)"
    )]
    NotTrusted,
    #[error("is not a library that this system can load: {0}")]
    NotALibrary(String),
    #[error(
        "is a library, but no plugin: it does not export `{entry}`; a Rust crate exports it with \
         `aurt_traits::export_plugin!()`, a C file defines it",
        entry = abi::ENTRY
    )]
    NotAPlugin,
    /// It exports a function of that name that does not return a declaration.
    #[error("exports `{entry}`, but that does not return a plugin's declaration", entry = abi::ENTRY)]
    NoDeclaration,
    #[error(
        "was built for version {major}.{minor} of the plugin interface, this program has version \
         {ours}.{our_minor}; build it again with this program's `aurt-traits` or `aurt_plugin.h`",
        ours = abi::ABI_MAJOR, our_minor = abi::ABI_MINOR
    )]
    OtherVersion { major: u32, minor: u32 },
    #[error("has a faulty declaration: {0}")]
    Faulty(String),
}

/// Why something about models, libraries or plugins failed.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum Error {
    /// A model's configuration does not give a model.
    #[error(transparent)]
    Build(#[from] BuildError),
    #[error(
        "the {slot} model `{name}` exists twice: from {first} and from {second}; rename one of them or load only one"
    )]
    DuplicateModel {
        slot: &'static str,
        name: String,
        /// What registered the first, in words.
        first: String,
        /// What registered the second, in words.
        second: String,
    },
    #[error("the library {path} {problem}", path = path.display())]
    Library { path: PathBuf, problem: LibraryProblem },
    #[error("{path}: {reason}; mend or delete it (`aurt trust LIBRARY` writes it)", path = path.display())]
    TrustList { path: PathBuf, reason: String },
    #[error("`{name}` cannot be the name of a plugin: it {reason}")]
    PluginName { name: String, reason: &'static str },
    #[error("{path}: cannot be written: {source}", path = path.display())]
    Write { path: PathBuf, source: std::io::Error },
}

/// Why a model could not be built from its configuration.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum BuildError {
    #[error("expected a table such as {{ model = \"…\" }}, found {found}")]
    NoTable { slot: Slot, found: &'static str, span: Span },
    #[error("the table lacks `model`, the name of the {slot} model", slot = slot.name())]
    NoModelKey {
        slot: Slot,
        /// Names of that slot's models, sorted.
        known: Vec<String>,
        span: Span,
    },
    #[error("there is no {slot} model `{name}`", slot = slot.name())]
    UnknownModel {
        slot: Slot,
        name: String,
        /// Names of that slot's models, sorted.
        known: Vec<String>,
        /// Slots that do have a model of that name.
        elsewhere: Vec<Slot>,
        span: Span,
    },
    /// The model refused its keys: unknown key, wrong type, missing key.
    #[error("model `{model}`{place}: {reason}", place = key.as_ref().map_or_else(String::new, |k| format!(", key `{k}`")))]
    Configuration {
        model: String,
        /// The key that it was about, if one.
        key: Option<String>,
        reason: String,
        example: String,
        span: Span,
    },
    #[error(
        "the {slot} model `{model}` is from the library {name} {version}, which is not loaded",
        slot = slot.name()
    )]
    LibraryNotLoaded {
        slot: Slot,
        model: String,
        name: String,
        version: String,
        /// Its file, when the model was saved.
        library: PathBuf,
    },
    #[error(
        "the {slot} model `{model}` was saved from the library {} {}, but the one here is from {found}, whose \
         coefficients may mean something else",
        saved.name, saved.version, slot = slot.name()
    )]
    OtherLibrary {
        slot: Slot,
        model: String,
        saved: Box<LibraryListing>,
        /// What has registered the model now, in words.
        found: String,
    },
    /// The model has its keys but cannot work with a value, or does not fit its slot.
    #[error("{error}")]
    Invalid { error: ModelError, span: Span },
}

impl BuildError {
    /// A model's complaints about its configuration, each with the place of the key that it names.
    pub fn invalid(table: &Node, complaints: Vec<ModelError>) -> Vec<Self> {
        complaints
            .into_iter()
            .map(|error| {
                let place = match &error {
                    ModelError::InvalidParameter { parameter, .. } => place::of_key(table, parameter),
                    other => place::of_message(table, &other.to_string()),
                };
                Self::Invalid { error, span: place.span }
            })
            .collect()
    }

    /// Where the culprit stands in the text that the configuration was read from.
    pub fn span(&self) -> Span {
        match self {
            Self::NoTable { span, .. }
            | Self::NoModelKey { span, .. }
            | Self::UnknownModel { span, .. }
            | Self::Configuration { span, .. }
            | Self::Invalid { span, .. } => span.clone(),
            // Only files without places say what library a model is from.
            Self::LibraryNotLoaded { .. } | Self::OtherLibrary { .. } => 0..0,
        }
    }

    /// What to do about it: what is known, what was probably meant.
    pub fn help(&self) -> Option<String> {
        match self {
            Self::NoTable { slot, .. } => Some(match slot {
                Slot::ArmTerm => "write [[arm_terms]] with `model = \"…\"` below it".to_owned(),
                _ => format!("write {} = {{ model = \"…\" }}", slot.name()),
            }),
            Self::NoModelKey { slot, known, .. } => {
                let list = known.iter().map(|k| format!("`{k}`")).collect::<Vec<_>>().join(", ");
                Some(format!("known {} models: {list}", slot.name()))
            }
            Self::UnknownModel { slot, name, known, elsewhere, .. } => {
                let names = || known.iter().map(String::as_str);
                let mut help = suggestion::help(name, &format!("{} models", slot.name()), names());
                if !elsewhere.is_empty() {
                    let slots = elsewhere.iter().map(|s| format!("`{}`", s.name())).collect::<Vec<_>>();
                    help = format!("`{name}` is a model for {}; {help}", slots.join(", "));
                } else if suggestion::likely(name, names()).is_none() {
                    help.push_str("; a model of a library needs that library loaded ([plugins] or --plugin)");
                }
                Some(help)
            }
            Self::Configuration { key, reason, example, .. } => {
                let meant = key.as_deref().filter(|_| reason.starts_with("unknown key")).and_then(|key| {
                    let expected = reason.split_once("expected")?.1;
                    suggestion::likely(key, expected.split('`').skip(1).step_by(2))
                });
                Some(meant.map_or_else(
                    || format!("a working example: {example}"),
                    |meant| format!("did you mean `{meant}`? a working example: {example}"),
                ))
            }
            Self::LibraryNotLoaded { library, .. } => Some(format!(
                "load it with `--plugin {}`, or under `libraries` of [plugins] in the experiment",
                library.display()
            )),
            Self::OtherLibrary { saved, .. } => Some(format!(
                "load version {} in its place (it was {}), or calibrate anew with the one that is here",
                saved.version,
                saved.path.display()
            )),
            Self::Invalid { .. } => None,
        }
    }
}

impl From<aurt_files::output::WriteError> for Error {
    fn from(error: aurt_files::output::WriteError) -> Self {
        Self::Write { path: error.path, source: error.source }
    }
}
