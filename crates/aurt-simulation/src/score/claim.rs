use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::SimulationError;

/// The answer of a verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// Nothing is missing.
    NoMismatch,
    /// What is missing has a name.
    Named,
    /// One of a class.
    Ambiguous,
    /// Something is missing that has no name.
    Unexplained,
}

/// What a verdict claims: the part of `verdict.json` that is scored. Further keys are nobody's business here.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Claim {
    /// The answer.
    pub verdict: Answer,
    /// The effects, the most important first.
    #[serde(default)]
    pub effects: Vec<ClaimedEffect>,
    /// Residuals on data that took no part.
    #[serde(default)]
    pub held_out: ClaimedHeldOut,
}

/// An effect that a verdict names.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct ClaimedEffect {
    /// Identifier.
    pub effect: String,
    /// Joints.
    #[serde(default)]
    pub joints: Vec<usize>,
    /// Kinds of recordings that have it.
    #[serde(default)]
    pub present_in: Vec<String>,
    /// When it acts, s.
    #[serde(default)]
    pub window_s: Option<[f64; 2]>,
    /// How sure the verdict is.
    #[serde(default)]
    pub confidence: Option<f64>,
    /// Parameters: `{name: {value, std}}`.
    #[serde(default)]
    pub parameters: BTreeMap<String, ClaimedValue>,
    /// What else it could be.
    #[serde(default)]
    pub alternatives: Vec<ClaimedAlternative>,
    /// Evidence.
    #[serde(default)]
    pub evidence: Option<ClaimedEvidence>,
}

/// A claimed parameter.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct ClaimedValue {
    /// A number, or a list along the joints.
    pub value: Value,
}

/// A claimed alternative.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct ClaimedAlternative {
    /// Identifier.
    pub effect: String,
}

/// Claimed evidence.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct ClaimedEvidence {
    /// The score of the claim.
    pub score: f64,
}

/// Claimed residuals on data that took no part, joint by joint.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct ClaimedHeldOut {
    /// Before.
    pub rms_before: Vec<f64>,
    /// With what is named.
    pub rms_after: Vec<f64>,
}

impl Claim {
    /// Reads a `verdict.json`.
    ///
    /// # Errors
    /// [`SimulationError::Io`] or [`SimulationError::Unreadable`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SimulationError> {
        crate::json_file::read(path.as_ref())
    }

    /// Identifiers without repetition, in the verdict's order.
    #[must_use]
    pub fn names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for effect in &self.effects {
            if !names.contains(&effect.effect.as_str()) {
                names.push(&effect.effect);
            }
        }
        names
    }

    /// Joints of all claims of one identifier, sorted.
    #[must_use]
    pub fn joints_of(&self, effect: &str) -> Vec<usize> {
        let mut joints: Vec<usize> =
            self.effects.iter().filter(|e| e.effect == effect).flat_map(|e| e.joints.clone()).collect();
        joints.sort_unstable();
        joints.dedup();
        joints
    }
}
