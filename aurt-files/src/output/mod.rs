//! Files that appear together or not at all.
//!
//! | function | what appears |
//! |---|---|
//! | [`write_file`] | one file |
//! | [`write_outputs`] | several files, in one folder or in several |
//! | [`write_folder`] | the files of a folder, which is made if it does not exist |
//!
//! Contents are staged in a private folder beside their targets whose name begins with [`STAGED`], written through to the
//! disk and renamed. A folder that does not exist is staged as a whole and renamed once. Several files for existing folders
//! are renamed one by one: an error takes back what was renamed before it, and a process that is killed in between leaves
//! new files beside old ones, and the private folder. [`clear_unfinished`] and the next write to the same place remove that;
//! nothing in it is ever read, and [`take_cleared`] tells where something was found.
//!
//! A private folder is a [`Claim`]: other processes that want to write to the same place are refused as long as its process
//! lives. [`abandon`] removes those of this process when a command is interrupted; renames that have begun are done first.
//! From then on nothing is staged, and no folder made: threads that would wait until the process ends.
//!
//! Files that the program has read ([`crate::protect_inputs`]) are not replaced. Links that a person names keep their
//! place (what they point to is replaced), those among the files of a folder are replaced; devices and the pipes of a shell
//! are written to directly, last. Pipes with names are refused: writing would wait for a reader, perhaps for ever.

mod claim;
mod json;
mod staging;
mod target;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::{fs, io};

use thiserror::Error;

pub use crate::output::claim::{Claim, clear_unfinished, take_cleared};
use crate::output::claim::{abandon_claims, make_folders};
pub use crate::output::json::pretty;
use crate::output::staging::{Staged, sync_folder, write_special};
pub use crate::output::staging::{StagedFolder, is_named_pipe, is_special};
pub use crate::output::target::folder_of;
use crate::output::target::meant;
use crate::protected::lock;

/// Beginning of the names of private folders.
pub const STAGED: &str = ".aurt-";

/// A file or folder could not be written.
#[derive(Debug, Error)]
#[error("{}: cannot be written: {source}", path.display())]
pub struct WriteError {
    /// The file or folder.
    pub path: PathBuf,
    /// The system's reason.
    pub source: io::Error,
}

impl WriteError {
    fn at(path: &Path) -> impl FnOnce(io::Error) -> Self + use<> {
        let path = path.to_owned();
        |source| Self { path, source }
    }
}

/// Whether contents are written through to the disk before they appear.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Durability {
    Synced,
    Unsynced,
}

/// A file that is to be written.
#[derive(Debug, Clone, Copy)]
pub struct Output<'a> {
    /// Its path.
    pub path: &'a Path,
    /// The folder of results that it is part of; a link there is replaced.
    pub folder: Option<&'a Path>,
    /// What is to stand in it.
    pub contents: &'a [u8],
}

/// Writes a file as a whole.
///
/// # Errors
/// [`WriteError`]; then the file is as it was.
pub fn write_file(path: &Path, contents: &[u8]) -> Result<(), WriteError> {
    write_outputs(&[Output { path, folder: None, contents }])
}

/// Writes a file that can be made again as a whole, without waiting for the disk: a power failure may lose it.
///
/// # Errors
/// [`WriteError`]; then the file is as it was.
pub fn write_file_unsynced(path: &Path, contents: &[u8]) -> Result<(), WriteError> {
    refuse_input(path)?;
    let staged = Staged::new(path.to_owned(), contents, Durability::Unsynced, Claim::file(path)?)?;
    publish(vec![staged])
}

