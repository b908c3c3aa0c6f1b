//! Where reports, notes and failures go, and whether they are coloured. Nothing else writes to standard output and error, so that
//! no text of a file reaches a terminal with characters that command it.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, IsTerminal, Write};
use std::path::PathBuf;

use aurt::Progress;
use aurt_files::{harmless, harmless_json};
pub use aurt_report::rendering::style::Emphasis;
use aurt_report::rendering::style::Style;
use clap::error::ErrorKind;
use serde_json::Value;

use aurt_experiment::workbench::failure::Failure;
use aurt_files::output::pretty;

use super::{problem, progress};

/// What a command has to say when it is done.
#[derive(Debug, Clone, Default)]
pub struct Report {
    pub text: String,
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
            colour_out: wanted && io::stdout().is_terminal(),
            colour_err: wanted && io::stderr().is_terminal(),
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

    pub fn print_report(&self, report: &Report) -> Result<(), Failure> {
        let written = if self.json {
            write_document(&report.json)
        } else if self.quiet {
            return Ok(());
        } else {
            write_unless_closed(&mut io::stdout().lock(), &self.style().finished(&report.text))
        };
        written.map_err(|source| Failure::write("standard output", source))
    }

    /// Says on standard error where killed commands had left parts of files.
    pub fn print_cleared(&self, cleared: &BTreeMap<PathBuf, usize>) {
        for (folder, parts) in cleared.iter().filter(|_| !self.quiet) {
            let parts = if *parts == 1 { "one part".to_owned() } else { format!("{parts} parts") };
            let text =
                format!("{}: removed {parts} of files that a killed command had left\n", folder.display());
            print_error(&text);
        }
    }

    /// Says what to know of files that were read.
    pub fn print_notes(&self, notes: &BTreeSet<String>) {
        for note in notes.iter().filter(|_| !self.quiet) {
            print_error(&format!("note: {note}\n"));
        }
    }

    /// Prints why a command failed: for people to standard error, for programs to standard output.
    pub fn print_failure(&self, failure: &Failure) {
        if self.json {
            // What went wrong is said on standard error all the same, and the exit status tells.
            let _ = write_document(&problem::to_json(failure));
        }
        let text = problem::render(failure, self.colour_err);
        // Nothing is left to do where standard error is closed.
        let _ = write_unless_closed(&mut io::stderr().lock(), &text);
    }

    /// Prints a problem with the arguments for programs.
    pub fn print_problem(&self, message: &str) {
        // The exit status tells all the same.
        let _ = write_document(&problem::plain_to_json(message));
    }

    /// Shows help that was asked for, or what is wrong with the arguments.
    pub fn print_usage(&self, message: &clap::Error) {
        let (to_stderr, text) = (message.use_stderr(), message.render());
        let coloured = if to_stderr { self.colour_err } else { self.colour_out };
        let text = if is_help(message.kind()) && coloured {
            // All of it is the definition's.
            text.ansi().to_string()
        } else {
            usage_text(&text.to_string(), Style { coloured })
        };
        // Nothing is left to do where the output is closed.
        let _ = if to_stderr {
            write_unless_closed(&mut io::stderr().lock(), &text)
        } else {
            write_unless_closed(&mut io::stdout().lock(), &text)
        };
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

/// Writes text of no colours to standard error.
pub fn print_error(text: &str) {
    // Nothing is left to do where standard error is closed.
    let _ = write_unless_closed(&mut io::stderr().lock(), &harmless(text));
}

pub fn can_ask() -> bool {
    io::stdin().is_terminal() && io::stderr().is_terminal()
}

/// True for messages of clap that show the definition of the command line and nothing else.
const fn is_help(kind: ErrorKind) -> bool {
    use ErrorKind::{DisplayHelp, DisplayHelpOnMissingArgumentOrSubcommand, DisplayVersion};
    matches!(kind, DisplayHelp | DisplayHelpOnMissingArgumentOrSubcommand | DisplayVersion)
}

/// Text of wrong arguments without clap's colours: clap quotes arguments as they are.
fn usage_text(plain: &str, style: Style) -> String {
    const BEGINNING: &str = "error:";
    let marked =
        plain.strip_prefix(BEGINNING).map(|rest| style.emphasise(Emphasis::Warning, BEGINNING) + rest);
    style.finished(marked.as_deref().unwrap_or(plain)).into_owned()
}

/// Writes a document for programs to standard output, which may be a terminal.
fn write_document(document: &Value) -> io::Result<()> {
    write_unless_closed(&mut io::stdout().lock(), &harmless_json(&pretty(document)))
}

/// A reader that has seen enough (`aurt models | head`) is no failure.
fn write_unless_closed(out: &mut impl Write, text: &str) -> io::Result<()> {
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use aurt_files::is_harmful;

    use super::*;

    #[test]
    fn of_arguments_nothing_reaches_a_coloured_terminal_as_it_is() {
        for argument in ["a\u{1b}[38;5;15;8mb", "a\u{1b}[1mb", "\u{9b}31m", "\u{202e}"] {
            let wrong = crate::arguments::parse(["aurt", argument].iter().map(Into::into)).unwrap_err();
            assert!(!is_help(wrong.kind()));
            let text = usage_text(&wrong.render().ansi().to_string(), Style { coloured: true });
            let rest = text.replacen("\u{1b}[33merror:\u{1b}[0m", "", 1);
            assert!(!rest.contains(is_harmful), "{text:?}");
            let shown = usage_text(&wrong.render().to_string(), Style { coloured: true });
            assert!(shown.starts_with("\u{1b}[33merror:\u{1b}[0m "), "{shown:?}");
        }
    }
}
