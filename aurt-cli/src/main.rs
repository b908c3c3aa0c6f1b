//! The `aurt` command: model, calibrate and explain the dynamics of robot manipulators from recordings.
//!
//! Exit status: 0 all well, 1 a check found something, 2 the command failed or its input was bad.

mod arguments;
mod commands;
mod interrupt;
mod rendering;
mod values;

use std::process::ExitCode;

use aurt_experiment::workbench::failure::Failure;
use aurt_plugins::{Registry, Trust};
use aurt_traits::Dispatch;

use crate::{
    arguments::Arguments,
    commands::Session,
    rendering::terminal::{Report, Terminal},
};

/// Loads the plugins that the arguments name and does what they say, on the instruction set that the environment
/// asks for.
fn run(arguments: &Arguments, terminal: &Terminal) -> Result<Report, Failure> {
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
    let mut session = Session { terminal, registry, definition: arguments::definition };
    let outcome = arguments.command.run(&mut session);
    terminal.print_notes(&session.registry.take_notes());
    outcome
}

/// Exit status of a check that found something.
const FINDINGS: u8 = 1;
/// Exit status of a command that failed.
const FAILURE: u8 = 2;

/// Shows what is wrong with the arguments, or the help that was asked for.
fn refuse(error: &clap::Error) -> ExitCode {
    let asked_for = !error.use_stderr();
    if !asked_for && std::env::args_os().any(|word| word == "--json") {
        // Scripts read standard output; people read what clap prints.
        let message = error.to_string();
        let paragraph = message.trim_start_matches("error: ").lines().take_while(|line| !line.is_empty());
        let words: Vec<&str> = paragraph.flat_map(str::split_whitespace).collect();
        Terminal::new(true, false).print_problem(&words.join(" "));
    }
    Terminal::new(false, false).print_usage(error);
    if asked_for { ExitCode::SUCCESS } else { ExitCode::from(FAILURE) }
}

fn main() -> ExitCode {
    let arguments = match arguments::parse(std::env::args_os()) {
        Ok(arguments) => arguments,
        Err(error) => return refuse(&error),
    };
    let terminal = Terminal::new(arguments.json, arguments.quiet);
    interrupt::listen();
    aurt_files::protect_inputs();
    let outcome = run(&arguments, &terminal);
    terminal.print_cleared(&aurt_files::output::take_cleared());
    report(outcome, &terminal)
}

/// Says how the command went, and with which status it ends.
fn report(outcome: Result<Report, Failure>, terminal: &Terminal) -> ExitCode {
    match outcome {
        Ok(report) => match terminal.print_report(&report) {
            Ok(()) if report.findings => ExitCode::from(FINDINGS),
            Ok(()) => ExitCode::SUCCESS,
            Err(failure) => {
                terminal.print_failure(&failure);
                ExitCode::from(FAILURE)
            }
        },
        Err(failure) => {
            terminal.print_failure(&failure);
            ExitCode::from(FAILURE)
        }
    }
}