/// Writes several files, of which some may be named and others part of folders, all or none. Folders that do not exist are
/// made.
///
/// # Errors
/// [`WriteError`]; then every file is as it was.
pub fn write_outputs(outputs: &[Output<'_>]) -> Result<(), WriteError> {
    let mut made = MadeFolders::default();
    let mut claims = Vec::new();
    let mut staged = Vec::new();
    let mut special = Vec::new();
    for Output { path, folder, contents } in outputs {
        if folder.is_none() && is_named_pipe(path) {
            let source = io::Error::other("it is a pipe, which may have no reader; name a file");
            return Err(WriteError { path: path.to_path_buf(), source });
        }
        if folder.is_none() && is_special(path) {
            special.push((path, contents));
            continue;
        }
        refuse_input(path)?;
        let target =
            if folder.is_none() { meant(path).map_err(WriteError::at(path))? } else { path.to_path_buf() };
        made.make(folder_of(&target))?;
        let claim = match folder {
            Some(folder) => {
                let claim = Claim::folder(folder)?;
                claims.push(claim.clone());
                // A folder below may be of another file system.
                if folder_of(path) == *folder { claim } else { Claim::entry(path)? }
            }
            None => Claim::entry(&target)?,
        };
        staged.push(Staged::new(target, contents, Durability::Synced, claim)?);
    }
    publish(staged)?;
    made.keep();
    let mut kept = lock(&KEPT);
    special.into_iter().try_for_each(|(path, contents)| {
        write_special(path, contents)?;
        *kept += 1;
        Ok(())
    })
}

/// A file that the program has read stays as it is.
fn refuse_input(path: &Path) -> Result<(), WriteError> {
    if !crate::is_input(path) {
        return Ok(());
    }
    let reason = "this command has read it, so it is not overwritten; name another place for the results";
    Err(WriteError { path: path.to_owned(), source: io::Error::other(reason) })
}

/// Folders that are made for files; they go when the files cannot be written.
#[derive(Debug, Default)]
struct MadeFolders {
    deepest_first: Vec<PathBuf>,
}

impl MadeFolders {
    fn make(&mut self, folder: &Path) -> Result<(), WriteError> {
        let missing: Vec<PathBuf> = folder
            .ancestors()
            .take_while(|a| !a.as_os_str().is_empty() && !a.exists())
            .map(Path::to_owned)
            .collect();
        self.deepest_first.splice(0..0, missing);
        make_folders(folder).map_err(WriteError::at(folder))
    }

    fn keep(mut self) {
        self.deepest_first.clear();
    }
}

impl Drop for MadeFolders {
    fn drop(&mut self) {
        for folder in &self.deepest_first {
            // One that something else lies in stays.
            let _ = fs::remove_dir(folder);
        }
    }
}

/// Renames staged files to their targets, all or none.
fn publish(mut staged: Vec<Staged>) -> Result<(), WriteError> {
    let mut kept = lock(&KEPT);
    if staged.len() > 1 {
        staged.iter_mut().try_for_each(Staged::keep_old)?;
    }
    for k in 0..staged.len() {
        if let Err(error) = staged[k].rename() {
            staged.drain(..k).rev().for_each(Staged::take_back);
            return Err(error);
        }
    }
    *kept += staged.len();
    drop(kept);
    let folders: BTreeSet<PathBuf> = staged.iter().filter_map(Staged::folder_to_sync).collect();
    folders.iter().for_each(|folder| sync_folder(folder));
    Ok(())
}

/// Writes files of a folder, given by their names, all or none. The folder is made if it does not exist; files of other
/// names stay. Names may lead into folders below.
///
/// # Errors
/// [`WriteError`]; then the folder is as it was.
pub fn write_folder<N: AsRef<Path>, C: AsRef<[u8]>>(
    folder: &Path,
    files: &[(N, C)],
) -> Result<(), WriteError> {
    if !folder.exists() && write_new_folder(folder, files)? {
        return Ok(());
    }
    let paths: Vec<PathBuf> = files.iter().map(|(name, _)| folder.join(name)).collect();
    let outputs: Vec<Output<'_>> = paths
        .iter()
        .zip(files)
        .map(|(path, (_, contents))| Output { path, folder: Some(folder), contents: contents.as_ref() })
        .collect();
    write_outputs(&outputs)
}

/// Writes a folder that appears at once; whether it did, or somebody else has made it meanwhile.
fn write_new_folder<N: AsRef<Path>, C: AsRef<[u8]>>(
    folder: &Path,
    files: &[(N, C)],
) -> Result<bool, WriteError> {
    let parent = folder_of(folder);
    make_folders(parent).map_err(WriteError::at(parent))?;
    let claim = Claim::folder(folder)?;
    let staged = claim.fresh();
    fs::create_dir(&staged).map_err(WriteError::at(folder))?;
    for (name, contents) in files {
        let path = staged.join(name);
        let fail = || WriteError::at(&folder.join(name));
        make_below(&staged, name.as_ref()).map_err(fail())?;
        let mut file = fs::File::create_new(&path).map_err(fail())?;
        io::Write::write_all(&mut file, contents.as_ref()).and_then(|()| file.sync_data()).map_err(fail())?;
    }
    sync_folder(&staged);
    let mut kept = lock(&KEPT);
    match fs::rename(&staged, folder) {
        Ok(()) => *kept += files.len(),
        Err(_) if folder.is_dir() => return Ok(false),
        Err(error) => return Err(WriteError { path: folder.to_owned(), source: error }),
    }
    drop(kept);
    sync_folder(parent);
    Ok(true)
}

/// Makes the folders of a name below a folder, but never the folder itself: one that an interruption has removed stays
/// away.
fn make_below(folder: &Path, name: &Path) -> io::Result<()> {
    let mut below = folder.to_owned();
    for part in name.parent().into_iter().flat_map(Path::components) {
        below.push(part);
        match fs::create_dir(&below) {
            Err(error) if error.kind() != io::ErrorKind::AlreadyExists => return Err(error),
            _ => {}
        }
    }
    Ok(())
}

/// Files that have taken their names. Held while files take theirs, so that an interruption waits until all of them have them;
/// for good by an interrupted command.
static KEPT: Mutex<usize> = Mutex::new(0);

/// Removes everything that is being written and lets nothing be published any more; for the end of an interrupted
/// command, once: a second call waits for ever. Returns how many files had been written whole before.
pub fn abandon() -> usize {
    let publishing = lock(&KEPT);
    let kept = *publishing;
    // Kept for good: whoever publishes from now on waits until the process ends.
    std::mem::forget(publishing);
    abandon_claims();
    kept
}

#[cfg(test)]
mod tests;
