//! Confidence as a hit rate: how often findings with such evidence were right in proofs.
//!
//! The rates are learnt (`aurt-lab prove --learn`) on cases whose truth is known, of findings under every answer, unknown effects
//! and nulls included; the file says from which worlds and seeds. On robots unlike all of these they are an upper bound.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};
use serde_json::json;

use super::Verdict;
use crate::DiagnosisError;

/// The version of the file of what was learnt.
pub const LEARNT_SCHEMA: u32 = 1;

/// The file that a diagnosis uses unless it is given another.
const EMBEDDED: &str = include_str!("../../learnt.json");

/// What was learnt from proofs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Learnt {
    /// Version of the file's form.
    pub schema: u32,
    /// The proofs that it was learnt from.
    pub learnt_from: Vec<LearntFrom>,
    /// How often findings are right, by their evidence.
    pub confidence: Curves,
    /// How often a finding is right that others do as well as.
    pub ambiguous: Rate,
}

/// One world of one proof.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LearntFrom {
    /// Name of the world.
    pub world: String,
    /// Seed of the proof.
    pub seed: u64,
    pub cases: usize,
    pub findings: usize,
    /// Findings that were right.
    pub hits: usize,
}

/// Hit rates over evidence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Curves {
    /// The evidence that tells most.
    pub by: String,
    /// For every kind of evidence: its value and the hit rate there, values ascending; linear in between and constant
    /// outside.
    pub curves: BTreeMap<String, Vec<[f64; 2]>>,
}

/// Hits of findings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rate {
    pub findings: usize,
    /// Those that were right.
    pub hits: usize,
}

impl Rate {
    /// The rate by Laplace's rule of succession: the mean of what it can be when nothing was known before.
    pub fn rate(self) -> f64 {
        (self.hits as f64 + 1.0) / (self.findings as f64 + 2.0)
    }
}

/// The evidence that every finding has.
pub const SCORE: &str = "score";

impl Learnt {
    /// What the program was built with.
    ///
    /// # Errors
    /// None that a test of this crate would not have found.
    pub fn embedded() -> Result<Self, DiagnosisError> {
        Self::parse(EMBEDDED, Path::new("learnt.json"))
    }

    /// Reads a file that `aurt-lab prove --learn` wrote.
    ///
    /// # Errors
    /// [`DiagnosisError::Learnt`].
    pub fn read(path: &Path) -> Result<Self, DiagnosisError> {
        let text = aurt_files::read_text(path, aurt_files::MOST_MODEL_BYTES)
            .map_err(|error| refusal(path, error.to_string()))?;
        Self::parse(&text, path)
    }

    /// Reads a text; `path` is what errors call it.
    ///
    /// # Errors
    /// [`DiagnosisError::Learnt`]: what is wrong with it.
    pub fn parse(text: &str, path: &Path) -> Result<Self, DiagnosisError> {
        let learnt: Self = serde_json::from_str(text).map_err(|error| refusal(path, error.to_string()))?;
        learnt.checked().map_err(|reason| refusal(path, reason))
    }

    fn checked(self) -> Result<Self, String> {
        if self.schema != LEARNT_SCHEMA {
            return Err(format!("has schema {}, this program reads {LEARNT_SCHEMA}", self.schema));
        }
        for name in [self.confidence.by.as_str(), SCORE] {
            if self.confidence.curves.get(name).is_none_or(Vec::is_empty) {
                return Err(format!("has no curve of the evidence `{name}`"));
            }
        }
        for (name, curve) in &self.confidence.curves {
            let are_rates = curve.iter().all(|[x, rate]| x.is_finite() && (0.0..=1.0).contains(rate));
            if !are_rates || !curve.windows(2).all(|w| w[0][0] < w[1][0]) {
                return Err(format!(
                    "the curve of `{name}` is not evidence, ascending, with rates between 0 and 1"
                ));
            }
        }
        if self.ambiguous.hits > self.ambiguous.findings {
            return Err("has more hits of ambiguous findings than findings".into());
        }
        Ok(self)
    }

