//! Files that a program has read, and therefore does not write over.

use std::collections::BTreeMap;
use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What a file is, whatever it is called: device and number on Unix, the path without links elsewhere.
#[cfg(unix)]
type Identity = (u64, u64);
#[cfg(not(unix))]
type Identity = PathBuf;

/// The files that were read, each with a path that leads to it; none where nothing is protected.
static READ: Mutex<Option<BTreeMap<Identity, PathBuf>>> = Mutex::new(None);

pub(crate) fn lock<T>(mutex: &'static Mutex<T>) -> MutexGuard<'static, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From now on [`is_input`] knows what this process reads, for commands, which must not overwrite their inputs. Programs that
/// live on, and read what they wrote, do without.
pub fn protect_inputs() {
    lock(&READ).get_or_insert_default();
}

pub(crate) fn note(path: &Path, metadata: &Metadata) {
    let mut read = lock(&READ);
    if let Some((read, identity)) = read.as_mut().zip(identity(path, metadata)) {
        read.entry(identity).or_insert_with(|| fs::canonicalize(path).unwrap_or_else(|_| path.to_owned()));
    }
}

#[cfg(unix)]
pub(crate) fn is_known(metadata: &Metadata) -> bool {
    let identity = identity(Path::new(""), metadata);
    lock(&READ).as_ref().zip(identity).is_some_and(|(read, identity)| read.contains_key(&identity))
}

/// Whether a path, by this name or another, leads to a file that this process has read.
pub fn is_input(path: &Path) -> bool {
    let identity_of = |path: &Path| fs::metadata(path).ok().and_then(|metadata| identity(path, &metadata));
    let Some(identity) = identity_of(path) else { return false };
    let read = lock(&READ);
    // The number of a file that is gone may be another's now.
    read.as_ref()
        .and_then(|read| read.get(&identity))
        .is_some_and(|known| identity_of(known).as_ref() == Some(&identity))
}

#[cfg(unix)]
fn identity(_: &Path, metadata: &Metadata) -> Option<Identity> {
    use std::os::unix::fs::MetadataExt;
    Some((metadata.dev(), metadata.ino()))
}

#[cfg(not(unix))]
fn identity(path: &Path, _: &Metadata) -> Option<Identity> {
    fs::canonicalize(path).ok()
}
