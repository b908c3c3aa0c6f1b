use serde::{Deserialize, Serialize};

use super::case_score::ScoredFinding;
use super::learnt::brier;
use super::share::{Share, mean};

/// How often findings of about one confidence were right.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Bin {
    pub from: f64,
    pub to: f64,
    pub claimed: f64,
    pub hits: Share,
}

/// What the confidences of findings were worth.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Reliability {
    /// Mean squared difference between confidence and truth (Brier 1950); 0 is perfect, that of always saying the hit
    /// rate p is p (1 − p).
    pub brier: Option<f64>,
    pub bins: Vec<Bin>,
}

/// Edges of the bins: tenths above a half, where most findings are; the last one splits what is nearly certain.
const EDGES: [f64; 8] = [0.0, 0.3, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95];

impl Reliability {
    pub(super) fn of(findings: &[&ScoredFinding], confidence: impl Fn(&ScoredFinding) -> f64) -> Self {
        let claims: Vec<(f64, bool)> = findings.iter().map(|f| (confidence(f), f.hit)).collect();
        let uppers = EDGES[1..].iter().copied().chain([f64::INFINITY]);
        let bins = EDGES
            .into_iter()
            .zip(uppers)
            .filter_map(|(from, upper)| {
                let inside: Vec<&(f64, bool)> =
                    claims.iter().filter(|(p, _)| *p >= from && *p < upper).collect();
                let claimed = mean(inside.iter().map(|(p, _)| *p))?;
                Some(Bin { from, to: upper.min(1.0), claimed, hits: Share::counted(inside, |(_, hit)| *hit) })
            })
            .collect();
        Self { brier: brier(claims.into_iter()), bins }
    }
}
