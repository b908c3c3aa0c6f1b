//! Where a command writes its results. Whether a path can be written at all is asked before any work is done, no other
//! command may write there until this one has ended, and what a killed one left there is cleared away; results appear
//! together or not at all.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use aurt_files::output::{
    Claim, Output, WriteError, clear_unfinished, folder_of, is_named_pipe, is_special, write_file,
    write_folder, write_outputs,
};
use aurt_report::Page;

use crate::workbench::failure::Failure;

fn claim(
    option: &'static str,
    path: &Path,
    claimed: impl FnOnce(&Path) -> Result<Claim, WriteError>,
) -> Result<Claim, Failure> {
    claimed(path).map_err(|error| match error.source.kind() {
        ErrorKind::ResourceBusy => Failure::output(
            option,
            &error.path,
            "is in use: another run writes there",
            "wait until it has ended, or name another place",
        ),
        _ => error.into(),
    })
}

/// A file that a command is going to write.
#[derive(Debug, Clone)]
pub struct OutputFile {
    path: PathBuf,
    _claim: Option<Claim>,
}

impl OutputFile {
    /// Checks that `path` can become a file and is none of `inputs`.
    pub fn new(option: &'static str, path: &Path, inputs: &[&Path]) -> Result<Self, Failure> {
        let refuse = |reason: &str, remedy: &str| Failure::output(option, path, reason, remedy);
        if path.as_os_str().is_empty() {
            return Err(refuse("is empty", "name a file"));
        }
        if path.is_dir() {
            return Err(refuse("is a folder", "name a file in it"));
        }
        if is_named_pipe(path) {
            return Err(refuse("is a pipe, which may have no reader", "name a file, or /dev/stdout"));
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
        if inputs.iter().any(|input| same(&input)) || aurt_files::is_input(path) {
            return Err(refuse("is an input of this command and would be overwritten", "name another file"));
        }
        clear_unfinished(folder);
        let claim = if is_special(path) { None } else { Some(claim(option, path, Claim::file)?) };
        Ok(Self { path: path.to_owned(), _claim: claim })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the whole file or, on failure, nothing.
    pub fn write(&self, contents: &[u8]) -> Result<(), Failure> {
        check_finite(&self.path, contents)?;
        Ok(write_file(&self.path, contents)?)
    }
}

/// Checks that outputs of one command do not overwrite each other.
pub fn distinct(outputs: &[(&'static str, &Path)]) -> Result<(), Failure> {
    for (i, (option, path)) in outputs.iter().enumerate() {
        if let Some((other, _)) = outputs[..i].iter().find(|(_, p)| p == path) {
            return Err(Failure::output(
                option,
                path,
                format!("is the file of {other} too"),
                "name another file",
            ));
        }
    }
    Ok(())
}

/// A folder that a command fills with several files, all or none.
#[derive(Debug, Clone)]
pub struct OutputFolder {
    path: PathBuf,
    /// None for a folder that is to appear in one that does not exist yet.
    _claim: Option<Claim>,
}

impl OutputFolder {
    /// Checks that `path` is a folder or can become one.
    pub fn new(option: &'static str, path: &Path) -> Result<Self, Failure> {
        let refuse = |reason: String, remedy: &str| Failure::output(option, path, reason, remedy);
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
        Self::at(option, path)
    }

    /// The same for a folder whose own folder may have to be made, such as one within another output.
    pub fn nested(option: &'static str, path: &Path) -> Result<Self, Failure> {
        let known = path.ancestors().find(|a| a.as_os_str().is_empty() || a.exists()).unwrap_or(path);
        if path.as_os_str().is_empty() || known.is_file() {
            return Self::new(option, known);
        }
        Self::at(option, path)
    }

    /// A new folder is staged beside its place, files of an existing one within it.
    fn at(option: &'static str, path: &Path) -> Result<Self, Failure> {
        let exists = path.exists();
        clear_unfinished(if exists { path } else { folder_of(path) });
        let has_place = exists || folder_of(path).is_dir();
        let claim = if has_place { Some(claim(option, path, Claim::folder)?) } else { None };
        Ok(Self { path: path.to_owned(), _claim: claim })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes all files, given by their names, or, on failure, none.
    pub fn write(&self, files: &[(String, Vec<u8>)]) -> Result<(), Failure> {
        files.iter().try_for_each(|(name, contents)| check_finite(&self.path.join(name), contents))?;
        Ok(write_folder(&self.path, files)?)
    }
}

/// What a command writes: all of it or nothing.
#[derive(Debug, Default)]
pub struct Outputs {
    /// The folder that is to hold results, if it does not exist.
    new_folder: Option<PathBuf>,
    files: Vec<ResultFile>,
}

#[derive(Debug)]
struct ResultFile {
    path: PathBuf,
    folder: Option<PathBuf>,
    contents: Vec<u8>,
}

impl ResultFile {
    fn output(&self) -> Output<'_> {
        Output { path: &self.path, folder: self.folder.as_deref(), contents: &self.contents }
    }
}

impl Outputs {
    pub fn file(&mut self, file: &OutputFile, contents: Vec<u8>) {
        self.files.push(ResultFile { path: file.path.clone(), folder: None, contents });
    }

    pub fn folder(&mut self, folder: &OutputFolder, files: impl IntoIterator<Item = (String, Vec<u8>)>) {
        if self.new_folder.is_none() && !folder.path.exists() {
            self.new_folder = Some(folder.path.clone());
        }
        let file = |(name, contents): (String, Vec<u8>)| ResultFile {
            path: folder.path.join(name),
            folder: Some(folder.path.clone()),
            contents,
        };
        self.files.extend(files.into_iter().map(file));
    }

    /// Adds the figures of a page, if they are asked for, and says where they will be.
    pub fn figures(&mut self, page: &Page, folder: Option<&OutputFolder>) -> Vec<PathBuf> {
        let Some(folder) = folder else { return Vec::new() };
        let first = self.files.len();
        self.folder(
            folder,
            page.figures().into_iter().map(|(name, figure)| (name, figure.to_svg().into_bytes())),
        );
        self.files[first..].iter().map(|file| file.path.clone()).collect()
    }

    pub fn paths(&self) -> Vec<PathBuf> {
        self.files.iter().map(|file| file.path.clone()).collect()
    }

    /// Writes everything or, on failure, nothing.
    pub fn write(self) -> Result<(), Failure> {
        self.files.iter().try_for_each(|file| check_finite(&file.path, &file.contents))?;
        let within = self.new_folder.as_ref().and_then(|folder| {
            let inside = |file: &ResultFile| {
                Some((file.path.strip_prefix(folder).ok()?.to_owned(), file.contents.clone()))
            };
            Some((folder, self.files.iter().map(inside).collect::<Option<Vec<_>>>()?))
        });
        match within {
            // A folder that does not exist appears at once.
            Some((folder, files)) => write_folder(folder, &files)?,
            None => {
                write_outputs(&self.files.iter().map(ResultFile::output).collect::<Vec<_>>())?;
            }
        }
        Ok(())
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
    fn a_table_with_a_number_that_is_none_is_not_written() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| OutputFile::new("--out", &folder.path().join(name), &[]).unwrap();
        let error = file("a.csv").write(b"x,y\n1,2\n3, NaN\n").unwrap_err();
        assert!(matches!(error, Failure::NotFinite { line: 3, .. }), "{error}");
        let mut outputs = Outputs::default();
        outputs.file(&file("b.csv"), b"1\n".to_vec());
        outputs.file(&file("a.csv"), b"-inf\n".to_vec());
        assert!(matches!(outputs.write(), Err(Failure::NotFinite { line: 1, .. })));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        file("words.txt").write(b"NaN").unwrap();
    }

    #[test]
    fn a_folder_that_cannot_be_filled_is_not_left_behind() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let files = [("a".to_owned(), b"1".to_vec()), ("a/b".to_owned(), b"2".to_vec())];
        assert!(OutputFolder::new("--out", &out).unwrap().write(&files).is_err());
        assert!(!out.exists());
    }
}
