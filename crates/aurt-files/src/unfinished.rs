//! Files that are being written, so that a command that is interrupted takes them along and leaves whole results alone.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
    sync::{
        Mutex, MutexGuard, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    time::{Duration, SystemTime},
};

/// Begin of the names of files and folders that are being written.
pub const PART_PREFIX: &str = ".aurt-";
/// End of the names of files and folders that are being written.
pub const PART_SUFFIX: &str = ".part";
/// Age from which such a file is a killed command's: writing one takes seconds.
const ABANDONED: Duration = Duration::from_secs(3600);

/// What is being written now, in the whole process.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
/// Folders in which what was abandoned has been looked for.
static SEEN: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
/// Held while finished files take their names.
static PUBLISHING: Mutex<()> = Mutex::new(());
/// Files that have taken their names.
static KEPT: AtomicUsize = AtomicUsize::new(0);

/// A file or folder that is being written, until this is dropped.
#[derive(Debug)]
pub struct Unfinished {
    path: PathBuf,
}

impl Unfinished {
    /// Notes that `path` is being written. What killed commands left beside it an hour ago or more is removed.
    #[must_use]
    pub fn new(path: &Path) -> Self {
        if let Some(folder) = path.parent()
            && lock(&SEEN).insert(folder.to_owned())
        {
            remove_abandoned(folder);
        }
        lock(&UNFINISHED).insert(path.to_owned());
        Self { path: path.to_owned() }
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        lock(&UNFINISHED).remove(&self.path);
    }
}

/// Held by whoever gives finished files their names: an interruption waits until all of them have theirs.
#[derive(Debug)]
pub struct Publishing {
    _held: MutexGuard<'static, ()>,
}

/// Waits until nobody else publishes, or for ever if the command is being ended.
#[must_use]
pub fn publishing() -> Publishing {
    Publishing { _held: lock(&PUBLISHING) }
}

impl Publishing {
    /// Notes that a file has its name.
    pub fn kept_one(&self) {
        KEPT.fetch_add(1, Ordering::Relaxed);
    }
}

/// Removes everything that is being written and lets nothing be published any more; for the end of an interrupted
/// command. Returns how many files had been written whole before.
#[must_use]
pub fn abandon() -> usize {
    // Kept for good: whoever publishes from now on waits until the process ends.
    std::mem::forget(publishing());
    for path in lock(&UNFINISHED).iter() {
        // What cannot be removed is left; its name tells what it is.
        let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    }
    KEPT.load(Ordering::Relaxed)
}

fn remove_abandoned(folder: &Path) {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let ours = name.to_str().is_some_and(|n| n.starts_with(PART_PREFIX) && n.ends_with(PART_SUFFIX));
        if !ours {
            continue;
        }
        let changed = entry.metadata().and_then(|m| m.modified());
        let age = changed.ok().and_then(|at| SystemTime::now().duration_since(at).ok());
        if age.is_some_and(|age| age > ABANDONED) {
            let path = entry.path();
            // It is in nobody's way if it stays.
            let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
        }
    }
}

fn lock<T>(mutex: &'static Mutex<T>) -> MutexGuard<'static, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_parts_go_and_others_stay() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let long_ago = SystemTime::now() - Duration::from_secs(7200);
        for name in [".aurt-old.part", ".aurt-new.part", "mine.part"] {
            let file = fs::File::create(path(name)).unwrap();
            if name != ".aurt-new.part" {
                file.set_modified(long_ago).unwrap();
            }
        }
        drop(Unfinished::new(&path(".aurt-x.part")));
        assert!(!path(".aurt-old.part").exists());
        assert!(path(".aurt-new.part").exists() && path("mine.part").exists());
    }
}
