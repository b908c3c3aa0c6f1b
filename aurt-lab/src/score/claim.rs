use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;
use serde_json::Value;

use aurt_simulation::SimulationError;

use super::share::Share;

words! {
    Answer {
        NoMismatch = "no_mismatch",
        Named = "named",
        /// One of a class, of programs that have a word for it.
        Ambiguous = "ambiguous",
        /// What is named is missing, and something beside it.
        PartlyExplained = "partly_explained",
        /// Something is missing that has no name.
        Unexplained = "unexplained",
        /// Nothing is missing in the fitted recordings; the held-out ones differ from them.
        HeldOutDiffers = "held_out_differs",
        /// The diagnosis gave no verdict.
        Failed = "failed",
    }
}

impl Answer {
    pub const fn names(self) -> bool {
        matches!(self, Self::Named | Self::Ambiguous | Self::PartlyExplained)
    }

    /// Whether the answer says that something is missing beside what has a name.
    pub const fn leaves_something(self) -> bool {
        matches!(self, Self::PartlyExplained | Self::Unexplained | Self::HeldOutDiffers)
    }
}

/// What a verdict claims: the part of `verdict.json` that is scored. Further keys, `indications` among them, are no
/// claims and are not read.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Claim {
    /// The answer: what has changed where there are targets, else what the model lacks.
    pub verdict: Answer,
    /// What the model lacks in all recordings, in files that answer the two questions with two verdicts.
    #[serde(default)]
    pub structure: Option<Answer>,
    /// The effects, the most important first.
    #[serde(default)]
    pub effects: Vec<ClaimedEffect>,
    #[serde(default)]
    pub held_out: ClaimedHeldOut,
    /// What is left beside the claims, joint by joint.
    #[serde(default)]
    pub remainder: Vec<ClaimedRemainder>,
}

/// What is left of a joint's held-out error beside the claims.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct ClaimedRemainder {
    /// Share of its square that a black box predicts.
    #[serde(default)]
    pub predictable: Option<ClaimedShare>,
}

/// A share, without its deviation.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct ClaimedShare {
    pub value: f64,
}

/// The black box is better where it lowers the error by more than a twentieth: 1 − 0.95² of its square.
const BETTER: f64 = 0.0975;

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct ClaimedEffect {
    pub effect: String,
    #[serde(default)]
    pub joints: Vec<usize>,
    #[serde(default)]
    pub present_in: Vec<String>,
    #[serde(default)]
    pub window_s: Option<[f64; 2]>,
    #[serde(default)]
    pub confidence: Option<f64>,
    /// Parameters: `{name: {value, std}}`.
    #[serde(default)]
    pub parameters: BTreeMap<String, ClaimedValue>,
    #[serde(default)]
    pub alternatives: Vec<ClaimedAlternative>,
    /// Evidence: its score, and what else is said for it. What is no number is not used.
    #[serde(default)]
    pub evidence: BTreeMap<String, Value>,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct ClaimedValue {
    /// A number, or a list along the joints.
    pub value: Value,
    /// Its standard deviation, in the same form.
    #[serde(default)]
    pub std: Value,
}

#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct ClaimedAlternative {
    pub effect: String,
    #[serde(default)]
    pub joints: Vec<usize>,
}

/// Claimed residuals on held-out data, joint by joint.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct ClaimedHeldOut {
    pub rms_before: Vec<f64>,
    pub rms_after: Vec<f64>,
}

/// Whether kinds of recordings are the later ones alone: something has changed.
pub(super) fn is_change(present_in: &[String]) -> bool {
    !present_in.is_empty() && present_in.iter().all(|kind| kind == "target")
}

impl ClaimedEffect {
    /// Whether it is claimed of the later recordings alone.
    pub fn is_change(&self) -> bool {
        is_change(&self.present_in)
    }

    /// Its evidence as far as it is finite numbers, by name.
    pub fn numbers(&self) -> BTreeMap<String, f64> {
        let number = |(name, value): (&String, &Value)| {
            Some((name.clone(), value.as_f64().filter(|v| v.is_finite())?))
        };
        // What had to be exceeded says how poor the recordings are, and nothing of the finding.
        self.evidence.iter().filter(|(name, _)| *name != "threshold").filter_map(number).collect()
    }
}

