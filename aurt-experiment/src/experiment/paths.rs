//! Paths in experiments: environment variables and the experiment's folder.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// Why a path could not be resolved.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub(super) enum PathError {
    /// The variable is not set, or not as text.
    #[error("needs the environment variable `{0}`, which is not set")]
    Unset(String),
    /// A `$` that no name follows, or a brace that does not close.
    #[error("has a `$` without the name of an environment variable")]
    NoName,
}

impl PathError {
    pub(super) fn help(&self) -> String {
        match self {
            Self::Unset(name) => format!("set it to the folder that is meant: {name}=/path/to/folder aurt …"),
            Self::NoName => "write ${NAME} or $NAME, and $$ where a `$` itself is meant".to_owned(),
        }
    }
}

/// `text` with `$NAME` and `${NAME}` replaced and `$$` read as `$`, relative to `folder`.
pub(super) fn resolve(text: &str, folder: &Path) -> Result<PathBuf, PathError> {
    resolve_with(text, folder, |name| std::env::var(name).ok())
}

fn resolve_with(
    text: &str,
    folder: &Path,
    variable: impl Fn(&str) -> Option<String>,
) -> Result<PathBuf, PathError> {
    let mut path = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find('$') {
        path.push_str(&rest[..at]);
        rest = &rest[at + 1..];
        if let Some(literal) = rest.strip_prefix('$') {
            path.push('$');
            rest = literal;
            continue;
        }
        let name = if let Some(braced) = rest.strip_prefix('{') {
            let end = braced.find('}').ok_or(PathError::NoName)?;
            rest = &braced[end + 1..];
            &braced[..end]
        } else {
            let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
            let name = &rest[..end];
            rest = &rest[end..];
            name
        };
        if name.is_empty() {
            return Err(PathError::NoName);
        }
        path.push_str(&variable(name).ok_or_else(|| PathError::Unset(name.to_owned()))?);
    }
    path.push_str(rest);
    Ok(folder.join(path))
}

#[cfg(test)]
mod tests {
    use aurt_files::escaped;

    use super::*;

    fn resolve(text: &str) -> Result<PathBuf, PathError> {
        resolve_with(text, Path::new("/home/r"), |name| (name == "DATA").then(|| "/data".to_owned()))
    }

    #[test]
    fn variables_are_replaced_and_relative_paths_start_at_the_folder() {
        assert_eq!(resolve("a/b.csv"), Ok("/home/r/a/b.csv".into()));
        assert_eq!(resolve("${DATA}/b.csv"), Ok("/data/b.csv".into()));
        assert_eq!(resolve("$DATA/b.csv"), Ok("/data/b.csv".into()));
        assert_eq!(resolve("x${DATA}y"), Ok("/home/r/x/datay".into()));
        assert_eq!(resolve("/of $$5/$DATA"), Ok("/of $5//data".into()));
        assert_eq!(resolve(&escaped("/a$DATA$$/b")), Ok("/a$DATA$$/b".into()));
    }

    #[test]
    fn what_is_not_set_is_named() {
        assert_eq!(resolve("${AURT}/b.csv"), Err(PathError::Unset("AURT".into())));
        assert_eq!(resolve("$"), Err(PathError::NoName));
        assert_eq!(resolve("${DATA"), Err(PathError::NoName));
        assert_eq!(resolve("${}"), Err(PathError::NoName));
    }
}
