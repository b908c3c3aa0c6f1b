//! Writing a new plugin: a crate in Rust or a file in C that builds, tests itself, and has a working model to start from.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::io;
use std::path::{Path, PathBuf};

use aurt_files::output::write_folder;
use aurt_traits::abi;

use crate::Error;

/// The language of a new plugin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PluginLanguage {
    /// A crate that is linked statically or built as a library.
    #[default]
    Rust,
    /// A file that is built as a library.
    C,
}

/// A plugin that was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NewPlugin {
    /// Its folder.
    pub folder: PathBuf,
    /// Its files, relative to the folder.
    pub files: Vec<PathBuf>,
    /// The name of its model in experiments.
    pub model: String,
    /// The library that building it gives, relative to the folder.
    pub library: PathBuf,
    /// The commands that test and build it, to be run in the folder.
    pub commands: Vec<&'static str>,
}

const RUST: [(&str, &str); 3] = [
    ("Cargo.toml", include_str!("../templates/rust/Cargo.toml.txt")),
    ("src/lib.rs", include_str!("../templates/rust/lib.rs.txt")),
    ("README.md", include_str!("../templates/rust/README.md.txt")),
];

const C: [(&str, &str); 4] = [
    ("{{model}}.c", include_str!("../templates/c/model.c.txt")),
    ("test.c", include_str!("../templates/c/test.c.txt")),
    ("Makefile", include_str!("../templates/c/Makefile.txt")),
    ("README.md", include_str!("../templates/c/README.md.txt")),
];

/// Words that cannot name a crate, a struct's file or a C type.
const RESERVED: &str = "\
    abstract as async auto await become box break case char check columns const continue core crate \
    create declaration default describe destroy do double dyn else enum evaluate extern false final \
    float fn for gen goto if impl in inline int keys let long loop macro main match mod models move mut \
    override priv proc-macro pub ref register restrict return self set_shape short signed sizeof static \
    std struct super switch test trait true try type typedef typeof union unsafe unsigned unsized use \
    virtual void volatile where while yield";

/// Writes a new plugin into `folder`, which must not exist yet.
///
/// The name is that of the crate (lower-case letters, digits, `-` and `_`); the model's is the same with `_` for `-`.
/// A Rust crate depends on the `aurt-traits` beside this program's source, where that is still there, and else on the
/// published one of this version.
///
/// # Errors
/// [`Error::PluginName`] for a name that cannot be used, [`Error::Write`] if the folder exists or cannot be written.
pub fn new_plugin(name: &str, language: PluginLanguage, folder: &Path) -> Result<NewPlugin, Error> {
    let model = model_name(name)?;
    if folder.exists() {
        let source =
            io::Error::new(io::ErrorKind::AlreadyExists, "it exists already; choose another name or path");
        return Err(Error::Write { path: folder.to_owned(), source });
    }
    let library = match language {
        PluginLanguage::Rust => format!("{DLL_PREFIX}{model}{DLL_SUFFIX}"),
        PluginLanguage::C => format!("lib{model}{DLL_SUFFIX}"),
    };
    let words = [
        ("{{name}}", name.to_owned()),
        ("{{crate}}", model.clone()),
        ("{{model}}", model.clone()),
        ("{{Type}}", type_name(&model)),
        ("{{library}}", library.clone()),
        ("{{aurt_traits}}", dependency("aurt-traits")),
        ("{{aurt_friction}}", dependency("aurt-friction")),
    ];
    let fill = |text: &str| words.iter().fold(text.to_owned(), |text, (mark, word)| text.replace(mark, word));
    let (templates, library, commands): (&[(&str, &str)], _, _) = match language {
        PluginLanguage::Rust => {
            (&RUST, Path::new("target/release").join(library), vec!["cargo test", "cargo build --release"])
        }
        PluginLanguage::C => (&C, library.into(), vec!["make test", "make"]),
    };
    let mut contents: Vec<(String, String)> =
        templates.iter().map(|(file, text)| (fill(file), fill(text))).collect();
    if language == PluginLanguage::C {
        contents.push(("aurt_plugin.h".to_owned(), abi::HEADER.to_owned()));
    }
    write_folder(folder, &contents)?;
    let files = contents.into_iter().map(|(file, _)| file.into()).collect();
    Ok(NewPlugin { folder: folder.to_owned(), files, model, library, commands })
}

