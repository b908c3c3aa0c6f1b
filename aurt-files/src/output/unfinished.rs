//! Files that are being written, so that a command that is interrupted takes them along and leaves whole results alone.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs, io,
    path::{Path, PathBuf},
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
};

/// What is being written now, in the whole process.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
/// Held while finished files take their names.
static PUBLISHING: Mutex<()> = Mutex::new(());
/// Files that have taken their names.
static KEPT: AtomicUsize = AtomicUsize::new(0);

/// Parts of files of killed processes that were removed or completed, by folder.
static CLEARED: Mutex<BTreeMap<PathBuf, usize>> = Mutex::new(BTreeMap::new());

/// How often a folder is removed that others still write into.
const REMOVALS: usize = 100;

/// A file or folder that is being written, until this is dropped.
#[derive(Debug)]
pub(crate) struct Unfinished {
    path: PathBuf,
}

impl Unfinished {
    /// Makes a file or folder that is going to be written, and notes it. Nothing is abandoned between the two.
    ///
    /// # Errors
    /// What `make` reports.
    pub(crate) fn made<T>(
        make: impl FnOnce() -> io::Result<T>,
        path: impl FnOnce(&T) -> &Path,
    ) -> io::Result<(T, Self)> {
        let mut unfinished = lock(&UNFINISHED);
        let made = make()?;
        let path = path(&made).to_owned();
        unfinished.insert(path.clone());
        Ok((made, Self { path }))
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        lock(&UNFINISHED).remove(&self.path);
    }
}

/// Makes folders for what is going to be written. Nothing is abandoned meanwhile, and after that none is made: it could be one that
/// was removed.
///
/// # Errors
/// The system's.
pub(crate) fn make_folders(path: &Path) -> io::Result<()> {
    let _held = lock(&UNFINISHED);
    fs::create_dir_all(path)
}

/// Held by whoever gives finished files their names: an interruption waits until all of them have theirs.
#[derive(Debug)]
pub(crate) struct Publishing {
    _held: MutexGuard<'static, ()>,
}

/// Waits until nobody else publishes, or for ever if the command is being ended.
pub(crate) fn publishing() -> Publishing {
    Publishing { _held: lock(&PUBLISHING) }
}

impl Publishing {
    /// Notes that a file has its name.
    pub(crate) fn kept_one(&self) {
        KEPT.fetch_add(1, Ordering::Relaxed);
    }
}

/// Removes everything that is being written and lets nothing be published any more; for the end of an interrupted
/// command, once: a second call waits for ever. Returns how many files had been written whole before.
#[must_use]
pub fn abandon() -> usize {
    // Kept for good: whoever publishes from now on waits until the process ends.
    std::mem::forget(publishing());
    let unfinished = lock(&UNFINISHED);
    unfinished.iter().for_each(|path| remove(path));
    // Kept for good as well: nothing new is begun.
    std::mem::forget(unfinished);
    KEPT.load(Ordering::Relaxed)
}

/// Notes parts of files that were found in a folder and are no longer there.
pub(crate) fn note_cleared(folder: &Path, parts: usize) {
    if parts > 0 {
        *lock(&CLEARED).entry(folder.to_owned()).or_default() += parts;
    }
}

/// The folders in which this process has found and removed, or completed, what killed processes had left, each with the
/// number of files and folders; nothing of what an earlier call has returned.
#[must_use]
pub fn take_cleared() -> BTreeMap<PathBuf, usize> {
    std::mem::take(&mut *lock(&CLEARED))
}

/// Removes a file or a folder, into which files may still be written. What cannot be removed is left; its name tells what
/// it is.
fn remove(path: &Path) {
    for _ in 0..REMOVALS {
        let removed = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
        if removed.is_ok() || !path.exists() {
            return;
        }
    }
}

fn lock<T>(mutex: &'static Mutex<T>) -> MutexGuard<'static, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
