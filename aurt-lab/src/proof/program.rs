//! The program that diagnoses.

use std::env::consts::EXE_SUFFIX;
use std::env::{current_exe, split_paths, var_os};
use std::path::{Path, PathBuf};

use crate::product::Failure;

/// The program that is named; without a name `aurt` in the folder of this program, else in a folder of `PATH`.
pub fn program(named: Option<&Path>) -> Result<PathBuf, Failure> {
    let name = format!("aurt{EXE_SUFFIX}");
    let beside = current_exe().ok().and_then(|own| Some(own.parent()?.join(&name)));
    let in_path = var_os("PATH").into_iter().flat_map(|path| split_paths(&path).collect::<Vec<_>>());
    let found = match named {
        Some(named) => std::path::absolute(named).ok().filter(|path| path.is_file()),
        None => {
            beside.into_iter().chain(in_path.map(|folder| folder.join(&name))).find(|path| path.is_file())
        }
    };
    found.ok_or_else(|| Failure::argument("--program", match named {
            Some(named) => format!("{} is no file", named.display()),
            None => format!("there is no `{name}` in the folder of this program nor in PATH"),
        }, "name the executable of aurt with --program, or build it there: `cargo build --release -p aurt-cli`"))
}
