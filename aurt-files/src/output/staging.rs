//! Contents on the disk under a temporary name, and their way to the right one.

use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::output::claim::Claim;
use crate::output::target::folder_of;
use crate::output::{Durability, WriteError};

/// Asks the disk to keep the names in a folder. Systems whose folders cannot be opened keep them anyway.
pub(crate) fn sync_folder(folder: &Path) {
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
}

/// A folder to make files in before they are moved to their places. It is removed when it is dropped or the command is
/// interrupted; [`clear_unfinished`](crate::output::clear_unfinished) removes that of a killed process.
#[derive(Debug)]
pub struct StagedFolder {
    path: PathBuf,
    _claim: Claim,
}

impl StagedFolder {
    /// Makes one in a folder that exists.
    ///
    /// # Errors
    /// [`WriteError`] with `parent`.
    pub fn new(parent: &Path) -> Result<Self, WriteError> {
        let made = || {
            let claim = Claim::own(parent)?;
            let path = claim.fresh();
            fs::create_dir(&path)?;
            Ok(Self { path, _claim: claim })
        };
        made().map_err(WriteError::at(parent))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Contents that are on the disk under a temporary name.
#[derive(Debug)]
pub(crate) struct Staged {
    part: PathBuf,
    target: PathBuf,
    /// A second name of what is to be replaced.
    old: Option<PathBuf>,
    durability: Durability,
    claim: Claim,
}

impl Staged {
    pub(crate) fn new(
        target: PathBuf,
        contents: &[u8],
        durability: Durability,
        claim: Claim,
    ) -> Result<Self, WriteError> {
        let part = claim.fresh();
        let mut file = File::create_new(&part).map_err(WriteError::at(&target))?;
        file.write_all(contents).map_err(WriteError::at(&target))?;
        if durability == Durability::Synced {
            file.sync_data().map_err(WriteError::at(&target))?;
        }
        Ok(Self { part, target, old: None, durability, claim })
    }

    /// Gives what is to be replaced a second name, from which it can come back.
    pub(crate) fn keep_old(&mut self) -> Result<(), WriteError> {
        let Ok(found) = self.target.symlink_metadata() else { return Ok(()) };
        if found.is_dir() {
            return Ok(());
        }
        let old = self.claim.fresh();
        // File systems without hard links get a copy.
        let copied =
            |error| if found.is_file() { fs::copy(&self.target, &old).map(drop) } else { Err(error) };
        fs::hard_link(&self.target, &old).or_else(copied).map_err(WriteError::at(&self.target))?;
        self.old = Some(old);
        Ok(())
    }

    pub(crate) fn rename(&self) -> Result<(), WriteError> {
        fs::rename(&self.part, &self.target).map_err(WriteError::at(&self.target))
    }

    /// The folder whose new names the disk has to keep.
    pub(crate) fn folder_to_sync(&self) -> Option<PathBuf> {
        (self.durability == Durability::Synced).then(|| folder_of(&self.target).to_owned())
    }

    /// Puts things back as they were before the renaming, as far as the file system still lets us.
    pub(crate) fn take_back(self) {
        let _ = match self.old {
            Some(old) => fs::rename(old, &self.target),
            None => fs::remove_file(&self.target),
        };
    }
}

/// Writes to a device or pipe, which cannot be renamed over. A reader that has seen enough is no failure.
pub(crate) fn write_special(path: &Path, contents: &[u8]) -> Result<(), WriteError> {
    // What standard output leads to may be a file that something stands in already.
    match fs::OpenOptions::new().append(true).open(path).and_then(|mut file| file.write_all(contents)) {
        Err(source) if source.kind() != ErrorKind::BrokenPipe => {
            Err(WriteError { path: path.to_owned(), source })
        }
        _ => Ok(()),
    }
}

/// Whether a path is a device, a pipe, or a name for something that the system keeps open (`/dev/stdout`,
/// `/proc/self/fd/1`): what it leads to may have another name or none, and is written to as it is.
pub fn is_special(path: &Path) -> bool {
    is_of_the_system(path) || fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

fn is_of_the_system(path: &Path) -> bool {
    let folder = fs::canonicalize(folder_of(path));
    folder.is_ok_and(|folder| {
        folder.starts_with("/dev") && !folder.starts_with("/dev/shm") || folder.starts_with("/proc")
    })
}

/// Whether a path is a pipe that was made with a name (`mkfifo`).
#[cfg(unix)]
pub fn is_named_pipe(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    fs::metadata(path).is_ok_and(|found| found.file_type().is_fifo()) && !is_of_the_system(path)
}

/// Only Unix has them in folders.
#[cfg(not(unix))]
pub fn is_named_pipe(_path: &Path) -> bool {
    false
}
