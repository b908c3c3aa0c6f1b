//! What a recording is used for, and how a model does on it.

use aurt_calibration::{Comparison, Validation};

/// What a recording was used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The model was fitted to it.
    Calibration,
    /// It was held out.
    Validation,
}

impl Role {
    /// The role as files spell it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Calibration => "calibration",
            Self::Validation => "validation",
        }
    }
}

/// How the model does on one recording.
#[derive(Debug, Clone)]
pub struct RecordingResult {
    /// The recording as the user named it.
    pub label: String,
    /// What it was used for.
    pub role: Role,
    /// The part that was used, if not the whole.
    pub window_s: Option<[f64; 2]>,
    /// The errors.
    pub validation: Validation,
    /// The rows that the errors are means over.
    pub comparison: Comparison,
    /// The first stamp of the file, s.
    pub first_stamp_s: f64,
    /// What was found and done while it was read and preprocessed.
    pub notes: Vec<String>,
    /// Name of the file with its prediction.
    pub prediction: Option<String>,
}
