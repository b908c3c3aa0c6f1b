//! The `aurt` command: model, calibrate and explain the dynamics of robot manipulators from recordings. The program and the Python
//! package run the same [`main`].
//!
//! Exit status: 0 all well, 1 a check found something, 2 the command failed or its input was bad.

mod arguments;
mod commands;
mod interrupt;
mod rendering;
mod values;

use std::ffi::OsString;

use aurt_experiment::workbench::failure::Failure;
use aurt_plugins::{Registry, Trust};
use aurt_traits::Dispatch;

use crate::arguments::Arguments;
use crate::commands::Session;
use crate::rendering::terminal::{Report, Terminal};

/// Loads the plugins that the arguments name and does what they say, on the instruction set that the environment
/// asks for.
fn run(program: &[OsString], arguments: &Arguments, terminal: &Terminal) -> Result<Report, Failure> {
    if let Some(level) = Dispatch::from_environment()? {
        level.select()?;
    }
    let mut registry = Registry::of_user()?;
    if arguments.allow_plugins {
        registry.trust(Trust::all());
    }
    for library in &arguments.plugin {
        registry.load_library(library)?;
    }
    let mut session = Session { terminal, registry, program, definition: arguments::definition };
    let outcome = arguments.command.run(&mut session);
    terminal.print_notes(&session.registry.take_notes());
    outcome
}

const SUCCESS: u8 = 0;
const FINDINGS: u8 = 1;
const FAILURE: u8 = 2;

/// Shows what is wrong with the arguments, or the help that was asked for.
fn refuse(error: &clap::Error, words: &[OsString]) -> u8 {
    let asked_for = !error.use_stderr();
    if !asked_for && words.iter().any(|word| word == "--json") {
        // Scripts read standard output; people read what clap prints.
        let message = error.to_string();
        let paragraph = message.trim_start_matches("error: ").lines().take_while(|line| !line.is_empty());
        let words: Vec<&str> = paragraph.flat_map(str::split_whitespace).collect();
        Terminal::new(true, false).print_problem(&words.join(" "));
    }
    Terminal::new(false, false).print_usage(error);
    if asked_for { SUCCESS } else { FAILURE }
}

/// Runs the command line `words`, whose first word is the name of the command, and returns its exit status. `program` is the command
/// line that starts this program, for jobs of clusters.
///
/// Interruptions (SIGINT, SIGTERM, SIGHUP) end the process from then on, with status 130.
pub fn main(program: &[OsString], words: &[OsString]) -> u8 {
    let arguments = match arguments::parse(words.iter().cloned()) {
        Ok(arguments) => arguments,
        Err(error) => return refuse(&error, words),
    };
    let terminal = Terminal::new(arguments.json, arguments.quiet);
    interrupt::listen();
    aurt_files::protect_inputs();
    let outcome = run(program, &arguments, &terminal);
    terminal.print_cleared(&aurt_files::output::take_cleared());
    report(outcome, &terminal)
}

/// Prints the outcome of a command and returns its exit status.
fn report(outcome: Result<Report, Failure>, terminal: &Terminal) -> u8 {
    let printed = outcome.and_then(|report| terminal.print_report(&report).map(|()| report.findings));
    match printed {
        Ok(true) => FINDINGS,
        Ok(false) => SUCCESS,
        Err(failure) => {
            terminal.print_failure(&failure);
            FAILURE
        }
    }
}
