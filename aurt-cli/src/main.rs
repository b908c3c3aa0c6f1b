//! The program `aurt`.

use std::process::ExitCode;

fn main() -> ExitCode {
    let own = std::env::current_exe().map_or_else(|_| "aurt".into(), Into::into);
    ExitCode::from(aurt_cli::main(&[own], &std::env::args_os().collect::<Vec<_>>()))
}
