//! Running `aurt-lab` in a folder.

use std::ffi::OsStr;
use std::process::Command;

use crate::programs::{aurt, aurt_lab};
use crate::support::{Folder, Run};

pub fn lab<S: AsRef<OsStr>>(folder: &Folder, arguments: impl IntoIterator<Item = S>) -> Run {
    lab_with(folder, [], arguments)
}

/// Runs `aurt-lab` in a folder with some variables in its environment.
pub fn lab_with<'e, S: AsRef<OsStr>>(
    folder: &Folder,
    environment: impl IntoIterator<Item = (&'e str, &'e str)>,
    arguments: impl IntoIterator<Item = S>,
) -> Run {
    // The program that diagnoses is the one beside.
    aurt();
    let mut command = Command::new(aurt_lab());
    command.args(arguments).current_dir(folder.path("")).env("AURT_TRUST", "all").envs(environment);
    Run::of(command)
}
