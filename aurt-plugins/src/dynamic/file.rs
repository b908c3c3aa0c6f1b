//! The file of a library: read once, so that what is loaded is what was hashed.

use std::path::{Path, PathBuf};
use std::{fs, io};

use crate::error::{Error, LibraryProblem};

const MOST_BYTES: u64 = 512 << 20;

#[derive(Debug)]
pub(crate) struct LibraryFile {
    /// The path, without links.
    pub path: PathBuf,
    /// The BLAKE3 hash of its bytes, in hexadecimal digits.
    pub blake3: String,
    bytes: Vec<u8>,
}

impl LibraryFile {
    pub(crate) fn read(path: &Path) -> Result<Self, Error> {
        let fail = |problem| Error::Library { path: path.to_owned(), problem };
        let file = path.canonicalize().map_err(|_| fail(LibraryProblem::Missing))?;
        let bytes = aurt_files::read_regular(&file, MOST_BYTES)
            .map_err(|error| fail(LibraryProblem::NotALibrary(error.to_string())))?;
        Ok(Self { path: file, blake3: blake3::hash(&bytes).to_hex().to_string(), bytes })
    }

    /// Gives `load` the path of a copy that nobody else can change. Nothing lies beside it, so a library that asks for
    /// neighbours (`$ORIGIN`) does not get them.
    pub(crate) fn with_private_copy<T>(&self, load: impl FnOnce(&Path) -> T) -> io::Result<T> {
        #[cfg(target_os = "linux")]
        if let Some(copy) = in_memory(&self.bytes) {
            return Ok(load(&copy));
        }
        // Where files cannot be removed while they are loaded, the system does so when it cleans the folder up.
        let folder = tempfile::tempdir()?;
        let copy = folder.path().join(self.path.file_name().unwrap_or_default());
        fs::write(&copy, &self.bytes)?;
        Ok(load(&copy))
    }
}

/// The path of a sealed file in memory; none where the system does not make one.
#[cfg(target_os = "linux")]
fn in_memory(bytes: &[u8]) -> Option<PathBuf> {
    use std::fs::File;
    use std::io::Write;
    use std::os::fd::AsRawFd;

    use rustix::fs::{MemfdFlags, SealFlags, fcntl_add_seals, memfd_create};

    let file = memfd_create("aurt-plugin", MemfdFlags::CLOEXEC | MemfdFlags::ALLOW_SEALING).ok()?;
    let mut file = File::from(file);
    file.write_all(bytes).ok()?;
    fcntl_add_seals(&file, SealFlags::WRITE | SealFlags::GROW | SealFlags::SHRINK | SealFlags::SEAL).ok()?;
    let path = PathBuf::from(format!("/proc/self/fd/{}", file.as_raw_fd()));
    if !path.exists() {
        return None;
    }
    // The loader knows libraries by their paths: another one must never have this number.
    std::mem::forget(file);
    Some(path)
}
