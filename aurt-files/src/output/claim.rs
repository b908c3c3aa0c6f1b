//! Claims: what a process holds while it writes somewhere, and where it stages what it writes.
//!
//! A claim is a private folder with a locked file in it. The lock dies with its process, so a claim that nobody holds is of a
//! killed one: whoever takes it next, or clears the folder that it lies in, removes what is in it. Nothing in a claim is
//! ever read, and none that belongs to another user is touched.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::fs::{self, File, TryLockError};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, Weak};
use std::time::{Duration, Instant};
use std::{process, thread};

use crate::output::target::{folder_of, meant};
use crate::output::{STAGED, WriteError};
use crate::protected::lock;

const PART: &str = ".part";
const LOCK: &str = "lock";
/// Bytes of a name that a claim takes over; names of files have 255 at most.
const MOST_NAME_BYTES: usize = 200;
/// How long another process may hold a claim before it counts as another run: whoever clears a folder holds it for a moment.
const PATIENCE: Duration = Duration::from_secs(1);
const EVERY: Duration = Duration::from_millis(10);
/// How often a folder is removed that others still write into.
const REMOVALS: usize = 100;

/// The claims of this process by their folders. Held for good by an interrupted command: nothing new is begun.
static HELD: Mutex<BTreeMap<PathBuf, Weak<Held>>> = Mutex::new(BTreeMap::new());
/// Claims of killed processes that were removed, by the folder that they lay in.
static CLEARED: Mutex<BTreeMap<PathBuf, usize>> = Mutex::new(BTreeMap::new());
/// Numbers of staged files and folders.
static NEXT: AtomicUsize = AtomicUsize::new(0);

/// A place that no other process writes to as long as this, or a copy of it, is held.
///
/// Without locks (some network file systems) it excludes nobody, and what killed processes leave is not removed.
#[derive(Debug, Clone)]
pub struct Claim(Arc<Held>);

#[derive(Debug)]
struct Held {
    folder: PathBuf,
    /// None where the file system has no locks.
    lock: Option<File>,
}

impl Claim {
    /// Claims a file that is to be written, or what a link of that name leads to.
    ///
    /// # Errors
    /// [`WriteError`], of kind [`ErrorKind::ResourceBusy`] where another process holds it.
    pub fn file(path: &Path) -> Result<Self, WriteError> {
        meant(path).and_then(|path| beside(&path)).and_then(take).map_err(WriteError::at(path))
    }

    /// Claims an entry of a folder, be it a link or not.
    pub(crate) fn entry(path: &Path) -> Result<Self, WriteError> {
        beside(path).and_then(take).map_err(WriteError::at(path))
    }

    /// Claims a folder that is to be filled: one that exists, or one that is to appear in a folder that exists.
    ///
    /// # Errors
    /// As [`Self::file`].
    pub fn folder(path: &Path) -> Result<Self, WriteError> {
        let claimed = || {
            if !path.is_dir() {
                let claim = take(beside(path)?)?;
                // Whoever held it before may have made the folder.
                if !path.is_dir() {
                    return Ok(claim);
                }
            }
            let path = fs::canonicalize(path)?;
            // A run that found no folder holds the place beside it until its end; what else lies there is no obstacle.
            if let Some(beside) = beside(&path).ok().filter(|beside| beside.is_dir())
                && let Err(error) = take(beside)
                && error.kind() == ErrorKind::ResourceBusy
            {
                return Err(error);
            }
            take(path.join(named(OsStr::new(""))))
        };
        claimed().map_err(WriteError::at(path))
    }

    pub(crate) fn own(parent: &Path) -> io::Result<Self> {
        let parent = fs::canonicalize(parent)?;
        loop {
            let folder = parent.join(named(&fresh_name()));
            let mut held = lock(&HELD);
            // What has that name already is of an earlier process of that number, or of another machine.
            if folder.symlink_metadata().is_ok() {
                continue;
            }
            if let Some(claim) = try_take(&folder, Missing::Make)? {
                return Ok(enter(&mut held, claim));
            }
        }
    }