impl Claim {
    /// Reads a `verdict.json`.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SimulationError> {
        let path = path.as_ref();
        let read = crate::json_file::read(path)?;
        Self::parse(read).map_err(|e| SimulationError::unreadable(path, e.to_string()))
    }

    pub(super) fn parse(verdict: Value) -> Result<Self, serde_json::Error> {
        if verdict.get("kind").and_then(Value::as_str) == Some("drive") {
            return serde_json::from_value::<DriveVerdict>(verdict).map(Self::from);
        }
        serde_json::from_value(verdict)
    }

    /// What a diagnosis that gave no verdict claims: nothing, and not even that.
    pub fn failed() -> Self {
        Self {
            verdict: Answer::Failed,
            structure: None,
            effects: Vec::new(),
            held_out: ClaimedHeldOut::default(),
            remainder: Vec::new(),
        }
    }

    /// Joints on which a black box is better than the improved model, of those on which it was judged.
    pub fn rival_better(&self) -> Share {
        Share::counted(self.remainder.iter().filter_map(|r| r.predictable), |p| p.value > BETTER)
    }

    /// The answer to what has changed, or to what is missing in all recordings.
    pub fn answer(&self, change: bool) -> Answer {
        if change { self.verdict } else { self.structure.unwrap_or(self.verdict) }
    }
}

/// The part of a verdict on drives that is scored: its structures are the arm's, and on no joint of their own.
#[derive(Debug, Deserialize)]
struct DriveVerdict {
    verdict: Answer,
    structures: Vec<Structure>,
    #[serde(default)]
    remainder: Vec<ClaimedRemainder>,
}

#[derive(Debug, Deserialize)]
struct Structure {
    id: String,
    answer: String,
    numbers: Vec<Number>,
    #[serde(default)]
    alternatives: Vec<String>,
    #[serde(default)]
    evidence: BTreeMap<String, Value>,
}

#[derive(Debug, Deserialize)]
struct Number {
    name: String,
    value: Value,
    deviation: Value,
}

impl From<DriveVerdict> for Claim {
    fn from(said: DriveVerdict) -> Self {
        let claimed = said.structures.into_iter().filter(|s| matches!(&*s.answer, "missing" | "given_wrong"));
        Self {
            effects: claimed.map(ClaimedEffect::from).collect(),
            remainder: said.remainder,
            verdict: said.verdict,
            ..Self::failed()
        }
    }
}

impl From<Structure> for ClaimedEffect {
    fn from(structure: Structure) -> Self {
        let number = |n: Number| (n.name, ClaimedValue { value: n.value, std: n.deviation });
        let other = |effect| ClaimedAlternative { effect, joints: Vec::new() };
        Self {
            effect: structure.id,
            joints: Vec::new(),
            present_in: vec!["calibration".into()],
            window_s: None,
            confidence: None,
            parameters: structure.numbers.into_iter().map(number).collect(),
            alternatives: structure.alternatives.into_iter().map(other).collect(),
            evidence: structure.evidence,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_word_or_two_and_indications_are_read() {
        let old: Claim = serde_json::from_str(r#"{"verdict": "named"}"#).unwrap();
        assert_eq!((old.answer(true), old.answer(false)), (Answer::Named, Answer::Named));
        let text = r#"{"verdict": "no_mismatch", "structure": "unexplained",
            "indications": [{"effect": "spring", "joints": [1]}]}"#;
        let new: Claim = serde_json::from_str(text).unwrap();
        assert_eq!((new.answer(true), new.answer(false)), (Answer::NoMismatch, Answer::Unexplained));
        assert!(new.effects.is_empty(), "an indication is no claim");
    }

    #[test]
    fn missing_structures_are_claims_and_needed_ones_are_not() {
        let text = r#"{"kind": "drive", "verdict": "named", "remainder": [], "structures": [
            {"id": "coulomb", "answer": "needed", "numbers": []},
            {"id": "dead_band", "answer": "missing", "alternatives": ["stribeck"],
             "numbers": [{"name": "dead_band_rad_0", "value": 0.01, "deviation": 0.001}]}]}"#;
        let claim = Claim::parse(serde_json::from_str(text).unwrap()).unwrap();
        assert_eq!(claim.verdict, Answer::Named);
        assert_eq!(claim.effects.len(), 1);
        assert_eq!(
            (&*claim.effects[0].effect, &*claim.effects[0].alternatives[0].effect),
            ("dead_band", "stribeck")
        );
        assert_eq!(claim.effects[0].parameters["dead_band_rad_0"].value, 0.01);
        assert!(Claim::parse(serde_json::json!({"kind": "drive", "verdict": "named"})).is_err());
    }
}
