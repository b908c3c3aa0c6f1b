use std::path::PathBuf;

use thiserror::Error;

/// Everything that is wrong with a robot description, in the order of the file.
#[derive(Debug, Error)]
#[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
pub struct RobotErrors(pub Vec<RobotError>);

impl From<RobotError> for RobotErrors {
    fn from(error: RobotError) -> Self {
        Self(vec![error])
    }
}

/// One thing that is wrong with a robot description. Lines count from 1.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum RobotError {
    #[error("{}: cannot be read: {source}", path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("{}:{line}: {reason}", path.display())]
    Xml { path: PathBuf, line: u32, reason: String },
    #[error(
        "{}:{line}: `{text}` is xacro, a macro language that generates URDF files; \
         expand it with `xacro {} > robot.urdf` (`pip install xacro`) and name the result", path.display(), path.display()
    )]
    Xacro { path: PathBuf, line: u32, text: String },
    #[error("{}:{line}: {what}: {reason}", path.display())]
    Element {
        path: PathBuf,
        line: u32,
        /// The element: `joint elbow`.
        what: String,
        reason: String,
    },
    #[error("{}: {reason}", path.display())]
    NoTree { path: PathBuf, reason: String },
    #[error(
        "{}: there is no {kind} `{name}` for {which}{}; {kind}s: {}",
        path.display(), meant.as_ref().map(|m| format!(", did you mean `{m}`?")).unwrap_or_default(), known.join(", ")
    )]
    Unknown {
        path: PathBuf,
        /// `link` or `joint`.
        kind: &'static str,
        /// What it is to be: `the base`.
        which: &'static str,
        name: String,
        meant: Option<String>,
        /// The names of the file, or the first of many.
        known: Box<[String]>,
    },
    #[error(
        "{}: {joints} joints move, of at most {most}; choose a part of the robot by `base` and `tip`, `tips` or `joints` \
         (--base, --tip, --tips on the command line)", path.display()
    )]
    TooManyJoints {
        path: PathBuf,
        /// Number of joints that move, those that follow others included.
        joints: usize,
        most: usize,
    },
    #[error("{}: {reason}", path.display())]
    NoChain { path: PathBuf, reason: String },
}
