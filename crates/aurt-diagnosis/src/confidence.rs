//! Confidence as a hit rate at a score.
//!
//! The table is provisional: it orders findings rightly, but its rates are not yet those of a full proof. Verdicts say
//! so in a note, and people are shown the score.

/// Scores and the share of findings of about that score that are taken to be right; interpolated in between.
const RELIABILITY: [(f64, f64); 5] = [(8.0, 0.5), (15.0, 0.7), (30.0, 0.85), (60.0, 0.93), (150.0, 0.97)];

/// The provisional hit rate at a score.
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
