//! The places that paths mean.

use std::path::{Path, PathBuf};
use std::{fs, io};

/// The folder that a path lies in; the current one for a bare name.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// The file that a path means: links keep their place, and what they point to is replaced, or made if it is not there
/// yet.
pub(crate) fn meant(path: &Path) -> io::Result<PathBuf> {
    fs::canonicalize(path).or_else(|_| linked(path))
}

/// The target of a link whose target does not exist yet; the path itself if it is no link.
fn linked(path: &Path) -> io::Result<PathBuf> {
    let Ok(target) = fs::read_link(path) else { return Ok(path.to_owned()) };
    let target = folder_of(path).join(target);
    match fs::symlink_metadata(&target) {
        Ok(found) if found.is_symlink() => {
            Err(io::Error::other("it is a link to a link that leads nowhere; name the file itself"))
        }
        _ => Ok(target),
    }
}
