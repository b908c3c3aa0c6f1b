//! How strong an effect is to be.

use serde::{Deserialize, Serialize};

/// How strong an effect is to be: its torque that the baseline cannot absorb, root mean square over the
/// standard deviation of the measured torque's noise, on the joint where it is largest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Strength {
    /// 0.3.
    Weak,
    /// 1.
    Medium,
    /// 3.
    Strong,
}

impl Strength {
    /// All, weakest first.
    pub const ALL: [Self; 3] = [Self::Weak, Self::Medium, Self::Strong];

    /// The ratio that is aimed at.
    pub const fn over_noise(self) -> f64 {
        match self {
            Self::Weak => 0.3,
            Self::Medium => 1.0,
            Self::Strong => 3.0,
        }
    }

    /// What the unaltered model leaves, times this, is the wanted root mean square of an effect added to recordings.
    pub const fn over_left(self) -> f64 {
        match self {
            Self::Weak => 0.7,
            Self::Medium => 1.5,
            Self::Strong => 4.0,
        }
    }

    pub const fn name(self) -> &'static str {
        match self {
            Self::Weak => "weak",
            Self::Medium => "medium",
            Self::Strong => "strong",
        }
    }
}
