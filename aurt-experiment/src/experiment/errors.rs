use std::borrow::Borrow;
use std::fmt;
use std::path::PathBuf;

use aurt_plugins::{BuildError, Span};
use thiserror::Error;

const MOST_PROBLEMS: usize = 100;

/// Everything that is wrong with an experiment, in the order of the text.
///
/// `Display` gives one line a problem, `file:line:column: message; help`; the spans serve those who can
/// underline.
#[derive(Debug, Clone, PartialEq, Error)]
pub struct ExperimentErrors {
    pub path: PathBuf,
    pub source_text: String,
    pub problems: Vec<Problem>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// The key or value at fault, in bytes of the text.
    pub span: Span,
    /// Its line, from 1.
    pub line: usize,
    /// Its column in characters, from 1.
    pub column: usize,
    pub message: String,
    /// What is known, what was probably meant, what to do.
    pub help: Option<String>,
}

impl fmt::Display for ExperimentErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, problem) in self.problems.iter().enumerate() {
            if i > 0 {
                writeln!(f)?;
            }
            let Problem { line, column, message, help, .. } = problem;
            write!(f, "{}:{line}:{column}: {message}", self.path.display())?;
            if let Some(help) = help {
                write!(f, "; {help}")?;
            }
        }
        Ok(())
    }
}

impl ExperimentErrors {
    pub(crate) fn new(path: PathBuf, source_text: String, complaints: Vec<Complaint>) -> Self {
        let mut complaints = complaints;
        complaints.sort_by_key(|c| (c.span.start, c.span.end));
        complaints.dedup();
        let beyond = complaints.len().saturating_sub(MOST_PROBLEMS);
        complaints.truncate(MOST_PROBLEMS);
        let mut problems: Vec<Problem> =
            complaints.into_iter().map(|complaint| complaint.located(&source_text)).collect();
        if let (Some(last), 1..) = (problems.last_mut(), beyond) {
            let more = format!("{beyond} more problems are not shown");
            last.help = Some(last.help.take().map_or_else(|| more.clone(), |help| format!("{help}; {more}")));
        }
        Self { path, source_text, problems }
    }
}

/// A problem before its line and column are counted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Complaint {
    pub span: Span,
    pub message: String,
    pub help: Option<String>,
}

impl Complaint {
    pub fn new(span: impl Borrow<Span>, message: impl Into<String>) -> Self {
        Self { span: span.borrow().clone(), message: message.into(), help: None }
    }

    #[must_use]
    pub fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }

    pub fn located(self, text: &str) -> Problem {
        let before = text.get(..self.span.start).unwrap_or(text);
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        Problem {
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
            span: self.span,
            message: self.message,
            help: self.help,
        }
    }
}

impl From<BuildError> for Complaint {
    fn from(error: BuildError) -> Self {
        Self { span: error.span(), message: error.to_string(), help: error.help() }
    }
}
