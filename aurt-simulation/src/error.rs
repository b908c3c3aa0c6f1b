//! Why a simulation is refused.

use std::path::{Path, PathBuf};

use aurt_rbd::RbdError;
use thiserror::Error;

/// Why a simulation was refused.
#[derive(Debug, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum SimulationError {
    #[error("{what} is {value}: {reason}")]
    Value { what: String, value: f64, reason: String },
    #[error(transparent)]
    Recording(Box<aurt_recording::RecordingError>),
    /// A joint or link that the robot does not have.
    #[error("{what} names {part} {index}, but {robot} has {available} (they count from 0)")]
    NoSuchPart {
        what: String,
        /// `joint` or `link`.
        part: &'static str,
        index: usize,
        robot: String,
        available: usize,
    },
    #[error("{what}: expected {expected}, got {found}")]
    Count { what: String, expected: usize, found: usize },
    /// A link's inertial parameters are those of no body.
    #[error("{robot}: {reason}; every link needs a positive mass and an inertia of a real body")]
    Body { robot: String, reason: String },
    /// A trajectory leaves what the robot can do.
    #[error(
        "the trajectory asks joint {joint} for {value:.4} {unit} of {quantity} at {time_s:.3} s, its limit is \
         {limit:.4} {unit}; make it slower or smaller"
    )]
    BeyondLimit {
        joint: usize,
        /// `position`, `velocity`, `acceleration` or `torque`.
        quantity: &'static str,
        unit: &'static str,
        value: f64,
        limit: f64,
        time_s: f64,
    },
    /// Two effects that cannot be in one simulation.
    #[error("effects {first} and {second} cannot act together on joint {joint}: {reason}")]
    Conflict { first: String, second: String, joint: usize, reason: String },
    #[error("unknown effect `{name}`{}; known are {}", meant.as_ref().map(|m| format!(", did you mean `{m}`?")).unwrap_or_default(), known.join(", "))]
    UnknownEffect { name: String, meant: Option<String>, known: Vec<String> },
    #[error("unknown robot `{name}`; known are {}", known.join(", "))]
    UnknownRobot { name: String, known: Vec<String> },
    #[error(
        "{what} has a rate of {rate_per_s:.0} 1/s, which needs steps of {needed_s:.1e} s; the smallest is \
         {smallest_s:.1e} s. Soften it or give the joint more inertia"
    )]
    TooStiff { what: String, rate_per_s: f64, needed_s: f64, smallest_s: f64 },
    #[error("the simulated motion of joint {joint} left its command at {time_s:.3} s: {reason}")]
    Diverged { joint: usize, time_s: f64, reason: String },
    #[error("{what} did not settle within {iterations} iterations at {time_s:.3} s (change {change:.1e})")]
    NotSettled { what: &'static str, iterations: usize, change: f64, time_s: f64 },
    #[error("{}: {reason}", path.display())]
    Unreadable { path: PathBuf, reason: String },
    /// A file that is not of its form, at a place; lines and columns (in characters) count from 1.
    #[error("{}:{line}:{column}: {reason}", path.display())]
    Syntax { path: PathBuf, line: usize, column: usize, reason: String },
    /// A file or folder that cannot be written or read.
    #[error("{}: {source}", path.display())]
    Io { path: PathBuf, source: std::io::Error },
    #[error("the simulated recording cannot be preprocessed: {reason}")]
    Preprocessing { reason: String },
    #[error(transparent)]
    RigidBody(#[from] RbdError),
    #[error(transparent)]
    Model(#[from] aurt_traits::ModelError),
    /// Several things are wrong.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Several(Vec<SimulationError>),
}

impl SimulationError {
    /// What TOML says of a text, with its place.
    pub fn syntax(path: &Path, text: &str, error: &toml::de::Error) -> Self {
        Self::at(path, text, error.span().map_or(0, |span| span.start), error.message().to_owned())
    }

    /// Refuses a text of so many tables that reading it would take minutes.
    pub fn refuse_tables(path: &Path, text: &str) -> Result<(), Self> {
        let reason =
            format!("such a file has at most {} tables, and this is one more", aurt_files::MOST_TABLES);
        aurt_files::table_beyond(text).map_or(Ok(()), |at| Err(Self::at(path, text, at, reason)))
    }

    /// What is wrong at a byte of a text.
    pub fn at(path: &Path, text: &str, byte: usize, reason: String) -> Self {
        let before = text.get(..byte).unwrap_or_default();
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        Self::Syntax {
            path: path.to_owned(),
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
            reason,
        }
    }

    pub fn unreadable(path: impl Into<PathBuf>, reason: impl Into<String>) -> Self {
        Self::Unreadable { path: path.into(), reason: reason.into() }
    }

    pub fn count(what: impl Into<String>, expected: usize, found: usize) -> Self {
        Self::Count { what: what.into(), expected, found }
    }

    pub fn text_of(path: &Path) -> Result<String, Self> {
        let io = |source| Self::Io { path: path.into(), source };
        aurt_files::read_text(path, aurt_files::MOST_TEXT_BYTES).map_err(io)
    }

    /// A value that cannot be.
    pub fn value(what: impl Into<String>, value: f64, reason: impl Into<String>) -> Self {
        Self::Value { what: what.into(), value, reason: reason.into() }
    }

    /// Nothing for no errors, the error for one, all of them for several.
    pub fn all(mut errors: Vec<Self>) -> Result<(), Self> {
        match errors.len() {
            0 => Ok(()),
            1 => Err(errors.remove(0)),
            _ => Err(Self::Several(errors)),
        }
    }
}

/// Complaints about values, collected.
#[derive(Debug, Default)]
pub struct Complaints(pub Vec<SimulationError>);

impl Complaints {
    /// Complains unless `value` is finite and > 0.
    pub fn positive(&mut self, what: impl Into<String>, value: f64) {
        if !(value.is_finite() && value > 0.0) {
            self.0.push(SimulationError::value(what, value, "it must be positive"));
        }
    }

    /// Complains unless `value` is finite and ≥ 0.
    pub fn not_negative(&mut self, what: impl Into<String>, value: f64) {
        if !(value.is_finite() && value >= 0.0) {
            self.0.push(SimulationError::value(what, value, "it must not be negative"));
        }
    }

    /// Complains unless `value` is finite and within [low, high].
    pub fn within(&mut self, what: impl Into<String>, value: f64, low: f64, high: f64) {
        if !(value.is_finite() && value >= low && value <= high) {
            let reason = format!("it must be between {low} and {high}");
            self.0.push(SimulationError::value(what, value, reason));
        }
    }

    /// Complains unless a part, `joint` or `link`, is one of the `available` ones of a robot.
    pub fn part(
        &mut self,
        what: String,
        part: &'static str,
        index: usize,
        (robot, available): (&str, usize),
    ) {
        if index >= available {
            let robot = robot.to_owned();
            self.0.push(SimulationError::NoSuchPart { what, part, index, robot, available });
        }
    }

    /// Nothing, the complaint, or all of them.
    pub fn finish(self) -> Result<(), SimulationError> {
        SimulationError::all(self.0)
    }
}

impl From<aurt_files::output::WriteError> for SimulationError {
    fn from(error: aurt_files::output::WriteError) -> Self {
        Self::Io { path: error.path, source: error.source }
    }
}

impl From<aurt_recording::RecordingError> for SimulationError {
    fn from(error: aurt_recording::RecordingError) -> Self {
        Self::Recording(Box::new(error))
    }
}
