//! Files that appear together or not at all.
//!
//! | function | what appears |
//! |---|---|
//! | [`write_file`] | one file |
//! | [`write_files`] | several files, in one folder or in several |
//! | [`write_folder`] | the files of a folder, which is made if it does not exist |
//!
//! Contents are staged beside their targets under names that begin with [`STAGED`], and written through to the disk.
//! A folder that does not exist is staged as a whole and renamed once. Several files for existing folders are renamed one
//! by one under a journal: an error takes back what was renamed before it; after a killed process or a power failure, the
//! next write into that folder completes the renames. What a killed process left staged is removed then, too;
//! [`clear_unfinished`] does so at any time, and [`take_cleared`] tells where something was found.
//!
//! What is staged is noted, so that [`abandon`] takes it along when a command is interrupted; renames that have begun are
//! done first. From then on nothing is staged, and no folder made: threads that would wait until the process ends.
//!
//! Links keep their place (what they point to is replaced); devices and the pipes of a shell are written to directly, last.
//! Pipes with names are refused: writing would wait for a reader, perhaps for ever.

mod journal;
mod json;
mod staging;
mod unfinished;

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use thiserror::Error;

use crate::output::{
    journal::Journal,
    staging::{Staged, folder_of, is_of_the_system, meant, sync_folder, write_special},
    unfinished::{make_folders, publishing},
};
pub use crate::output::{
    journal::clear_unfinished,
    json::pretty,
    staging::{StagedFolder, is_named_pipe},
    unfinished::{abandon, take_cleared},
};

/// What names of staged files begin with.
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

/// Writes a file as a whole.
///
/// # Errors
/// [`WriteError`]; then the file is as it was.
pub fn write_file(path: &Path, contents: &[u8]) -> Result<(), WriteError> {
    write_files(&[(path, contents)])
}

/// Writes a file that can be made again as a whole, without waiting for the disk: a power failure may lose it, and
/// nothing left by killed processes is looked for.
///
/// # Errors
/// [`WriteError`]; then the file is as it was.
pub fn write_file_unsynced(path: &Path, contents: &[u8]) -> Result<(), WriteError> {
    Staged::new(path, contents, Durability::Unsynced)?.publish(&publishing())
}

/// Writes several files, all or none. Folders that do not exist are made.
///
/// # Errors
/// [`WriteError`]; then every file is as it was.
pub fn write_files<P: AsRef<Path>, C: AsRef<[u8]>>(files: &[(P, C)]) -> Result<(), WriteError> {
    let mut folders: Vec<PathBuf> = Vec::new();
    let mut made = MadeFolders::default();
    let mut staged = Vec::new();
    let mut special = Vec::new();
    for (path, contents) in files {
        let path = path.as_ref();
        if is_named_pipe(path) {
            let source = io::Error::other("it is a pipe, which may have no reader; name a file");
            return Err(WriteError { path: path.to_owned(), source });
        }
        if is_of_the_system(path) || fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir()) {
            special.push((path.to_owned(), contents.as_ref()));
            continue;
        }
        let path = meant(path)?;
        let folder = folder_of(&path).to_owned();
        if !folders.contains(&folder) {
            made.make(&folder)?;
            clear_unfinished(&folder);
            folders.push(folder);
        }
        staged.push(Staged::new(&path, contents.as_ref(), Durability::Synced)?);
    }
    publish(staged)?;
    made.keep();
    for folder in &folders {
        sync_folder(folder);
    }
    let publishing = publishing();
    special.into_iter().try_for_each(|(path, contents)| {
        write_special(&path, contents)?;
        publishing.kept_one();
        Ok(())
    })
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
    let publishing = publishing();
    if staged.len() < 2 {
        return staged.pop().map_or(Ok(()), |one| one.publish(&publishing));
    }
    for one in &mut staged {
        one.keep_old()?;
    }
    let journal = Journal::write(&staged)?;
    let mut published = Vec::new();
    for one in staged {
        match one.rename() {
            Ok(done) => published.push(done),
            Err(error) => {
                published.into_iter().rev().for_each(staging::Published::take_back);
                return Err(error);
            }
        }
    }
    published.iter().for_each(|_| publishing.kept_one());
    // The journal and the second names go before an interruption may come.
    drop((journal, published));
    drop(publishing);
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
    if folder.exists() {
        let placed: Vec<(PathBuf, &[u8])> =
            files.iter().map(|(name, contents)| (folder.join(name), contents.as_ref())).collect();
        return write_files(&placed);
    }
    let parent = folder_of(folder);
    make_folders(parent).map_err(WriteError::at(parent))?;
    clear_unfinished(parent);
    let staging = StagedFolder::new(parent)?;
    let staged = staging.path();
    for (name, contents) in files {
        let path = staged.join(name);
        let fail = || WriteError::at(&folder.join(name));
        make_below(staged, name.as_ref()).map_err(fail())?;
        let mut file = fs::File::create_new(&path).map_err(fail())?;
        io::Write::write_all(&mut file, contents.as_ref()).and_then(|()| file.sync_data()).map_err(fail())?;
    }
    sync_folder(staged);
    let publishing = publishing();
    fs::rename(staged, folder).map_err(WriteError::at(folder))?;
    files.iter().for_each(|_| publishing.kept_one());
    // Nothing is left under its name to be removed.
    drop(staging);
    drop(publishing);
    sync_folder(parent);
    Ok(())
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

#[cfg(test)]
mod tests;
