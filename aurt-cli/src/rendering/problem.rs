//! Failures as people read them, the place underlined, and as programs read them.

use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use aurt::Error as LibraryError;
use aurt_experiment::workbench::failure::Failure;
use aurt_files::harmless;
use aurt_plugins::model::Error as ModelError;
use aurt_plugins::suggestion;
use aurt_rbd::MdhError;
use aurt_recording::RecordingError;
use aurt_simulation::SimulationError;
use miette::{
    Diagnostic, GraphicalReportHandler, GraphicalTheme, MietteError, MietteSpanContents, SourceCode,
    SourceSpan, SpanContents,
};
use serde_json::{Value, json};
use thiserror::Error;

use super::excerpt::Excerpt;

/// Columns that messages are wrapped to on a terminal.
const WIDTH: usize = 96;

#[derive(Debug, Clone, Default, Error, Diagnostic)]
#[error("{message}")]
struct Problem {
    message: String,
    #[help]
    help: Option<String>,
    path: Option<PathBuf>,
    line: Option<usize>,
    column: Option<usize>,
    #[source_code]
    excerpt: Option<Excerpt>,
    #[label(primary)]
    underlined: Option<SourceSpan>,
}

impl Problem {
    fn plain(message: impl fmt::Display) -> Self {
        Self { message: message.to_string(), ..Self::default() }
    }

    fn of_file(message: impl fmt::Display, path: &Path) -> Self {
        Self { path: Some(path.to_owned()), ..Self::plain(message) }
    }

    /// At a cell, or, without `cell`, a whole line of a text file.
    fn of_line(message: impl fmt::Display, path: &Path, line: usize, cell: Option<usize>) -> Self {
        let excerpt = Excerpt::of_line(path, line, cell);
        Self { line: Some(line), column: cell, excerpt, ..Self::of_file(message, path) }
    }

    fn of_place(reason: &str, path: &Path, line: usize, column: usize) -> Self {
        Self {
            line: Some(line),
            column: Some(column),
            excerpt: Excerpt::of_place(path, line, column),
            ..Self::of_file(format!("{}:{line}:{column}: {reason}", path.display()), path)
        }
    }
}

/// Text of a failure for a terminal. [`problems`] has escaped what it shows, so that the theme's colours alone command the terminal.
pub fn render(failure: &Failure, coloured: bool) -> String {
    let theme = if coloured { GraphicalTheme::unicode() } else { GraphicalTheme::unicode_nocolor() };
    let handler = GraphicalReportHandler::new_themed(theme)
        .with_width(WIDTH)
        // Whoever searches a log for a path must find it in one piece.
        .with_wrap_lines(coloured)
        .with_break_words(false)
        .without_cause_chain();
    let mut text = String::new();
    for problem in problems(failure) {
        let mut shown = String::new();
        if handler.render_report(&mut shown, &problem).is_err() {
            shown = format!("error: {problem}\n");
        }
        text.push_str(shown.trim_start_matches('\n'));
    }
    text
}

pub fn to_json(failure: &Failure) -> Value {
    problems_to_json(problems(failure))
}

/// A problem without a place, as JSON.
pub fn plain_to_json(message: &str) -> Value {
    problems_to_json(vec![Problem::plain(message)])
}

fn problems_to_json(problems: Vec<Problem>) -> Value {
    let problems: Vec<Value> = problems
        .into_iter()
        .map(|p| {
            json!({
                "message": p.message,
                "help": p.help,
                "file": p.path.map(|p| p.display().to_string()),
                "line": p.line,
                "column": p.column,
            })
        })
        .collect();
    json!({ "error": { "problems": problems } })
}

/// Characters of one message; what a file says can be much longer.
const MOST_CHARACTERS: usize = 4000;

