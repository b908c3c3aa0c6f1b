//! Confidence as an observed hit rate.

/// Scores and the share of findings with about that score that proofs showed to be right. Between two entries
/// the rate is interpolated.
const RELIABILITY: [(f64, f64); 5] = [(8.0, 0.5), (15.0, 0.7), (30.0, 0.85), (60.0, 0.93), (150.0, 0.97)];

/// The hit rate that proofs showed at a score.
#[must_use]
pub fn confidence(score: f64) -> f64 {
    let (first, last) = (RELIABILITY[0], RELIABILITY[RELIABILITY.len() - 1]);
    if score <= first.0 {
        return first.1;
    }
    RELIABILITY.windows(2).find(|pair| score <= pair[1].0).map_or(last.1, |pair| {
        let share = (score - pair[0].0) / (pair[1].0 - pair[0].0);
        pair[0].1 + share * (pair[1].1 - pair[0].1)
    })
}
