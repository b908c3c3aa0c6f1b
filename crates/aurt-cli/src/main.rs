//! The `aurt` command: model, calibrate and explain the dynamics of robot manipulators from recordings.
//!
//! Exit status: 0 all well, 1 a check found something, 2 the command failed or its input was bad.

mod arguments;
mod calibrated_file;
mod commands;
mod data;
mod demo;
mod failure;
mod fitting;
mod glossary;
mod inspection;
mod output;
mod rendering;
mod results;
mod simulated;
mod sweeping;

use std::process::ExitCode;

use aurt_plugins::Registry;
use clap::Parser;

use crate::{
    arguments::{Arguments, join_vector_values},
    commands::Session,
    failure::Failure,
    rendering::terminal::{Report, Terminal},
};

/// Loads the plugins that the arguments name and does what they say.
fn run(arguments: &Arguments, terminal: &Terminal) -> Result<Report, Failure> {
    let mut registry = Registry::linked()?;
    for library in &arguments.plugin {
        registry.load_library(library)?;
    }
    arguments.command.run(&mut Session { terminal, registry })
}

/// Exit status of a check that found something.
const FINDINGS: u8 = 1;
/// Exit status of a command that failed.
const FAILURE: u8 = 2;

fn main() -> ExitCode {
    // Clap leaves with status 2 where the arguments are wrong, and with 0 for --help and --version.
    let arguments = Arguments::parse_from(join_vector_values(std::env::args_os()));
    let terminal = Terminal::new(arguments.json, arguments.quiet);
    match run(&arguments, &terminal) {
        Ok(report) => {
            terminal.print_report(&report);
            if report.findings { ExitCode::from(FINDINGS) } else { ExitCode::SUCCESS }
        }
        Err(failure) => {
            terminal.print_failure(&failure);
            ExitCode::from(FAILURE)
        }
    }
}
