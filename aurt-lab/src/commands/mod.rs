//! The command line: one command a file.
//!
//! Exit status: 0 all well, 1 cases could not be made or diagnosed, 2 the command failed or its input was bad.

mod conceal;
mod prove;
mod record;
mod score;
mod setups;

use std::io::{IsTerminal, Write};
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};

use aurt_files::{harmless, harmless_json};
use aurt_plugins::{Registry, Trust};
use clap::{Parser, Subcommand};
use serde_json::{Value, json};

use crate::product::{Failure, Observer, Progress, pretty};

/// Measure how often a diagnosis of `aurt` is right, on cases whose physics is known and concealed.
#[derive(Debug, Parser)]
#[command(name = "aurt-lab", version, max_term_width = 100, propagate_version = true)]
struct Arguments {
    /// Print one JSON document to standard output and nothing else.
    #[arg(long, global = true)]
    json: bool,
    /// Print errors only.
    #[arg(long, short, global = true)]
    quiet: bool,
    /// Load every library that an experiment names, trusted or not: its code runs with your rights.
    #[arg(long, global = true)]
    allow_plugins: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Prove(prove::Prove),
    Record(record::Record),
    Conceal(conceal::Conceal),
    Score(score::Score),
    Setups(setups::Setups),
}

/// What every command has at hand.
#[derive(Debug)]
struct Session {
    registry: Registry,
    shows_progress: bool,
}

impl Session {
    fn progress(&self, steps: usize) -> Progress {
        if !self.shows_progress {
            return Progress::silent();
        }
        Progress::observed(Counter { steps, done: AtomicUsize::new(0) })
    }
}

/// A line on standard error for every step that is done.
#[derive(Debug)]
struct Counter {
    steps: usize,
    done: AtomicUsize,
}

impl Observer for Counter {
    fn step(&self, what: &str) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        // Nothing is left to do where standard error is closed.
        let _ = writeln!(std::io::stderr(), "{done}/{} {}", self.steps, harmless(what));
    }
}

/// What a command has to say when it is done.
#[derive(Debug)]
struct Report {
    /// For people.
    text: String,
    /// For programs.
    json: Value,
    /// Whether something could not be made or diagnosed.
    findings: bool,
}

/// Exit status of a command that was interrupted, as shells have it for SIGINT.
const INTERRUPTED: i32 = 130;

/// Characters of an error message, at most.
const MOST_CHARACTERS: usize = 4000;

/// Does what the command line says.
pub fn main() -> ExitCode {
    let arguments = Arguments::parse();
    // Without it an interruption ends the command all the same, and the next one removes what it left.
    let _ = ctrlc::set_handler(|| {
        let kept = aurt_files::output::abandon();
        let _ = writeln!(
            std::io::stderr(),
            "\ninterrupted: {kept} files had been written before and are whole; a proof goes on when it is run again"
        );
        std::process::exit(INTERRUPTED);
    });
    let (text, status) = match run(&arguments) {
        Ok(report) => {
            let text = if arguments.json {
                harmless_json(&pretty(&report.json)).into_owned()
            } else {
                harmless(&report.text).into_owned()
            };
            (if arguments.quiet && !arguments.json { String::new() } else { text }, u8::from(report.findings))
        }
        Err(failure) => {
            // What a file says can be much longer.
            let message: String = failure.to_string().chars().take(MOST_CHARACTERS).collect();
            let _ = writeln!(std::io::stderr(), "Error: {}", harmless(&message));
            (
                if arguments.json {
                    harmless_json(&pretty(&json!({ "error": message }))).into_owned()
                } else {
                    String::new()
                },
                2,
            )
        }
    };
    match std::io::stdout().write_all(text.as_bytes()) {
        // Half a document is none; a reader that has seen enough is no failure.
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => ExitCode::from(2),
        _ => ExitCode::from(status),
    }
}

fn run(arguments: &Arguments) -> Result<Report, Failure> {
    let mut registry = Registry::of_user()?;
    if arguments.allow_plugins {
        registry.trust(Trust::all());
    }
    let shows_progress = !arguments.json && !arguments.quiet && std::io::stderr().is_terminal();
    let mut session = Session { registry, shows_progress };
    match &arguments.command {
        Command::Prove(command) => command.run(&mut session),
        Command::Record(command) => command.run(),
        Command::Conceal(command) => command.run(&mut session),
        Command::Score(command) => command.run(),
        Command::Setups(command) => command.run(&session),
    }
}