    /// How often findings with such evidence were right; `ambiguous` if others do as well as this one.
    pub fn confidence(&self, evidence: &[(&str, f64)], ambiguous: bool) -> f64 {
        if ambiguous {
            return self.ambiguous.rate();
        }
        let by = |name: &str| {
            let (_, value) = evidence.iter().find(|(known, _)| *known == name)?;
            Some(interpolated(self.confidence.curves.get(name)?, *value))
        };
        by(&self.confidence.by).or_else(|| by(SCORE)).unwrap_or_else(|| Rate { findings: 0, hits: 0 }.rate())
    }

    /// Gives every finding of a verdict the confidence of its evidence.
    pub fn apply(&self, verdict: &mut Verdict) {
        for finding in &mut verdict.effects {
            let evidence = json!(finding.evidence);
            let numbers: Vec<(&str, f64)> = evidence
                .as_object()
                .into_iter()
                .flatten()
                .filter_map(|(name, value)| Some((name.as_str(), value.as_f64()?)))
                .collect();
            finding.confidence = self.confidence(&numbers, !finding.alternatives.is_empty());
        }
    }
}

fn refusal(path: &Path, reason: String) -> DiagnosisError {
    DiagnosisError::Learnt { path: path.to_owned(), reason }
}

/// The value of a curve: linear between its points, constant outside; a half where it has none.
pub fn interpolated(curve: &[[f64; 2]], x: f64) -> f64 {
    let (Some(first), Some(last)) = (curve.first(), curve.last()) else { return 0.5 };
    if x <= first[0] {
        return first[1];
    }
    curve.windows(2).find(|pair| x <= pair[1][0]).map_or(last[1], |pair| {
        let share = (x - pair[0][0]) / (pair[1][0] - pair[0][0]);
        pair[0][1] + share * (pair[1][1] - pair[0][1])
    })
}

static DEFAULT: LazyLock<Option<Learnt>> = LazyLock::new(|| Learnt::embedded().ok());

/// The hit rate at a score, by what the program was built with, of a finding beside which others may or may not do as
/// well.
pub fn confidence(score: f64, has_alternatives: bool) -> f64 {
    DEFAULT.as_ref().map_or(0.5, |learnt| learnt.confidence(&[(SCORE, score)], has_alternatives))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{EMBEDDED, Learnt, confidence};

    #[test]
    fn rises_with_the_score_and_falls_where_others_do_as_well() {
        assert!(Learnt::embedded().is_ok(), "{:?}", Learnt::embedded());
        let scores = [0.0, 10.0, 60.0, 100.0, 150.0, 1e4];
        assert!(scores.windows(2).all(|s| confidence(s[0], false) <= confidence(s[1], false)));
        assert!(scores.iter().all(|s| confidence(*s, true) < confidence(*s, false)));
    }

    #[test]
    fn the_evidence_that_tells_most_is_used_where_a_finding_has_it() {
        let text = r#"{"schema": 1, "learnt_from": [], "ambiguous": {"findings": 2, "hits": 1},
            "confidence": {"by": "p", "curves": {"p": [[-9.0, 0.9], [-3.0, 0.3]], "score": [[10.0, 0.6]]}}}"#;
        let learnt = Learnt::parse(text, Path::new("x.json")).unwrap();
        assert!((learnt.confidence(&[("score", 1.0), ("p", -6.0)], false) - 0.6).abs() < 1e-12);
        assert!((learnt.confidence(&[("p", -20.0)], false) - 0.9).abs() < 1e-12);
        assert!((learnt.confidence(&[("score", 99.0)], false) - 0.6).abs() < 1e-12);
        assert!((learnt.confidence(&[("score", 99.0)], true) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn files_that_cannot_be_used_say_why() {
        let wrong = |from: &str, to: &str| {
            let text = EMBEDDED.replace(from, to);
            assert_ne!(text, EMBEDDED, "{from}");
            Learnt::parse(&text, Path::new("mine.json")).unwrap_err().to_string()
        };
        assert!(wrong("\"schema\": 1", "\"schema\": 2").contains("schema 2"));
        assert!(wrong("\"by\": \"score\"", "\"by\": \"p\"").contains("`p`"));
        assert!(wrong("0.7", "7").contains("between 0 and 1"));
        assert!(wrong("\"hits\"", "\"his\"").contains("mine.json"));
    }
}
