use thiserror::Error;

/// Why a drive cannot be simulated or estimated.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the messages name the fields")]
pub enum DriveError {
    #[error("{what}: expected {expected}, got {found}")]
    Count { what: &'static str, expected: usize, found: usize },
    #[error("`{name}` must lie within {} and {}, is {value}", bounds[0], bounds[1])]
    Bounds { name: String, value: f64, bounds: [f64; 2] },
    #[error("there is no number `{name}` to estimate; known: {known}")]
    Unknown { name: String, known: String },
    #[error("`{name}` is to be estimated and has no start; give a value at which it acts")]
    NoStart { name: String },
    #[error("recording {recording}: {reason}")]
    Recording { recording: usize, reason: String },
    #[error(
        "pieces of {piece_s:e} s have fewer than {rows} rows, from which their first velocity is taken; at least {least_s:.3} s are needed"
    )]
    ShortPieces { piece_s: f64, rows: usize, least_s: f64 },
    #[error(
        "the simulation of recording {recording} diverges at {time_s} s; check that positions and commands are in rad, give starts nearer to the robot, or a shorter step"
    )]
    Diverged { recording: usize, time_s: f64 },
    #[error("the held-out recordings are too short to decide anything; at least {needed_s} s are needed")]
    TooShort { needed_s: f64 },
}
