//! The command line: its definition, and options that every command has.

use std::ffi::{OsStr, OsString};
use std::path::PathBuf;

use clap::{CommandFactory, FromArgMatches, Parser};

use crate::commands::{Command, GROUPS};
use crate::values::parse_numbers;

/// Model, calibrate and explain the dynamics of robot manipulators from recordings of the real machine.
#[derive(Debug, Parser)]
#[command(name = "aurt", bin_name = "aurt", version, max_term_width = 100, propagate_version = true)]
#[command(after_help = "First steps:\n  \
    aurt demo                                    the whole chain on a recording made for it\n  \
    aurt run experiment.toml --out results       the whole chain on yours\n\n\
    Exit status: 0 all well, 1 a check found something, 2 failure or bad input.")]
pub struct Arguments {
    /// Print one JSON document to standard output and nothing else.
    #[arg(long, global = true)]
    pub json: bool,
    /// Print errors only.
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Load a library of models; repeatable.
    #[arg(long, global = true, value_name = "LIBRARY")]
    pub plugin: Vec<PathBuf>,
    /// Load every library that an experiment names, trusted or not: its code runs with your rights.
    #[arg(long, global = true)]
    pub allow_plugins: bool,
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The command line's definition, with the commands grouped by what they are for.
pub fn definition() -> clap::Command {
    let mut command = Arguments::command();
    command.build();
    let mut groups = String::new();
    for (title, names) in GROUPS {
        groups.push_str(&format!("{title}:\n"));
        for name in names {
            let about = command.find_subcommand(name).and_then(|c| c.get_about()).map(ToString::to_string);
            groups.push_str(&format!("  {name:<20}{}\n", about.unwrap_or_default().trim_end_matches('.')));
        }
        groups.push('\n');
    }
    Arguments::command().help_template(format!(
        "{{about}}\n\n{{usage-heading}} {{usage}}\n\n{groups}Options:\n{{options}}{{after-help}}"
    ))
}

/// What the words of a command line say.
pub fn parse(words: impl Iterator<Item = OsString>) -> Result<Arguments, clap::Error> {
    let mut definition = definition();
    let words = join_vector_values(words);
    // Experiments, models and reports name files in texts, which are UTF-8.
    if let Some(word) = words.iter().skip(1).find(|word| word.to_str().is_none()) {
        let message = format!(
            "{} is no UTF-8 text, so no result could name it; rename the file or folder, or make a link with another \
             name to it\n",
            word.display()
        );
        return Err(clap::Error::raw(clap::error::ErrorKind::InvalidUtf8, message));
    }
    let matches = definition.try_get_matches_from_mut(words)?;
    Arguments::from_arg_matches(&matches).map_err(|e| e.format(&mut definition))
}

const VECTOR_OPTIONS: [&str; 3] = ["--gravity", "--torque-constants", "--centre-of-mass-m"];

/// Joins the words that follow a vector option to one value, `--gravity 0 0 -9.81` to `--gravity=0 0 -9.81`:
/// negative numbers look like options to clap, and so do quoted vectors that begin with one. Commands with such
/// options take no bare arguments that could be meant.
fn join_vector_values(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::new();
    let mut in_vector = false;
    for argument in arguments {
        if in_vector && !is_option(&argument) {
            if let Some(last) = joined.last_mut() {
                let bare = VECTOR_OPTIONS.iter().any(|option| last == option);
                last.push(if bare { "=" } else { " " });
                last.push(argument);
            }
            continue;
        }
        in_vector = VECTOR_OPTIONS.iter().any(|option| {
            argument == *option || argument.to_str().is_some_and(|a| a.starts_with(&format!("{option}=")))
        });
        joined.push(argument);
    }
    joined
}

fn is_option(argument: &OsStr) -> bool {
    argument.to_str().is_some_and(|text| text.starts_with('-') && parse_numbers(text).is_err())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::values::{Gravity, parse_gravity};

    fn joined(line: &[&str]) -> Vec<String> {
        let joined = join_vector_values(line.iter().map(OsString::from));
        joined.into_iter().map(|a| a.into_string().unwrap()).collect()
    }

    #[test]
    fn clap_accepts_the_definition() {
        definition().debug_assert();
    }

    #[test]
    fn every_command_is_in_one_group() {
        let mut command = Arguments::command();
        command.build();
        let mut defined: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
        let mut grouped: Vec<&str> = GROUPS.iter().flat_map(|(_, names)| names.iter().copied()).collect();
        defined.sort_unstable();
        grouped.sort_unstable();
        assert_eq!(defined, grouped);
    }

    #[test]
    fn gravity_can_be_written_in_any_usual_way() {
        let expected = ["aurt", "--gravity=-1 0 -9.81", "--out", "x"].map(str::to_owned).to_vec();
        assert_eq!(joined(&["aurt", "--gravity", "-1", "0", "-9.81", "--out", "x"]), expected);
        assert_eq!(joined(&["aurt", "--gravity", "-1 0 -9.81", "--out", "x"]), expected);
        assert_eq!(joined(&["aurt", "--gravity=-1", "0", "-9.81", "--out", "x"]), expected);
        for text in ["0 6.937 -6.937", "0,6.937,-6.937", "[0, 6.937, -6.937]"] {
            assert_eq!(parse_gravity(text), Ok(Gravity([0.0, 6.937, -6.937])));
        }
    }

    #[test]
    fn what_follows_a_vector_is_left_alone() {
        let line = ["aurt", "--gravity=0 0 -9.81", "--quiet", "7", "-q"];
        assert_eq!(joined(&line), line.map(str::to_owned).to_vec());
        assert_eq!(joined(&["--gravity", "0", "0", "down", "-q"]), ["--gravity=0 0 down", "-q"]);
    }
}
