//! The `aurt-lab` command.

fn main() -> std::process::ExitCode {
    aurt_lab::commands::main()
}
