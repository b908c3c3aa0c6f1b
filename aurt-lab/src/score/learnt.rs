use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::case_score::{CaseScore, ScoredFinding};
use super::isotonic::{interpolated, isotonic};
use crate::case::World;

pub const SCHEMA: u32 = 1;

/// What was learnt from proofs, in a file that `aurt diagnose` reads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Learnt {
    /// Version of the file's form.
    pub schema: u32,
    pub learnt_from: Vec<LearntFrom>,
    /// How often findings are right, by their evidence.
    pub confidence: Curves,
    /// How often a finding is right that others do as well as.
    pub ambiguous: Rate,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LearntFrom {
    pub world: World,
    pub seed: u64,
    pub cases: usize,
    pub findings: usize,
    pub hits: usize,
}

/// Hit rates over evidence.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Curves {
    /// The evidence that tells most.
    pub by: String,
    /// For every kind of evidence: its value and the hit rate there, values ascending; linear in between and constant
    /// outside.
    pub curves: BTreeMap<String, Vec<[f64; 2]>>,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rate {
    pub findings: usize,
    pub hits: usize,
}

impl Rate {
    fn of<'a>(findings: impl Iterator<Item = &'a ScoredFinding>) -> Self {
        findings.fold(Self::default(), |rate, f| Self {
            findings: rate.findings + 1,
            hits: rate.hits + usize::from(f.hit),
        })
    }

    /// The rate by Laplace's rule of succession: the mean of what it can be when nothing was known before.
    pub fn rate(&self) -> f64 {
        (self.hits as f64 + 1.0) / (self.findings as f64 + 2.0)
    }
}

/// The evidence that every finding of every version has.
const SCORE: &str = "score";

impl Learnt {
    /// Learns from the scores of proofs: world, seed, scores. Findings under every answer count, those under
    /// `unexplained` as well; cases whose candidate was removed have none.
    pub fn of(proofs: &[(World, u64, &[CaseScore])]) -> Self {
        let learnt_from = proofs
            .iter()
            .map(|(world, seed, scores)| {
                let own: Vec<&CaseScore> = scores.iter().filter(|s| s.removed.is_none()).collect();
                let rate = Rate::of(own.iter().flat_map(|s| &s.findings));
                let (world, seed) = (*world, *seed);
                LearntFrom { world, seed, cases: own.len(), findings: rate.findings, hits: rate.hits }
            })
            .collect();
        let all: Vec<&ScoredFinding> =
            proofs.iter().flat_map(|(.., scores)| scores.iter().flat_map(|s| &s.findings)).collect();
        Self {
            schema: SCHEMA,
            learnt_from,
            confidence: Curves::of(&all.iter().copied().filter(|f| !f.ambiguous).collect::<Vec<_>>()),
            ambiguous: Rate::of(all.iter().copied().filter(|f| f.ambiguous)),
        }
    }

    pub fn confidence(&self, finding: &ScoredFinding) -> f64 {
        if finding.ambiguous {
            return self.ambiguous.rate();
        }
        self.confidence.rate(&finding.evidence).unwrap_or_else(|| Rate::default().rate())
    }
}

impl Curves {
    fn of(findings: &[&ScoredFinding]) -> Self {
        let mut names: Vec<&String> = findings.iter().flat_map(|f| f.evidence.keys()).collect();
        names.sort();
        names.dedup();
        let mut curves = BTreeMap::new();
        let mut best: Option<(f64, &str)> = None;
        for name in names {
            let points: Vec<(f64, bool)> =
                findings.iter().filter_map(|f| Some((*f.evidence.get(name)?, f.hit))).collect();
            let curve = isotonic(&points);
            let error = brier(points.iter().map(|(x, hit)| (interpolated(&curve, *x), *hit)));
            // Evidence that some findings lack cannot be what all are judged by. Of equals the score is taken.
            let candidate = error.filter(|_| points.len() == findings.len());
            if let Some(error) = candidate
                && best.is_none_or(|(least, _)| error < least || error <= least && name == SCORE)
            {
                best = Some((error, name));
            }
            curves.insert(name.clone(), curve);
        }
        Self { by: best.map_or(SCORE, |(_, name)| name).to_owned(), curves }
    }

    /// The hit rate at some evidence: by what tells most, else by the score; none where neither is there.
    pub fn rate(&self, evidence: &BTreeMap<String, f64>) -> Option<f64> {
        let by = |name: &str| Some(interpolated(self.curves.get(name)?, *evidence.get(name)?));
        by(&self.by).or_else(|| by(SCORE))
    }
}

/// Mean squared difference between probabilities and what happened (Brier 1950).
pub(super) fn brier(claims: impl Iterator<Item = (f64, bool)>) -> Option<f64> {
    let (sum, count) = claims.fold((0.0, 0), |(sum, count), (p, hit)| {
        let missed: f64 = p - f64::from(u8::from(hit));
        (sum + missed * missed, count + 1)
    });
    (count > 0).then(|| sum / f64::from(count))
}
