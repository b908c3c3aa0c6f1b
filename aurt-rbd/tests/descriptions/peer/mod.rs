//! Chains of a file against another program's, where `AURT_PYTHON` names an interpreter that has it.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::ffi::OsString;
use std::path::Path;
use std::process::Command;

#[expect(dead_code, reason = "the example's main function is not called")]
#[path = "../../../examples/chains.rs"]
mod chains;

/// The interpreter that `AURT_PYTHON` names, if it has the Python `module`.
pub fn python(module: &str) -> Option<OsString> {
    let Some(python) = std::env::var_os("AURT_PYTHON") else {
        println!("skipped: AURT_PYTHON names no Python with {module}");
        return None;
    };
    if !Command::new(&python).args(["-c", &format!("import {module}")]).status().is_ok_and(|s| s.success()) {
        println!("skipped: {} has no {module}", python.display());
        return None;
    }
    Some(python)
}

/// What the comparing `script` prints of a file in `reference`; nothing without the Python `module`.
pub fn compared(module: &str, script: &str, file: &str) -> Option<String> {
    let python = python(module)?;
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = here.join("tests/descriptions/reference").join(file);
    let folder = tempfile::tempdir().unwrap();
    let found = chains::chains(&file, folder.path(), 0).unwrap();
    std::fs::write(folder.path().join("chains.json"), found.to_string()).unwrap();
    let run = Command::new(&python)
        .arg(here.join("../aurt-lab/mujoco").join(script))
        .arg("--written")
        .arg(folder.path())
        .arg(&file)
        .output()
        .unwrap();
    let (text, errors) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success(), "{text}\n{errors}");
    Some(text.into_owned())
}