fn model_name(name: &str) -> Result<String, Error> {
    let refuse = |reason: &'static str| Err(Error::PluginName { name: name.to_owned(), reason });
    let model = name.replace('-', "_");
    if !name.starts_with(|c: char| c.is_ascii_lowercase()) {
        return refuse("must begin with a lower-case letter");
    }
    if !name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_') {
        return refuse("may only hold lower-case letters, digits, `-` and `_`");
    }
    if name.len() > 64 {
        return refuse("must not have more than 64 letters");
    }
    if RESERVED.split(' ').any(|word| word == model) || model.starts_with("aurt") {
        return refuse("has a meaning of its own in Rust, in C or in AURT");
    }
    Ok(model)
}

fn type_name(model: &str) -> String {
    model
        .split('_')
        .map(|word| {
            let mut letters = word.chars();
            letters.next().map_or_else(String::new, |first| {
                format!("{}{}", first.to_ascii_uppercase(), letters.as_str())
            })
        })
        .collect()
}

/// The folder of this crate when it was compiled; none in a program that is handed out (`scripts/release.sh`).
const SOURCE: Option<&str> = match option_env!("AURT_RELEASE") {
    Some(_) => None,
    None => Some(env!("CARGO_MANIFEST_DIR")),
};

/// The dependency on one of our crates: by its path where this program's source is still there, else by version.
fn dependency(name: &str) -> String {
    let source = SOURCE.map(|folder| Path::new(folder).join("..").join(name));
    match source.map_or_else(|| Err(io::ErrorKind::NotFound.into()), |source| source.canonicalize()) {
        Ok(path) if path.join("Cargo.toml").exists() => {
            format!("{{ path = {} }}", toml::Value::from(path.to_string_lossy().into_owned()))
        }
        _ => format!("\"{}\"", env!("CARGO_PKG_VERSION")),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn names_that_cannot_be_used_are_refused() {
        let refused = |name: &str| model_name(name).unwrap_err().to_string();
        assert_eq!(
            refused("My-Model"),
            "`My-Model` cannot be the name of a plugin: it must begin with a lower-case letter"
        );
        for name in
            ["", "9lives", "ünder", "a b", "a/b", "../a", "match", "double", "aurt-rbd", &"a".repeat(65)]
        {
            assert!(model_name(name).is_err(), "{name} was accepted");
        }
        assert_eq!(model_name("my-model_2").unwrap(), "my_model_2");
    }

    #[test]
    fn a_type_is_named_after_its_model() {
        assert_eq!(type_name("my_model_2"), "MyModel2");
        assert_eq!(type_name("x"), "X");
    }

    #[test]
    fn every_mark_is_filled() {
        let folder = tempfile::tempdir().unwrap();
        for (language, name) in [(PluginLanguage::Rust, "in-rust"), (PluginLanguage::C, "in-c")] {
            let plugin = new_plugin(name, language, &folder.path().join(name)).unwrap();
            for file in &plugin.files {
                let text = fs::read_to_string(plugin.folder.join(file)).unwrap();
                for mark in ["{{name}}", "{{model}}", "{{Type}}", "{{library}}", "{{crate}}", "{{aurt"] {
                    assert!(!text.contains(mark), "{mark} in {}", file.display());
                }
            }
        }
    }

    #[test]
    fn what_exists_is_not_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let error = new_plugin("mine", PluginLanguage::C, folder.path()).unwrap_err().to_string();
        assert!(error.contains("it exists already; choose another name or path"), "{error}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
