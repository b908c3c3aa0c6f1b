use std::path::PathBuf;

use thiserror::Error;

/// What can be wrong with a request to this crate.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RbdError {
    /// A table of modified Denavit–Hartenberg parameters could not be read.
    #[error(transparent)]
    Mdh(#[from] MdhErrors),
    /// A joint of a chain has a value that no joint can have.
    #[error("joint {joint}: {what} {reason}")]
    Joint {
        /// The joint, from 0.
        joint: usize,
        /// What is wrong, e.g. `sign`.
        what: &'static str,
        /// Why, as the rest of the sentence ("must be 1 or -1, is 0.5").
        reason: String,
    },
    /// A name that cannot be a joint's.
    #[error("joint {joint}: its name `{}` is empty or that of a joint before it", name.escape_debug())]
    JointName {
        /// The joint, from 0.
        joint: usize,
        /// Its name.
        name: String,
    },
    /// A joint beside the chain behind one that is not there.
    #[error("the joint `{}` beside the chain is behind a joint that is none of the {joints}", name.escape_debug())]
    Branch {
        /// The joint beside the chain.
        name: String,
        /// Joints of the chain.
        joints: usize,
    },
    /// A chain without joints.
    #[error("a chain needs at least one joint")]
    NoJoints,
    /// More joints than any robot has.
    #[error("{joints} joints, of at most {most}; choose a part of the robot")]
    TooManyJoints {
        /// Number of joints.
        joints: usize,
        /// How many there may be.
        most: usize,
    },
    /// A chain in which joints follow others where one is needed whose joints all move on their own.
    #[error(
        "{followers} of the chain's {joints} joints follow another (mimic), which this does not know; models of such chains are \
         calibrated, validated, predicted and diagnosed, but not exported"
    )]
    Coupled {
        /// Number of joints.
        joints: usize,
        /// Number of those that follow another.
        followers: usize,
    },
    /// A tree where a chain is needed.
    #[error(
        "joint {joint} does not sit on the link of the joint before it: this robot is a tree, and a chain is needed; choose one \
         by its tip"
    )]
    Tree {
        /// The first such joint, from 0.
        joint: usize,
    },
    /// The gravity vector has an entry that is not finite, or that no robot meets.
    #[error("gravity {reason}")]
    Gravity {
        /// What is wrong, as the rest of the sentence.
        reason: String,
    },
    /// Two things that must have the same number of entries do not.
    #[error("{what}: expected {expected}, got {found}")]
    Count {
        /// What was counted.
        what: &'static str,
        /// The number that is right.
        expected: usize,
        /// The number that was found.
        found: usize,
    },
    /// Inertial parameters or rotor inertias with an entry that is not finite.
    #[error("{what} {index} is not finite: {value}")]
    NotFinite {
        /// What has the entry.
        what: &'static str,
        /// The entry's index, from 0.
        index: usize,
        /// The entry.
        value: f64,
    },
    /// The rank of the dummy observations did not settle, or two seeds disagree on the base parameters.
    #[error("the base parameters could not be determined: {reason}")]
    BaseParameters {
        /// What happened, and what to do.
        reason: String,
    },
    /// An instruction set was asked for by a name that is not known, or that this processor does not have.
    #[error("SIMD level `{asked}` {reason}; available here: {available}")]
    Dispatch {
        /// What was asked for.
        asked: String,
        /// Why it cannot be had.
        reason: &'static str,
        /// What can be had, comma separated.
        available: String,
    },
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
pub enum MdhError {
    /// The file could not be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// There is no header, or no row below it.
    #[error("{}: {reason}; a table starts with a line `alpha,a,d`, then one row per joint", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
        /// What is missing.
        reason: &'static str,
    },
    /// More rows than any arm has joints.
    #[error(
        "{}:{line}: there are more than {most} rows, one joint a row; this table is no arm's", path.display()
    )]
    TooManyRows {
        /// The file.
        path: PathBuf,
        /// The first line too many.
        line: usize,
        /// How many there may be.
        most: usize,
    },
    /// The first line holds numbers where the names of the columns belong.
    #[error(
        "{}:{line}: the first line is `{text}`, but it must name the columns; \
         put a line such as `alpha,a,d` above it", path.display()
    )]
    MissingHeader {
        /// The file.
        path: PathBuf,
        /// The line.
        line: usize,
        /// The line's text.
        text: String,
    },
    /// A column that every table needs is not there.
    #[error(
        "{}:{line}: there is no column `{column}` (found: {}); \
         the columns alpha (rad), a (m) and d (m) are needed, in any order",
        path.display(), found.join(", ")
    )]
    MissingColumn {
        /// The file.
        path: PathBuf,
        /// The line of the header.
        line: usize,
        /// The column's name.
        column: &'static str,
        /// The columns that are there.
        found: Vec<String>,
    },
    /// A column of a name that means nothing here.
    #[error(
        "{}:{line}: column {column_number} is called `{text}`{}; known are alpha, a, d, theta, sign, type",
        path.display(), meant.map(|m| format!(", did you mean `{m}`?")).unwrap_or_default()
    )]
    UnknownColumn {
        /// The file.
        path: PathBuf,
        /// The line of the header.
        line: usize,
        /// The column, from 1.
        column_number: usize,
        /// The name as written.
        text: String,
        /// What was probably meant.
        meant: Option<&'static str>,
    },
    /// Two columns of one name.
    #[error("{}:{line}: column {column_number} is called `{text}` as an earlier one; remove one of them", path.display())]
    DuplicateColumn {
        /// The file.
        path: PathBuf,
        /// The line of the header.
        line: usize,
        /// The later column, from 1.
        column_number: usize,
        /// The name.
        text: String,
    },
    /// A row with too many or too few cells.
    #[error(
        "{}:{line}: the row has {found} cells, the header has {expected}; row: `{text}`", path.display()
    )]
    CellCount {
        /// The file.
        path: PathBuf,
        /// The row's line.
        line: usize,
        /// Number of columns of the header.
        expected: usize,
        /// Number of cells of the row.
        found: usize,
        /// The row's text.
        text: String,
    },
    /// A cell that does not hold what its column asks for.
    #[error("{}:{line}: `{text}` in column {column_number} ({column}) {reason}", path.display())]
    Cell {
        /// The file.
        path: PathBuf,
        /// The cell's line.
        line: usize,
        /// The cell's column, from 1.
        column_number: usize,
        /// The column's name.
        column: &'static str,
        /// The cell's text.
        text: String,
        /// What is wrong and how to mend it, as the rest of the sentence.
        reason: String,
    },
}

impl MdhError {
    /// The line that the error is about, from 1; `None` for the file as a whole.
    #[must_use]
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