/// What is wrong, fit to be shown: what messages quote from files commands no terminal and fits on a page.
fn problems(failure: &Failure) -> Vec<Problem> {
    let mut problems = found(failure);
    let beyond = problems.len().saturating_sub(MOST_PROBLEMS);
    if beyond > 0 {
        problems.truncate(MOST_PROBLEMS);
        problems.push(Problem::plain(format!("{beyond} more problems are not shown")));
    }
    let shown = |text: &str| {
        let end = text.char_indices().nth(MOST_CHARACTERS).map_or(text.len(), |(at, _)| at);
        let cut = if end < text.len() { format!("… ({} bytes in all)", text.len()) } else { String::new() };
        harmless(&text[..end]).into_owned() + &cut
    };
    for problem in &mut problems {
        problem.message = shown(&problem.message);
        problem.help = problem.help.as_deref().map(shown);
        problem.excerpt = problem.excerpt.take().map(|excerpt| {
            let excerpt = excerpt.harmless();
            Excerpt { name: shown(&excerpt.name), ..excerpt }
        });
        problem.underlined = problem.excerpt.as_ref().map(|excerpt| excerpt.span.clone().into());
    }
    problems
}

const MOST_PROBLEMS: usize = 100;

fn found(failure: &Failure) -> Vec<Problem> {
    match failure {
        Failure::Experiment(errors) => errors
            .problems
            .iter()
            .map(|p| Problem {
                help: p.help.clone(),
                line: Some(p.line),
                column: Some(p.column),
                excerpt: Some(Excerpt::of_text(&errors.path, &errors.source_text, p.span.clone())),
                ..Problem::of_file(&p.message, &errors.path)
            })
            .collect(),
        Failure::Library(error) => library(error),
        Failure::NotFinite { path, .. } | Failure::Output { path, .. } => {
            vec![Problem::of_file(failure, path)]
        }
        Failure::Table { path, line: Some(line), cell, .. } => {
            vec![Problem::of_line(failure, path, *line, *cell)]
        }
        Failure::Table { path, line: None, .. } | Failure::Simulated { path, .. } => {
            vec![Problem::of_file(failure, path)]
        }
        Failure::In { path, failure } => found(failure)
            .into_iter()
            .map(|problem| match &problem.path {
                Some(_) => problem,
                None => {
                    let message = format!("{}: {}", path.display(), problem.message);
                    Problem { message, path: Some(path.clone()), ..problem }
                }
            })
            .collect(),
        Failure::Stretches { path, reason, remedy } => {
            vec![Problem { path: path.clone(), help: Some(remedy.clone()), ..Problem::plain(reason) }]
        }
        other => vec![Problem::plain(other)],
    }
}

fn library(error: &LibraryError) -> Vec<Problem> {
    match error {
        LibraryError::Model(error) => model(error),
        LibraryError::Recording(error) => vec![recording(error)],
        LibraryError::Simulation(error) => simulation(error),
        LibraryError::Unfit { path, .. } | LibraryError::Write { path, .. } => {
            vec![Problem::of_file(error, path)]
        }
        other => vec![Problem::plain(other)],
    }
}

fn model(error: &ModelError) -> Vec<Problem> {
    match error {
        ModelError::Build(errors) => {
            errors.iter().map(|e| Problem { help: e.help(), ..Problem::plain(e) }).collect()
        }
        ModelError::Mdh(errors) => errors.0.iter().map(mdh).collect(),
        ModelError::Assembly(errors) => errors.iter().map(Problem::plain).collect(),
        ModelError::ModelFile { path, line, column, reason, help } => {
            vec![Problem { help: help.clone(), ..Problem::of_place(reason, path, *line, *column) }]
        }
        ModelError::Read { path, source } if source.kind() == ErrorKind::NotFound => vec![missing(path)],
        ModelError::Plugins(plugins) => {
            let path = match &**plugins {
                aurt_plugins::Error::Library { path, .. } => Some(path.clone()),
                _ => None,
            };
            vec![Problem { path, ..Problem::plain(error) }]
        }
        ModelError::Read { path, .. } | ModelError::Write { path, .. } => {
            vec![Problem::of_file(error, path)]
        }
        other => vec![Problem::plain(other)],
    }
}

