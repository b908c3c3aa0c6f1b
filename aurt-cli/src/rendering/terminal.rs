//! Where reports, notes and failures go, and whether they are coloured.

use std::{
    collections::{BTreeMap, BTreeSet},
    io::{ErrorKind, IsTerminal, Write},
    path::PathBuf,
};

use aurt::Progress;
use aurt_files::harmless;
pub use aurt_report::rendering::style::Emphasis;
use aurt_report::rendering::style::Style;
use serde_json::Value;

use aurt_experiment::workbench::failure::Failure;
use aurt_files::output::pretty;

use super::{problem, progress};

/// What a command has to say when it is done.
#[derive(Debug, Clone, Default)]
pub struct Report {
    /// For people.
    pub text: String,
    /// For programs.
    pub json: Value,
    /// Whether the command is a check that found something.
    pub findings: bool,
}

/// The way to the person or program that called.
#[derive(Debug, Clone, Copy)]
pub struct Terminal {
    json: bool,
    quiet: bool,
    colour_out: bool,
    colour_err: bool,
}

impl Terminal {
    /// A terminal for `--json` and `--quiet` as given, coloured where a person looks and `NO_COLOR` is unset.
    pub fn new(json: bool, quiet: bool) -> Self {
        let wanted = std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
            && std::env::var_os("TERM").is_none_or(|t| t != "dumb");
        Self {
            json,
            quiet,
            colour_out: wanted && std::io::stdout().is_terminal(),
            colour_err: wanted && std::io::stderr().is_terminal(),
        }
    }

    /// How reports are set off.
    pub const fn style(&self) -> Style {
        Style { coloured: self.colour_out }
    }

    /// `text` set off, if reports are coloured.
    pub fn emphasise(&self, emphasis: Emphasis, text: &str) -> String {
        self.style().emphasise(emphasis, text)
    }

    /// Prints what a command has to say.
    ///
    /// # Errors
    /// [`aurt::Error::Write`] if standard output takes no more (a full disk): half a document is none.
    pub fn print_report(&self, report: &Report) -> Result<(), Failure> {
        let text = if self.json {
            pretty(&report.json)
        } else if self.quiet {
            return Ok(());
        } else {
            harmless(&report.text).into_owned()
        };
        write_unless_closed(&mut std::io::stdout().lock(), &text)
            .map_err(|source| Failure::write("standard output", source))
    }

    /// Says on standard error where killed commands had left parts of files.
    pub fn print_cleared(&self, cleared: &BTreeMap<PathBuf, usize>) {
        for (folder, parts) in cleared.iter().filter(|_| !self.quiet) {
            let parts = if *parts == 1 { "one part".to_owned() } else { format!("{parts} parts") };
            let text =
                format!("{}: removed {parts} of files that a killed command had left\n", folder.display());
            // Nothing is left to do where standard error is closed.
            let _ = write_unless_closed(&mut std::io::stderr().lock(), &harmless(&text));
        }
    }

    /// Says what to know of files that were read.
    pub fn print_notes(&self, notes: &BTreeSet<String>) {
        for note in notes.iter().filter(|_| !self.quiet) {
            // Nothing is left to do where standard error is closed.
            let _ = write_unless_closed(&mut std::io::stderr().lock(), &harmless(&format!("note: {note}\n")));
        }
    }

    /// Prints why a command failed: for people to standard error, for programs to standard output.
    pub fn print_failure(&self, failure: &Failure) {
        if self.json {
            let document = pretty(&problem::to_json(failure));
            // What went wrong is said on standard error all the same, and the exit status tells.
            let _ = write_unless_closed(&mut std::io::stdout().lock(), &document);
        }
        let text = problem::render(failure, self.colour_err);
        // Nothing is left to do where standard error is closed.
        let _ = write_unless_closed(&mut std::io::stderr().lock(), &text);
    }

    /// Prints a problem with the arguments for programs.
    pub fn print_problem(&self, message: &str) {
        let document = pretty(&problem::plain_to_json(message));
        // The exit status tells all the same.
        let _ = write_unless_closed(&mut std::io::stdout().lock(), &document);
    }

    /// The progress over `steps` steps on standard error: a bar where a person looks at it, else a line from time to time.
    pub fn progress(&self, steps: usize) -> Progress {
        self.bar(steps, "{bar:24} {pos}/{len} {elapsed} {wide_msg}")
    }

    /// The same over the points of a sweep, with their rate and the time left.
    pub fn points_bar(&self, points: usize) -> Progress {
        self.bar(points, "{bar:24} {pos}/{len} points, {per_sec}, {eta} left")
    }

    fn bar(&self, steps: usize, template: &str) -> Progress {
        if self.json || self.quiet { Progress::silent() } else { progress::shown(steps, template) }
    }
}

/// A reader that has seen enough (`aurt models | head`) is no failure.
fn write_unless_closed(out: &mut impl Write, text: &str) -> std::io::Result<()> {
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(error),
        _ => Ok(()),
    }
}
