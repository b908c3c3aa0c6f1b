//! Which renames are under way, so that those of a killed process can be completed.
//!
//! A journal is a list of three paths an entry, each followed by a zero byte: the staged file, its target, and the second
//! name of what it replaces (empty without one). It is complete and on the disk before the first rename; a journal
//! without its last line, [`COMPLETE`], was never in force.

use std::{
    ffi::OsString,
    fs::{self, File},
    io::Write,
    path::{Path, PathBuf},
    time::{Duration, SystemTime},
};

use tempfile::NamedTempFile;

use crate::output::{
    STAGED, WriteError,
    staging::{PART, Staged, folder_of, mark, named},
    unfinished::note_cleared,
};

const JOURNAL: &str = ".journal";
const COMPLETE: &[u8] = b"complete\n";
/// What is younger may be of a process that has made it and not yet marked it.
const SETTLED: Duration = Duration::from_secs(1);

/// The journal of renames under way; they are over when it is dropped.
#[derive(Debug)]
pub(crate) struct Journal {
    _file: NamedTempFile,
}

impl Journal {
    pub(crate) fn write(staged: &[Staged]) -> Result<Self, WriteError> {
        let folder = staged.first().map_or(Path::new("."), |s| folder_of(s.target()));
        let fail = || WriteError::at(folder);
        let mut text = Vec::new();
        for one in staged {
            for path in [one.part(), one.target(), one.old().unwrap_or(Path::new(""))] {
                if !path.as_os_str().is_empty() {
                    let path = std::path::absolute(path).map_err(fail())?;
                    text.extend_from_slice(path.as_os_str().as_encoded_bytes());
                }
                text.push(0);
            }
        }
        text.extend_from_slice(COMPLETE);
        let mut file = named(JOURNAL, 0o666).tempfile_in(folder).map_err(fail())?;
        mark(file.as_file());
        file.write_all(&text).and_then(|()| file.as_file().sync_data()).map_err(fail())?;
        Ok(Self { _file: file })
    }
}

/// Completes the renames of killed processes in a folder and removes what they left staged. What belongs to living
/// processes stays; what cannot be removed is in nobody's way.
pub fn clear_unfinished(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    let left: Vec<PathBuf> = entries
        .flatten()
        .filter(|entry| entry.file_name().to_string_lossy().starts_with(STAGED))
        .map(|entry| entry.path())
        .filter(|path| is_abandoned(path))
        .collect();
    let is = |path: &Path, suffix: &str| path.to_string_lossy().ends_with(suffix);
    for journal in left.iter().filter(|path| is(path, JOURNAL)) {
        complete(journal);
        let _ = fs::remove_file(journal);
    }
    let parts = left.iter().filter(|path| !is(path, JOURNAL)).count();
    for path in left.iter().filter(|path| is(path, PART)) {
        let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    }
    note_cleared(folder, parts);
}

/// Whether no living process holds a file or folder.
fn is_abandoned(path: &Path) -> bool {
    let settled = |file: &File| {
        let modified = file.metadata().and_then(|m| m.modified()).ok()?;
        SystemTime::now().duration_since(modified).ok().filter(|age| *age >= SETTLED)
    };
    File::open(path).is_ok_and(|file| settled(&file).is_some() && file.try_lock().is_ok())
}

/// Does the renames of a journal that are not yet done.
fn complete(journal: &Path) {
    let Some(text) = fs::read(journal).ok().and_then(|t| t.strip_suffix(COMPLETE).map(<[u8]>::to_owned))
    else {
        return;
    };
    let paths: Vec<PathBuf> = text.split(|byte| *byte == 0).filter_map(path).collect();
    for entry in paths.chunks_exact(3) {
        // A staged file that is no longer there has its right name already.
        let _ = fs::rename(&entry[0], &entry[1]);
        let _ = fs::remove_file(&entry[2]);
    }
}

#[cfg(unix)]
fn path(bytes: &[u8]) -> Option<PathBuf> {
    use std::os::unix::ffi::OsStringExt;
    Some(OsString::from_vec(bytes.to_owned()).into())
}

#[cfg(not(unix))]
fn path(bytes: &[u8]) -> Option<PathBuf> {
    String::from_utf8(bytes.to_owned()).ok().map(OsString::from).map(PathBuf::from)
}
