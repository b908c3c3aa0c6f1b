use std::fmt;

use crate::error::RecordingError;
use crate::preprocess::options::PreprocessOptions;
use crate::recording::Recording;

/// Why a stretch between gaps cannot be used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Refusal {
    Short { samples: usize, needed: usize, after: &'static str },
    AtRest { joint: usize, fastest_rad_s: f64 },
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Short { samples, needed, after } => {
                write!(f, "{samples} samples{after} are too few, {needed} are needed")
            }
            Self::AtRest { .. } => write!(f, "no joint moves"),
        }
    }
}

impl Refusal {
    /// Of two refusals the one that says more about the recording as a whole.
    pub(super) fn worse(self, other: Self) -> Self {
        match (self, other) {
            (Self::Short { samples: a, .. }, Self::Short { samples: b, .. }) if b > a => other,
            (Self::Short { .. }, Self::AtRest { .. }) => other,
            (Self::AtRest { fastest_rad_s: a, .. }, Self::AtRest { fastest_rad_s: b, .. }) if b > a => other,
            _ => self,
        }
    }

    pub(super) fn into_error(self, recording: &Recording, options: &PreprocessOptions) -> RecordingError {
        let path = recording.file.clone();
        match self {
            Self::Short { samples, needed, after } => RecordingError::TooShort {
                path,
                samples,
                needed,
                after,
                remedy: "record longer, begin and end at rest, or check max_gap_s and the window".into(),
            },
            Self::AtRest { joint, fastest_rad_s } => RecordingError::AtRest {
                path,
                threshold_rad_s: options.rest_velocity_rad_s,
                joint,
                fastest_rad_s,
            },
        }
    }
}
