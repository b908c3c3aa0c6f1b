//! The folder of a case: it appears with all of its files or not at all.

use std::{
    fs,
    path::{Path, PathBuf},
};

use aurt_files::{PART_PREFIX, PART_SUFFIX, Unfinished, publishing};

use crate::SimulationError;

fn fail(path: &Path) -> impl FnOnce(std::io::Error) -> SimulationError {
    let path = path.to_owned();
    move |source| SimulationError::Io { path, source }
}

/// Writes `folder` within `place`, or replaces its files, and then `sealed`, a file elsewhere. All of it is on the disk
/// under other names before any of it has its own.
///
/// # Errors
/// [`SimulationError::Io`]; then nothing of it is there that was not before.
pub(crate) fn write_case(
    place: &Path,
    folder: &str,
    files: &[(String, Vec<u8>)],
    sealed: Option<(PathBuf, Vec<u8>)>,
) -> Result<(), SimulationError> {
    let target = place.join(folder);
    let part = tempfile::Builder::new()
        .prefix(PART_PREFIX)
        .suffix(PART_SUFFIX)
        .tempdir_in(place)
        .map_err(fail(&target))?;
    let _unfinished = Unfinished::new(part.path());
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Temporary folders are for their owner alone; results are for whom the folder above is for.
        let permissions = fs::metadata(place).map_or(0o755, |m| m.permissions().mode() & 0o777);
        fs::set_permissions(part.path(), fs::Permissions::from_mode(permissions)).map_err(fail(&target))?;
    }
    for (name, content) in files {
        fs::write(part.path().join(name), content).map_err(fail(&target.join(name)))?;
    }
    let truth = sealed.map(|(path, content)| staged(&path, &content).map(|file| (path, file))).transpose()?;
    let publishing = publishing();
    if target.is_dir() {
        for (name, _) in files {
            let path = target.join(name);
            fs::rename(part.path().join(name), &path).map_err(fail(&path))?;
        }
    } else {
        fs::rename(part.path(), &target).map_err(fail(&target))?;
        // What the name stood for is somewhere else now.
        let _ = part.keep();
    }
    publishing.kept_one();
    if let Some((path, (file, _unfinished))) = truth {
        file.persist(&path).map_err(|e| fail(&path)(e.error))?;
        publishing.kept_one();
    }
    Ok(())
}

fn staged(path: &Path, content: &[u8]) -> Result<(tempfile::NamedTempFile, Unfinished), SimulationError> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PART_PREFIX).suffix(PART_SUFFIX);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // What any new file gets; the umask takes away what it should.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut file = builder.tempfile_in(folder).map_err(fail(path))?;
    let unfinished = Unfinished::new(file.path());
    std::io::Write::write_all(&mut file, content).map_err(fail(path))?;
    Ok((file, unfinished))
}
