use std::collections::BTreeMap;

use aurt_diagnosis::{Curves, LEARNT_SCHEMA, Learnt, LearntFrom, Rate, SCORE, interpolated};

use super::case_score::{CaseScore, ScoredFinding};
use super::isotonic::isotonic;
use crate::case::World;

fn rate<'a>(findings: impl Iterator<Item = &'a ScoredFinding>) -> Rate {
    findings.fold(Rate { findings: 0, hits: 0 }, |rate, f| Rate {
        findings: rate.findings + 1,
        hits: rate.hits + usize::from(f.hit),
    })
}

/// Learns from the scores of proofs: world, seed, scores. Findings under every answer count, those under
/// `unexplained` as well; cases whose candidate was removed have none.
pub fn learnt(proofs: &[(World, u64, &[CaseScore])]) -> Learnt {
    let from = |(world, seed, scores): &(World, u64, &[CaseScore])| {
        let own: Vec<&CaseScore> = scores.iter().filter(|s| s.removed.is_none()).collect();
        let Rate { findings, hits } = rate(own.iter().flat_map(|s| &s.findings));
        LearntFrom { world: world.name().to_owned(), seed: *seed, cases: own.len(), findings, hits }
    };
    let all: Vec<&ScoredFinding> =
        proofs.iter().flat_map(|(.., scores)| scores.iter().flat_map(|s| &s.findings)).collect();
    Learnt {
        schema: LEARNT_SCHEMA,
        learnt_from: proofs.iter().map(from).collect(),
        confidence: curves(&all.iter().copied().filter(|f| !f.ambiguous).collect::<Vec<_>>()),
        ambiguous: rate(all.iter().copied().filter(|f| f.ambiguous)),
    }
}

pub fn confidence(learnt: &Learnt, finding: &ScoredFinding) -> f64 {
    let evidence: Vec<(&str, f64)> =
        finding.evidence.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    learnt.confidence(&evidence, finding.ambiguous)
}

fn curves(findings: &[&ScoredFinding]) -> Curves {
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
    Curves { by: best.map_or(SCORE, |(_, name)| name).to_owned(), curves }
}

/// Mean squared difference between probabilities and what happened (Brier 1950).
pub(super) fn brier(claims: impl Iterator<Item = (f64, bool)>) -> Option<f64> {
    let (sum, count) = claims.fold((0.0, 0), |(sum, count), (p, hit)| {
        let missed: f64 = p - f64::from(u8::from(hit));
        (sum + missed * missed, count + 1)
    });
    (count > 0).then(|| sum / f64::from(count))
}
