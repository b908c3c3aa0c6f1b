//! Writing results so that nobody ever reads half of one: into a temporary file in the same folder, then
//! renamed. Whether a path can be written at all is asked before any work is done.

use std::{
    fs,
    io::{ErrorKind, Write},
    path::{Path, PathBuf},
};

use aurt_files::{PART_PREFIX, PART_SUFFIX, Publishing, Unfinished, publishing};

use crate::failure::Failure;

/// A file that a command is going to write.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OutputFile {
    path: PathBuf,
}

impl OutputFile {
    /// Checks that `path` can become a file and is none of `inputs`.
    ///
    /// # Errors
    /// [`Failure::Output`] if the path is a folder, its folder does not exist, or it is an input.
    pub fn new(option: &'static str, path: &Path, inputs: &[&Path]) -> Result<Self, Failure> {
        let refuse = |reason: &str, remedy: &str| Failure::Output {
            option,
            path: path.to_owned(),
            reason: reason.to_owned(),
            remedy: remedy.to_owned(),
        };
        if path.as_os_str().is_empty() {
            return Err(refuse("is empty", "name a file"));
        }
        if path.is_dir() {
            return Err(refuse("is a folder", "name a file in it"));
        }
        let folder = folder_of(path);
        if !folder.is_dir() {
            let reason = format!("lies in {}, which is not an existing folder", folder.display());
            return Err(refuse(&reason, "create the folder first"));
        }
        let same = |input: &&&Path| match (fs::canonicalize(path), fs::canonicalize(input)) {
            (Ok(output), Ok(input)) => output == input,
            _ => false,
        };
        if inputs.iter().any(|input| same(&input)) {
            return Err(refuse("is an input of this command and would be overwritten", "name another file"));
        }
        Ok(Self { path: path.to_owned() })
    }

    /// The path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the whole file or, on failure, nothing.
    ///
    /// # Errors
    /// [`Failure::Write`].
    pub fn write(&self, contents: &[u8]) -> Result<(), Failure> {
        Staged::new(&self.path, contents)?.publish(&publishing())
    }
}

/// Checks that outputs of one command do not overwrite each other.
///
/// # Errors
/// [`Failure::Output`].
pub fn distinct(outputs: &[(&'static str, &Path)]) -> Result<(), Failure> {
    for (i, (option, path)) in outputs.iter().enumerate() {
        if let Some((other, _)) = outputs[..i].iter().find(|(_, p)| p == path) {
            return Err(Failure::Output {
                option,
                path: path.to_path_buf(),
                reason: format!("is the file of {other} too"),
                remedy: "name another file".into(),
            });
        }
    }
    Ok(())
}

/// A folder that a command fills with several files, all or none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OutputFolder {
    path: PathBuf,
}

impl OutputFolder {
    /// Checks that `path` is a folder or can become one.
    ///
    /// # Errors
    /// [`Failure::Output`].
    pub fn new(option: &'static str, path: &Path) -> Result<Self, Failure> {
        let refuse = |reason: String, remedy: &str| Failure::Output {
            option,
            path: path.to_owned(),
            reason,
            remedy: remedy.to_owned(),
        };
        if path.as_os_str().is_empty() {
            return Err(refuse("is empty".into(), "name a folder"));
        }
        if path.exists() && !path.is_dir() {
            return Err(refuse("is a file, a folder is needed".into(), "name another folder"));
        }
        let parent = folder_of(path);
        if !path.exists() && !parent.is_dir() {
            let reason = format!("lies in {}, which is not an existing folder", parent.display());
            return Err(refuse(reason, "create that folder first"));
        }
        Ok(Self { path: path.to_owned() })
    }

    /// The same for a folder whose own folder may have to be made, such as one within another output.
    ///
    /// # Errors
    /// [`Failure::Output`].
    pub fn nested(option: &'static str, path: &Path) -> Result<Self, Failure> {
        let known = path.ancestors().find(|a| a.as_os_str().is_empty() || a.exists()).unwrap_or(path);
        if path.as_os_str().is_empty() || known.is_file() {
            return Self::new(option, known);
        }
        Ok(Self { path: path.to_owned() })
    }

    /// The path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes all files, given by their names, or, on failure, none.
    ///
    /// # Errors
    /// [`Failure::Write`].
    pub fn write(&self, files: &[(String, Vec<u8>)]) -> Result<(), Failure> {
        let created = !self.path.exists();
        if created {
            fs::create_dir_all(&self.path)
                .map_err(|source| Failure::Write { path: self.path.clone(), source })?;
        }
        let staged: Result<Vec<Staged>, Failure> =
            files.iter().map(|(name, contents)| Staged::new(&self.path.join(name), contents)).collect();
        let result = staged.and_then(|staged| {
            let publishing = publishing();
            staged.into_iter().try_for_each(|one| one.publish(&publishing))
        });
        if result.is_err() && created {
            // Nothing but our own temporary files was in it, and these are gone.
            let _ = fs::remove_dir(&self.path);
        }
        result
    }
}

/// Contents that are on the disk under a temporary name.
#[derive(Debug)]
enum Staged {
    Regular {
        file: tempfile::NamedTempFile,
        path: PathBuf,
        _unfinished: Unfinished,
    },
    /// A device or pipe cannot be renamed over.
    Special {
        contents: Vec<u8>,
        path: PathBuf,
    },
}

impl Staged {
    fn new(path: &Path, contents: &[u8]) -> Result<Self, Failure> {
        let fail = |source| Failure::Write { path: path.to_owned(), source };
        check_finite(path, contents)?;
        if is_of_the_system(path) || fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir()) {
            return Ok(Self::Special { contents: contents.to_owned(), path: path.to_owned() });
        }
        // A link keeps its place: what it points to is replaced, or made if it is not there yet.
        let path = fs::canonicalize(path).or_else(|_| linked(path)).map_err(fail)?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(PART_PREFIX).suffix(PART_SUFFIX);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // What any new file gets; the umask takes away what it should.
            builder.permissions(fs::Permissions::from_mode(0o666));
        }
        let mut file = builder.tempfile_in(folder_of(&path)).map_err(fail)?;
        let unfinished = Unfinished::new(file.path());
        file.write_all(contents).and_then(|()| file.flush()).map_err(fail)?;
        Ok(Self::Regular { file, path, _unfinished: unfinished })
    }

    fn publish(self, publishing: &Publishing) -> Result<(), Failure> {
        publishing.kept_one();
        match self {
            Self::Regular { file, path, .. } => {
                file.persist(&path).map(drop).map_err(|e| Failure::Write { path, source: e.error })
            }
            Self::Special { contents, path } => match append(&path, &contents) {
                Err(source) if source.kind() != ErrorKind::BrokenPipe => Err(Failure::Write { path, source }),
                _ => Ok(()),
            },
        }
    }
}