    pub(crate) fn fresh(&self) -> PathBuf {
        self.0.folder.join(fresh_name())
    }
}

impl Drop for Held {
    /// Waits for ever if the command is being ended, which removes the folder itself.
    fn drop(&mut self) {
        let mut held = lock(&HELD);
        empty(&self.folder);
        // The lock goes last: another process may claim the place from then on.
        let _ = fs::remove_file(self.folder.join(LOCK));
        let _ = fs::remove_dir(&self.folder);
        drop(self.lock.take());
        if held.get(&self.folder).is_some_and(|known| known.strong_count() == 0) {
            held.remove(&self.folder);
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Missing {
    Make,
    Leave,
}

fn fresh_name() -> OsString {
    format!("{}-{}", process::id(), NEXT.fetch_add(1, Ordering::Relaxed)).into()
}

fn named(name: &OsStr) -> OsString {
    let bytes = name.as_encoded_bytes();
    let mut claim = OsString::from(STAGED);
    if bytes.len() > MOST_NAME_BYTES {
        let mut hash = DefaultHasher::new();
        bytes.hash(&mut hash);
        claim.push(format!("{:016x}", hash.finish()));
    } else {
        claim.push(name);
    }
    claim.push(PART);
    claim
}

/// The claim on something in a folder that exists.
fn beside(path: &Path) -> io::Result<PathBuf> {
    let name = path.file_name().ok_or_else(|| io::Error::new(ErrorKind::InvalidInput, "it has no name"))?;
    Ok(fs::canonicalize(folder_of(path))?.join(named(name)))
}

/// Takes a claim, or hands on the one that this process has already.
fn take(folder: PathBuf) -> io::Result<Claim> {
    let begin = Instant::now();
    loop {
        let mut held = lock(&HELD);
        if let Some(known) = held.get(&folder).and_then(Weak::upgrade) {
            return Ok(Claim(known));
        }
        if let Some(claim) = try_take(&folder, Missing::Make)? {
            return Ok(enter(&mut held, claim));
        }
        drop(held);
        if begin.elapsed() > PATIENCE {
            let reason = "another run writes there; wait until it has ended, or name another place";
            return Err(io::Error::new(ErrorKind::ResourceBusy, reason));
        }
        thread::sleep(EVERY);
    }
}

fn enter(held: &mut BTreeMap<PathBuf, Weak<Held>>, claim: Held) -> Claim {
    let claim = Arc::new(claim);
    held.insert(claim.folder.clone(), Arc::downgrade(&claim));
    Claim(claim)
}

/// Takes a claim that no other process has, and empties it; none where one has it or is about to take it or leave it.
fn try_take(folder: &Path, missing: Missing) -> io::Result<Option<Held>> {
    if missing == Missing::Make {
        match make_private(folder) {
            Err(error) if error.kind() != ErrorKind::AlreadyExists => return Err(error),
            _ => {}
        }
    }
    match is_own(folder) {
        Ok(true) => {}
        Ok(false) => {
            let reason = format!(
                "the place for unfinished results, {}, is no folder of yours alone; remove it, or name another place",
                folder.display()
            );
            return Err(io::Error::new(ErrorKind::PermissionDenied, reason));
        }
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error),
    }
    let path = folder.join(LOCK);
    match path.symlink_metadata() {
        Ok(found) if !found.is_file() => remove(&path)?,
        Ok(_) => {}
        // Its process is about to make it, or was killed then.
        Err(_) if missing == Missing::Leave => {
            return fs::remove_dir(folder).map(|()| None);
        }
        Err(_) => {}
    }
    let opened = File::options().create(missing == Missing::Make).truncate(false).write(true).open(&path);
    let file = match opened {
        Ok(file) => file,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error),
    };
    let folder = folder.to_owned();
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => return Ok(None),
        Err(TryLockError::Error(_)) if missing == Missing::Make => {
            return Ok(Some(Held { folder, lock: None }));
        }
        Err(TryLockError::Error(error)) => return Err(error),
    }
    // Whoever held it until now may have removed the file that was opened.
    if !is_still(&path, &file) {
        return Ok(None);
    }
    if empty(&folder) > 0 || missing == Missing::Leave {
        *lock(&CLEARED).entry(folder_of(&folder).to_owned()).or_default() += 1;
    }
    Ok(Some(Held { folder, lock: Some(file) }))
}

