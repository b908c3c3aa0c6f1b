use std::path::PathBuf;

use thiserror::Error;

/// What can be wrong with a request to this crate.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum RbdError {
    #[error(transparent)]
    Mdh(#[from] MdhErrors),
    #[error("joint {joint}: {what} {reason}")]
    Joint {
        joint: usize,
        /// What is wrong, e.g. `sign`.
        what: &'static str,
        /// Why, as the rest of the sentence ("must be 1 or -1, is 0.5").
        reason: String,
    },
    #[error("joint {joint}: its name `{}` is empty or that of a joint before it", name.escape_debug())]
    JointName { joint: usize, name: String },
    #[error("the joint `{}` beside the chain is behind a joint that is none of the {joints}", name.escape_debug())]
    Branch { name: String, joints: usize },
    #[error("a chain needs at least one joint")]
    NoJoints,
    #[error("{joints} joints, of at most {most}; choose a part of the robot")]
    TooManyJoints { joints: usize, most: usize },
    /// A chain in which joints follow others where one is needed whose joints all move on their own.
    #[error(
        "{followers} of the chain's {joints} joints follow another (mimic), which this does not know; models of such chains are \
         calibrated, validated, predicted and diagnosed, but not exported"
    )]
    Coupled { joints: usize, followers: usize },
    #[error(
        "joint {joint} does not sit on the link of the joint before it: this robot is a tree, and a chain is needed; choose one \
         by its tip"
    )]
    Tree { joint: usize },
    #[error("gravity {reason}")]
    Gravity { reason: String },
    #[error("{what}: expected {expected}, got {found}")]
    Count { what: &'static str, expected: usize, found: usize },
    #[error("{what} {index} is not finite: {value}")]
    NotFinite { what: &'static str, index: usize, value: f64 },
    /// The rank of the dummy observations did not settle, or two seeds disagree on the base parameters.
    #[error("the base parameters could not be determined: {reason}")]
    BaseParameters { reason: String },
}

/// Everything that is wrong with a table of modified Denavit–Hartenberg parameters, in the order of lines.
#[derive(Debug, Error)]
#[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
pub struct MdhErrors(pub Vec<MdhError>);

/// One thing that is wrong with a table of modified Denavit–Hartenberg parameters.
///
/// Lines and columns count from 1, as editors do.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum MdhError {
    #[error("{}: cannot be read: {source}", path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("{}: {reason}; a table starts with a line `alpha,a,d`, then one row per joint", path.display())]
    Empty { path: PathBuf, reason: &'static str },
    #[error(
        "{}:{line}: there are more than {most} rows, one joint a row; this table is no arm's", path.display()
    )]
    TooManyRows { path: PathBuf, line: usize, most: usize },
    #[error(
        "{}:{line}: the first line is `{text}`, but it must name the columns; \
         put a line such as `alpha,a,d` above it", path.display()
    )]
    MissingHeader { path: PathBuf, line: usize, text: String },
    #[error(
        "{}:{line}: there is no column `{column}` (found: {}); \
         the columns alpha (rad), a (m) and d (m) are needed, in any order",
        path.display(), found.join(", ")
    )]
    MissingColumn { path: PathBuf, line: usize, column: &'static str, found: Vec<String> },
    #[error(
        "{}:{line}: column {column_number} is called `{text}`{}; known are alpha, a, d, theta, sign, type",
        path.display(), meant.map(|m| format!(", did you mean `{m}`?")).unwrap_or_default()
    )]
    UnknownColumn {
        path: PathBuf,
        line: usize,
        column_number: usize,
        text: String,
        meant: Option<&'static str>,
    },
    #[error("{}:{line}: column {column_number} is called `{text}` as an earlier one; remove one of them", path.display())]
    DuplicateColumn { path: PathBuf, line: usize, column_number: usize, text: String },
    #[error(
        "{}:{line}: the row has {found} cells, the header has {expected}; row: `{text}`", path.display()
    )]
    CellCount { path: PathBuf, line: usize, expected: usize, found: usize, text: String },
    #[error("{}:{line}: `{text}` in column {column_number} ({column}) {reason}", path.display())]
    Cell {
        path: PathBuf,
        line: usize,
        column_number: usize,
        column: &'static str,
        text: String,
        /// What is wrong and how to mend it, as the rest of the sentence.
        reason: String,
    },
}

impl MdhError {
    /// The line that the error is about, from 1; `None` for the file as a whole.
    pub const fn line(&self) -> Option<usize> {
        match self {
            Self::Unreadable { .. } | Self::Empty { .. } => None,
            Self::TooManyRows { line, .. }
            | Self::MissingHeader { line, .. }
            | Self::MissingColumn { line, .. }
            | Self::UnknownColumn { line, .. }
            | Self::DuplicateColumn { line, .. }
            | Self::CellCount { line, .. }
            | Self::Cell { line, .. } => Some(*line),
        }
    }
}
