//! Contents on the disk under a temporary name, and their way to the right one.

use std::{
    fs::{self, File},
    io::{ErrorKind, Write},
    path::{Path, PathBuf},
};

use tempfile::{Builder, NamedTempFile, TempDir};

use crate::output::{
    Durability, STAGED, WriteError,
    unfinished::{Publishing, Unfinished},
};

/// What names of staged contents end with.
pub(crate) const PART: &str = ".part";
/// What names of files that are about to be replaced end with.
const OLD: &str = ".old";

/// The folder that a path lies in.
pub(crate) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// A builder of names that gives what any new file or folder gets; the umask takes away what it should.
pub(crate) fn named(suffix: &'static str, mode: u32) -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(STAGED).suffix(suffix);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(mode));
    }
    #[cfg(not(unix))]
    let _ = mode;
    builder
}

/// Marks a staged file or folder as that of a living process. File systems without locks do without the mark: then
/// nothing of a killed process is removed either.
pub(crate) fn mark(file: &File) {
    let _ = file.try_lock();
}

/// Asks the disk to keep the names in a folder. Systems whose folders cannot be opened keep them anyway.
pub(crate) fn sync_folder(folder: &Path) {
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
}

/// A folder to make files in before they are moved to their places. It is removed when it is dropped or the command is
/// interrupted; [`clear_unfinished`](crate::output::clear_unfinished) removes that of a killed process.
#[derive(Debug)]
pub struct StagedFolder {
    folder: TempDir,
    _marked: Option<File>,
    _unfinished: Unfinished,
}

impl StagedFolder {
    /// Makes one in a folder that exists.
    ///
    /// # Errors
    /// [`WriteError`] with `parent`.
    pub fn new(parent: &Path) -> Result<Self, WriteError> {
        let (folder, unfinished) =
            Unfinished::made(|| named(PART, 0o777).tempdir_in(parent), |folder| folder.path())
                .map_err(WriteError::at(parent))?;
        let marked = File::open(folder.path()).ok();
        marked.iter().for_each(mark);
        Ok(Self { folder, _marked: marked, _unfinished: unfinished })
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// Contents that are on the disk under a temporary name.
#[derive(Debug)]
pub(crate) struct Staged {
    file: NamedTempFile,
    target: PathBuf,
    old: Option<NamedTempFile<()>>,
    unfinished: Unfinished,
}

impl Staged {
    pub(crate) fn new(target: &Path, contents: &[u8], durability: Durability) -> Result<Self, WriteError> {
        let fail = || WriteError::at(target);
        let (mut file, unfinished) = Unfinished::made(
            || named(PART, 0o666).tempfile_in(folder_of(target)),
            |file: &NamedTempFile| file.path(),
        )
        .map_err(fail())?;
        mark(file.as_file());
        file.write_all(contents).map_err(fail())?;
        if durability == Durability::Synced {
            file.as_file().sync_data().map_err(fail())?;
        }
        Ok(Self { file, target: target.to_owned(), old: None, unfinished })
    }

    /// The temporary name.
    pub(crate) fn part(&self) -> &Path {
        self.file.path()
    }

    /// The right name.
    pub(crate) fn target(&self) -> &Path {
        &self.target
    }

    /// The second name of what is to be replaced.
    pub(crate) fn old(&self) -> Option<&Path> {
        self.old.as_ref().map(NamedTempFile::path)
    }

    /// Gives what is to be replaced a second name, from which it can come back.
    pub(crate) fn keep_old(&mut self) -> Result<(), WriteError> {
        if !self.target.is_file() {
            return Ok(());
        }
        let second_name = |path: &Path| {
            // File systems without hard links get a copy.
            fs::hard_link(&self.target, path).or_else(|_| fs::copy(&self.target, path).map(drop))
        };
        let old = named(OLD, 0o666).make_in(folder_of(&self.target), second_name);
        self.old = Some(old.map_err(WriteError::at(&self.target))?);
        Ok(())
    }

    /// Gives the contents their right name.
    pub(crate) fn publish(self, publishing: &Publishing) -> Result<(), WriteError> {
        self.rename()?;
        publishing.kept_one();
        Ok(())
    }

    /// The same, and it can be taken back.
    pub(crate) fn rename(self) -> Result<Published, WriteError> {
        let Self { file, target, old, unfinished } = self;
        file.persist(&target).map_err(|e| WriteError { path: target.clone(), source: e.error })?;
        drop(unfinished);
        Ok(Published { target, old })
    }
}

/// A file that has replaced another.
#[derive(Debug)]
pub(crate) struct Published {
    target: PathBuf,
    old: Option<NamedTempFile<()>>,
}

impl Published {
    /// Puts things back as they were, as far as the file system still lets us.
    pub(crate) fn take_back(self) {
        let _ = match self.old {
            Some(old) => old.persist(&self.target).map(drop).map_err(|e| e.error),
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

/// Whether a name stands for something that the system keeps open (`/dev/stdout`, `/proc/self/fd/1`): what it leads to
/// may have another name or none, and is written to as it is.
pub(crate) fn is_of_the_system(path: &Path) -> bool {
    let folder = fs::canonicalize(folder_of(path));
    folder.is_ok_and(|folder| {
        folder.starts_with("/dev") && !folder.starts_with("/dev/shm") || folder.starts_with("/proc")
    })
}

/// Whether a path is a pipe that was made with a name (`mkfifo`).
#[cfg(unix)]
#[must_use]
pub fn is_named_pipe(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    fs::metadata(path).is_ok_and(|found| found.file_type().is_fifo()) && !is_of_the_system(path)
}

/// Only Unix has them in folders.
#[cfg(not(unix))]
#[must_use]
pub fn is_named_pipe(_path: &Path) -> bool {
    false
}

/// The file that a path means: links keep their place, and what they point to is replaced, or made if it is not there
/// yet.
pub(crate) fn meant(path: &Path) -> Result<PathBuf, WriteError> {
    fs::canonicalize(path).or_else(|_| linked(path)).map_err(WriteError::at(path))
}

/// Where a link leads that leads nowhere yet; the path itself if it is no link.
fn linked(path: &Path) -> std::io::Result<PathBuf> {
    let Ok(target) = fs::read_link(path) else { return Ok(path.to_owned()) };
    let target = folder_of(path).join(target);
    match fs::symlink_metadata(&target) {
        Ok(found) if found.is_symlink() => {
            Err(std::io::Error::other("it is a link to a link that leads nowhere; name the file itself"))
        }
        _ => Ok(target),
    }
}