#[cfg(unix)]
fn make_private(folder: &Path) -> io::Result<()> {
    use std::os::unix::fs::DirBuilderExt;
    fs::DirBuilder::new().mode(0o700).create(folder)
}

#[cfg(not(unix))]
fn make_private(folder: &Path) -> io::Result<()> {
    fs::create_dir(folder)
}

/// Whether a path is a folder, no link to one, of the user of this process and of nobody else.
#[cfg(unix)]
fn is_own(folder: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let found = folder.symlink_metadata()?;
    let is_private = found.mode() & 0o022 == 0;
    Ok(found.is_dir() && is_private && found.uid() == rustix::process::geteuid().as_raw())
}

#[cfg(not(unix))]
fn is_own(folder: &Path) -> io::Result<bool> {
    Ok(folder.symlink_metadata()?.is_dir())
}

#[cfg(unix)]
fn is_still(path: &Path, file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    let same = |a: fs::Metadata, b: fs::Metadata| (a.dev(), a.ino()) == (b.dev(), b.ino());
    path.symlink_metadata().ok().zip(file.metadata().ok()).is_some_and(|(a, b)| same(a, b))
}

/// Files that are open elsewhere keep their names.
#[cfg(not(unix))]
fn is_still(path: &Path, _: &File) -> bool {
    path.is_file()
}

/// Removes what is in a claim, but for its lock; how much there was. What cannot be removed is left; its name tells what it
/// is.
fn empty(folder: &Path) -> usize {
    let Ok(entries) = fs::read_dir(folder) else { return 0 };
    let left = entries.flatten().filter(|entry| entry.file_name() != LOCK).map(|entry| entry.path());
    left.filter(|path| remove(path).is_ok()).count()
}

fn remove(path: &Path) -> io::Result<()> {
    if path.symlink_metadata()?.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) }
}

/// Removes what killed processes left staged in a folder. What belongs to living processes, or to other users, stays; what
/// cannot be removed is in nobody's way.
pub fn clear_unfinished(folder: &Path) {
    let is_claim = |name: &OsStr| {
        let name = name.as_encoded_bytes();
        name.starts_with(STAGED.as_bytes()) && name.ends_with(PART.as_bytes())
    };
    let Ok(folder) = fs::canonicalize(folder) else { return };
    let Ok(entries) = fs::read_dir(&folder) else { return };
    for path in entries.flatten().filter(|entry| is_claim(&entry.file_name())).map(|entry| entry.path()) {
        let held = lock(&HELD);
        let is_abandoned = !held.contains_key(&path) && is_own(&path).unwrap_or(false);
        let taken = if is_abandoned { try_take(&path, Missing::Leave).ok().flatten() } else { None };
        // The end of a claim removes it, and needs the list.
        drop(held);
        drop(taken);
    }
}

/// The folders in which this process has removed what killed processes had left, each with the number of claims; nothing of
/// what an earlier call has returned.
pub fn take_cleared() -> BTreeMap<PathBuf, usize> {
    std::mem::take(&mut *lock(&CLEARED))
}

/// Makes folders for what is going to be written. After an interruption none is made: it could be one that was removed.
pub(crate) fn make_folders(path: &Path) -> io::Result<()> {
    let _held = lock(&HELD);
    fs::create_dir_all(path)
}

/// Removes all claims of this process, once; from then on whoever takes, makes or leaves one waits until the process ends.
pub(crate) fn abandon_claims() {
    let held = lock(&HELD);
    for folder in held.keys() {
        for _ in 0..REMOVALS {
            empty(folder);
            let _ = fs::remove_file(folder.join(LOCK));
            // Other threads may still write into it, and another process may claim the place now.
            if fs::remove_dir(folder).is_ok() || !folder.exists() || folder.join(LOCK).exists() {
                break;
            }
        }
    }
    std::mem::forget(held);
}
