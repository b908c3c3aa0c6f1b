//! The `aurt` command.

use std::ffi::OsString;
use std::panic::catch_unwind;

use pyo3::prelude::*;

/// Exit status of a Rust program that panics.
const PANICKED: u8 = 101;

/// The command `aurt` with the arguments of this process; returns its exit status. For the script `aurt` and `python -m aurt`: an
/// interruption ends the process.
#[pyfunction]
pub fn main(py: Python<'_>) -> PyResult<u8> {
    let sys = py.import("sys")?;
    let program = [sys.getattr("executable")?.extract()?, OsString::from("-m"), OsString::from("aurt")];
    let mut words: Vec<OsString> = sys.getattr("argv")?.extract()?;
    // The script's path, or that of `__main__.py`.
    if let Some(name) = words.first_mut() {
        *name = "aurt".into();
    }
    Ok(py.detach(|| catch_unwind(|| aurt_cli::main(&program, &words))).unwrap_or(PANICKED))
}
