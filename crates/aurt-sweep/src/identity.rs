//! What a result depends on, as a hash.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
    sync::Mutex,
};

use aurt_plugins::{Experiment, Registry};
use blake3::Hasher;

use crate::{SweepError, definition::Validate};

/// Version of what is hashed, and of the results.
const VERSION: &str = "aurt sweep result 1";

/// Digests of files, each read once.
#[derive(Debug, Default)]
pub struct Digests {
    known: Mutex<HashMap<PathBuf, [u8; 32]>>,
}

impl Digests {
    /// The digest of a file's contents.
    ///
    /// # Errors
    /// [`SweepError::Read`].
    pub fn of(&self, path: &Path) -> Result<[u8; 32], SweepError> {
        let mut known = self.known.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(digest) = known.get(path) {
            return Ok(*digest);
        }
        let fail = |source| SweepError::Read { path: path.to_owned(), source };
        let digest = *blake3::hash(&std::fs::read(path).map_err(fail)?).as_bytes();
        known.insert(path.to_owned(), digest);
        Ok(digest)
    }
}

/// The key of a point: a hash of everything that its result depends on. These are the resolved experiment, the contents
/// of every file that it names, how points are judged, and the program: its version, its executable and the libraries
/// whose models it has loaded.
///
/// # Errors
/// [`SweepError::Read`] if a file cannot be read.
pub fn key(
    text: &str,
    experiment: &Experiment,
    (validate, block_s): (Validate, f64),
    registry: &Registry,
    digests: &Digests,
) -> Result<String, SweepError> {
    let mut hash = Hasher::new();
    let mut add = |part: &[u8]| {
        // With their lengths, parts cannot run into each other.
        hash.update(&(part.len() as u64).to_le_bytes());
        hash.update(part);
    };
    add(VERSION.as_bytes());
    add(env!("CARGO_PKG_VERSION").as_bytes());
    if let Ok(program) = std::env::current_exe() {
        add(&digests.of(&program)?);
    }
    for library in registry.libraries() {
        add(library.name.as_bytes());
        add(library.version.as_bytes());
        add(&digests.of(&library.path)?);
    }
    add(text.as_bytes());
    add(format!("{validate:?} {block_s:?}").as_bytes());
    add(&digests.of(&experiment.robot.mdh)?);
    let recordings = &experiment.recordings;
    for source in recordings.calibration.iter().chain(&recordings.validation) {
        add(&digests.of(&source.file)?);
    }
    Ok(hash.finalize().to_hex().as_str()[..40].to_owned())
}