/// Refuses tables in which a number is none: whatever made it is worth more than the table.
fn check_finite(path: &Path, contents: &[u8]) -> Result<(), Failure> {
    if path.extension().is_some_and(|extension| extension != "csv") {
        return Ok(());
    }
    let none = |cell: &[u8]| matches!(cell.trim_ascii(), b"NaN" | b"inf" | b"-inf");
    let found = contents.split(|b| *b == b'\n').position(|line| line.split(|b| *b == b',').any(none));
    found.map_or(Ok(()), |line| Err(Failure::NotFinite { path: path.to_owned(), line: line + 1 }))
}

/// Whether a name stands for something that the system keeps open (`/dev/stdout`, `/proc/self/fd/1`): what it leads to
/// may have another name or none, and is written to as it is.
fn is_of_the_system(path: &Path) -> bool {
    let folder = fs::canonicalize(folder_of(path));
    folder.is_ok_and(|folder| {
        folder.starts_with("/dev") && !folder.starts_with("/dev/shm") || folder.starts_with("/proc")
    })
}

/// Where a link leads that leads nowhere yet; the path itself if it is no link.
fn linked(path: &Path) -> std::io::Result<PathBuf> {
    match fs::read_link(path) {
        Ok(target) => {
            let target = folder_of(path).join(target);
            match fs::symlink_metadata(&target) {
                Ok(found) if found.is_symlink() => Err(std::io::Error::other(
                    "it is a link to a link that leads nowhere; name the file itself",
                )),
                _ => Ok(target),
            }
        }
        Err(_) => Ok(path.to_owned()),
    }
}

/// Writes to what is there and stays there.
fn append(path: &Path, contents: &[u8]) -> std::io::Result<()> {
    let mut file = fs::File::options().append(true).open(path)?;
    file.write_all(contents).and_then(|()| file.flush())
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_as_a_whole_and_leaves_nothing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        fs::write(&path, "old").unwrap();
        OutputFile::new("--out", &path, &[]).unwrap().write(b"new").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn impossible_outputs_are_refused_before_any_work() {
        let folder = tempfile::tempdir().unwrap();
        let input = folder.path().join("in.csv");
        fs::write(&input, "x").unwrap();
        let refusal = |path: &Path| OutputFile::new("--out", path, &[&input]).unwrap_err().to_string();
        assert!(refusal(folder.path()).contains("is a folder"));
        assert!(refusal(&folder.path().join("no/b.csv")).contains("not an existing folder"));
        assert!(refusal(&input).contains("is an input"));
        assert!(OutputFolder::new("--out", &input).unwrap_err().to_string().contains("is a file"));
        let same = [("--out", input.as_path()), ("--out-params", input.as_path())];
        assert!(distinct(&same).unwrap_err().to_string().contains("is the file of --out too"));
    }

    #[test]
    fn a_folder_that_cannot_be_filled_is_not_left_behind() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let files = [("a".to_owned(), b"1".to_vec()), ("no/b".to_owned(), b"2".to_vec())];
        assert!(OutputFolder::new("--out", &out).unwrap().write(&files).is_err());
        assert!(!out.exists());
    }

    #[cfg(unix)]
    #[test]
    fn new_files_get_the_permissions_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let plain = folder.path().join("plain");
        fs::write(&plain, "").unwrap();
        let ours = folder.path().join("ours");
        OutputFile::new("--out", &ours, &[]).unwrap().write(b"").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }
}
