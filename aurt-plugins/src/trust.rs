//! Which libraries a file may name: loading a library runs its code with the rights of whoever loads it.
//!
//! Libraries that a person names ([`Registry::load_library`](crate::Registry::load_library), the option `--plugin`) are
//! loaded. Libraries that an experiment names are loaded if their bytes are trusted: an experiment may come from someone
//! else.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

use crate::Error;
use crate::dynamic::LibraryFile;

/// Names what is trusted beside the list: `all`, or hashes separated by spaces.
const ENVIRONMENT: &str = "AURT_TRUST";

/// Names another file than the user's own list.
const LIST: &str = "AURT_TRUST_FILE";

/// Length of a BLAKE3 hash in hexadecimal digits.
const DIGITS: usize = 64;

/// The libraries whose code may be run when a file names them.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Trust {
    all: bool,
    hashes: BTreeSet<String>,
}

impl Trust {
    /// Every library.
    pub const fn all() -> Self {
        Self { all: true, hashes: BTreeSet::new() }
    }

    /// What the user trusts: the environment variable `AURT_TRUST` (`all`, or hashes separated by spaces), and the list
    /// that `aurt trust` keeps.
    ///
    /// # Errors
    /// A list that cannot be read, or a line of it that begins with no BLAKE3 hash.
    pub fn of_user() -> Result<Self, Error> {
        let said = env::var(ENVIRONMENT).unwrap_or_default();
        if said.trim() == "all" {
            return Ok(Self::all());
        }
        let mut hashes: BTreeSet<String> = said.split_whitespace().map(str::to_owned).collect();
        if let Some(list) = Self::list() {
            hashes.extend(Self::listed(&list)?.into_iter().map(|(hash, _)| hash));
        }
        Ok(Self { all: false, hashes })
    }

    /// The user's list: `AURT_TRUST_FILE`, or `aurt/trusted-plugins` in the folder for configuration (`XDG_CONFIG_HOME`,
    /// `~/.config`; on Windows `APPDATA`).
    pub fn list() -> Option<PathBuf> {
        let folder = |name: &str| env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
        folder(LIST).or_else(|| {
            let configuration = folder("XDG_CONFIG_HOME")
                .or_else(|| folder("HOME").map(|home| home.join(".config")))
                .or_else(|| folder("APPDATA"));
            configuration.map(|folder| folder.join("aurt").join("trusted-plugins"))
        })
    }

    /// The lines of a list: hashes and the files that had them.
    ///
    /// # Errors
    /// As [`Self::of_user`]. A list that does not exist is empty.
    pub fn listed(list: &Path) -> Result<Vec<(String, String)>, Error> {
        let fail = |reason: String| Error::TrustList { path: list.to_owned(), reason };
        let bytes = match aurt_files::read_regular(list, aurt_files::MOST_TEXT_BYTES) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            Err(error) => return Err(fail(error.to_string())),
        };
        let text = aurt_files::text_of(bytes).map_err(|error| fail(error.to_string()))?;
        let line = |(number, line): (usize, &str)| {
            let (hash, file) = line.trim().split_once(char::is_whitespace).unwrap_or((line.trim(), ""));
            let is_hash = hash.len() == DIGITS && hash.bytes().all(|b| b.is_ascii_hexdigit());
            let reason = || fail(format!("line {} begins with no BLAKE3 hash", number + 1));
            if is_hash { Ok((hash.to_ascii_lowercase(), file.trim().to_owned())) } else { Err(reason()) }
        };
        text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()).map(line).collect()
    }

    /// Adds the bytes that a library has now to a list. Returns their hash.
    ///
    /// # Errors
    /// A library that cannot be read, a list that cannot be written.
    pub fn add(list: &Path, library: &Path) -> Result<String, Error> {
        let hash = LibraryFile::read(library)?.blake3;
        let fail = |source| Error::Write { path: list.to_owned(), source };
        let mut lines = Self::listed(list)?;
        let file = library.canonicalize().unwrap_or_else(|_| library.to_owned());
        if !lines.iter().any(|(known, _)| *known == hash) {
            lines.push((hash.clone(), file.display().to_string()));
            let text: String = lines.iter().map(|(hash, file)| format!("{hash}  {file}\n")).collect();
            if let Some(folder) = list.parent() {
                fs::create_dir_all(folder).map_err(fail)?;
            }
            aurt_files::output::write_file(list, text.as_bytes())?;
        }
        Ok(hash)
    }

    /// Whether a file of this hash may be loaded.
    pub fn allows(&self, hash: &str) -> bool {
        self.all || self.hashes.contains(hash)
    }

    /// Trusts the bytes of this hash as well.
    pub fn insert(&mut self, hash: String) {
        self.hashes.insert(hash);
    }

    /// The environment variable by which a program that is started trusts the same.
    pub fn environment(&self) -> (&'static str, String) {
        let hashes = || self.hashes.iter().map(String::as_str).collect::<Vec<_>>().join(" ");
        (ENVIRONMENT, if self.all { "all".to_owned() } else { hashes() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_grows_by_what_is_trusted_and_knows_bytes_not_names() {
        let folder = tempfile::tempdir().unwrap();
        let list = folder.path().join("aurt/trusted-plugins");
        let library = folder.path().join("a.so");
        fs::write(&library, b"code").unwrap();
        let hash = Trust::add(&list, &library).unwrap();
        assert_eq!(Trust::add(&list, &library).unwrap(), hash);
        let listed = Trust::listed(&list).unwrap();
        assert_eq!(listed.len(), 1);
        assert!(listed[0].0 == hash && listed[0].1.ends_with("a.so"), "{listed:?}");
        fs::write(&library, b"other code").unwrap();
        assert_ne!(LibraryFile::read(&library).unwrap().blake3, hash);
        assert!(!Trust::default().allows(&hash) && Trust::all().allows(&hash));
    }

    #[test]
    fn a_damaged_list_is_told_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let list = folder.path().join("list");
        fs::write(&list, format!("{}  a.so\n\nnonsense b.so\n", "a".repeat(DIGITS))).unwrap();
        let error = Trust::listed(&list).unwrap_err().to_string();
        assert!(error.contains("line 3 begins with no BLAKE3 hash"), "{error}");
        assert!(Trust::listed(&folder.path().join("none")).unwrap().is_empty());
    }
}