fn simulation(error: &SimulationError) -> Vec<Problem> {
    match error {
        SimulationError::Syntax { path, line, column, reason } => {
            vec![Problem::of_place(reason, path, *line, *column)]
        }
        SimulationError::Unreadable { path, .. } if !path.is_file() => vec![Problem::plain(error)],
        SimulationError::Io { path, .. } | SimulationError::Unreadable { path, .. } => {
            vec![Problem::of_file(error, path)]
        }
        SimulationError::Several(errors) => errors.iter().map(Problem::plain).collect(),
        other => vec![Problem::plain(other)],
    }
}

/// A file that is not there: where it was looked for, and what lies there instead.
fn missing(path: &Path) -> Problem {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let shown = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    let mut known: Vec<String> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|other| Path::new(other).extension() == path.extension())
        .collect();
    known.sort();
    let what = if path.extension().is_some_and(|e| e == "toml") {
        "; `aurt demo` writes an experiment to start from, `aurt explain experiment` says what one is"
    } else {
        ""
    };
    let help = if !folder.is_dir() {
        format!("there is no folder {} either; check the path{what}", folder.display())
    } else if let Some(meant) = meant(path, &known) {
        format!(
            "did you mean {}?",
            folder.join(meant).strip_prefix(".").unwrap_or(Path::new(meant)).display()
        )
    } else if known.is_empty() {
        format!("no file there has that extension; check the path{what}")
    } else {
        known.truncate(MOST_KNOWN);
        format!("that folder has {}; check the path{what}", known.join(", "))
    };
    let message = format!("{}: there is no such file in {}", path.display(), shown.display());
    Problem { help: Some(help), ..Problem::of_file(message, path) }
}

/// The file of the same extension whose name is close: what all of them end in makes none closer.
fn meant<'k>(path: &Path, known: &'k [String]) -> Option<&'k str> {
    let stem = |path: &Path| path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let stems: Vec<String> = known.iter().map(|name| stem(Path::new(name))).collect();
    let likely = suggestion::likely(&stem(path), stems.iter().map(String::as_str))?;
    known.iter().zip(&stems).find(|(_, s)| *s == likely).map(|(name, _)| name.as_str())
}

/// Files that are listed in the place of one that is not there.
const MOST_KNOWN: usize = 8;

fn mdh(error: &MdhError) -> Problem {
    match error {
        MdhError::Cell { path, line, column_number, .. }
        | MdhError::UnknownColumn { path, line, column_number, .. }
        | MdhError::DuplicateColumn { path, line, column_number, .. } => {
            Problem::of_line(error, path, *line, Some(*column_number))
        }
        MdhError::TooManyRows { path, line, .. }
        | MdhError::MissingHeader { path, line, .. }
        | MdhError::MissingColumn { path, line, .. }
        | MdhError::CellCount { path, line, .. } => Problem::of_line(error, path, *line, None),
        MdhError::Unreadable { path, .. } | MdhError::Empty { path, .. } => Problem::of_file(error, path),
        other => Problem::plain(other),
    }
}

fn recording(error: &RecordingError) -> Problem {
    match error {
        // Files that are no text have no lines to show.
        RecordingError::CorruptRows { path, column: 0, .. }
        | RecordingError::Headerless { path, line: 0, .. }
        | RecordingError::MissingColumn { path, line: 0, .. }
        | RecordingError::Columns { path, line: 0, .. } => Problem::of_file(error, path),
        RecordingError::Cell { path, line, column, .. }
        | RecordingError::CorruptRows { path, line, column, .. } => {
            Problem::of_line(error, path, *line, Some(*column))
        }
        RecordingError::Headerless { path, line, .. }
        | RecordingError::MissingColumn { path, line, .. }
        | RecordingError::Columns { path, line, .. }
        | RecordingError::Ragged { path, line, .. }
        | RecordingError::TruncatedLastLine { path, line, .. } => Problem::of_line(error, path, *line, None),
        other => Problem::plain(other),
    }
}

/// The excerpt's own lines, counted from where they stand in their file.
impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        // Without context miette asks for the place, and with any it shows lines: then whole ones.
        let inner = self.text.as_bytes().read_span(span, before, after)?;
        Ok(Box::new(MietteSpanContents::new_named(
            self.name.clone(),
            inner.data(),
            *inner.span(),
            inner.line() + self.first_line - 1,
            inner.column(),
            inner.line_count(),
        )))
    }
}
