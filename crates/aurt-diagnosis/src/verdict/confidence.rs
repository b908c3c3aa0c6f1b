//! Confidence as a hit rate at a score.
//!
//! The rates are those of tuning proofs on simulated robots, of findings of every kind of case, strangers and nulls
//! included; `docs/proof.md` sets them beside the rates of a proof with another seed. On a real robot, whose noise is
//! not white and whose model lacks several things at once, they are an upper bound.

/// Scores and the share of findings of about that score that were right; interpolated in between. Below 60 there were
/// four findings, all right, which is too few to claim more.
const RELIABILITY: [(f64, f64); 4] = [(8.0, 0.7), (60.0, 0.85), (150.0, 0.91), (400.0, 0.98)];

/// Share of the first labels that were right where others do as well: 7 of 13.
const FIRST_OF_A_CLASS: f64 = 0.54;

/// The hit rate at a score, of a finding beside which others may or may not do as well.
#[must_use]
pub fn confidence(score: f64, has_alternatives: bool) -> f64 {
    if has_alternatives {
        return FIRST_OF_A_CLASS;
    }
    let (first, last) = (RELIABILITY[0], RELIABILITY[RELIABILITY.len() - 1]);
    if score <= first.0 {
        return first.1;
    }
    RELIABILITY.windows(2).find(|pair| score <= pair[1].0).map_or(last.1, |pair| {
        let share = (score - pair[0].0) / (pair[1].0 - pair[0].0);
        pair[0].1 + share * (pair[1].1 - pair[0].1)
    })
}

#[cfg(test)]
mod tests {
    use super::confidence;

    #[test]
    fn rises_with_the_score_and_falls_where_others_do_as_well() {
        let scores = [0.0, 10.0, 60.0, 100.0, 150.0, 1e4];
        assert!(scores.windows(2).all(|s| confidence(s[0], false) <= confidence(s[1], false)));
        assert!(scores.iter().all(|s| confidence(*s, true) < confidence(*s, false)));
    }
}
