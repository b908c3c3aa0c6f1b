//! Strengths that are tried, and the smallest of them at which something holds.

use std::f64::consts::SQRT_2;

use serde::Serialize;

/// Strengths, in units of what the model leaves: steps of √2, so that a limit between two of them is known to a factor of
/// 1.19 either way.
pub const LEVELS: [f64; 13] = [
    0.125,
    0.125 * SQRT_2,
    0.25,
    0.25 * SQRT_2,
    0.5,
    0.5 * SQRT_2,
    1.0,
    SQRT_2,
    2.0,
    2.0 * SQRT_2,
    4.0,
    4.0 * SQRT_2,
    8.0,
];

/// Half a step of the ladder, as a ratio: a limit lies between the last level that was not enough and the first that was.
pub const HALF_STEP: f64 = 1.189_207_115_002_721;

/// A size from which on something happens.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limit {
    pub size: f64,
    /// The same in units of what the model leaves.
    pub strength: f64,
}

/// The smallest of `0..top` at which `holds`, if it holds from somewhere on: outwards from a guess in growing steps, then by
/// halves.
pub fn smallest<E>(
    top: usize,
    guess: usize,
    mut holds: impl FnMut(usize) -> Result<bool, E>,
) -> Result<Option<usize>, E> {
    // The first that may hold, and the first that does.
    let (mut open, mut known) = (0, top);
    let (mut at, mut step) = (guess.min(top.saturating_sub(1)), 1);
    while open < known {
        if holds(at)? {
            known = at;
        } else {
            open = at + 1;
        }
        at = if open > 0 && known < top {
            usize::midpoint(open, known)
        } else if open == 0 {
            known.saturating_sub(step)
        } else {
            (open + step - 1).min(top - 1)
        };
        step *= 2;
    }
    Ok((known < top).then_some(known))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_is_found_from_any_guess_in_few_trials() {
        for top in 1..=LEVELS.len() {
            for guess in 0..top {
                for first in 0..=top {
                    let mut tried = Vec::new();
                    let found = smallest(top, guess, |at| {
                        assert!(!tried.contains(&at), "{at} again: {tried:?}");
                        tried.push(at);
                        Ok::<_, ()>(at >= first)
                    });
                    assert_eq!(found, Ok((first < top).then_some(first)), "{top} {guess}");
                    assert!(tried.len() <= 2 + 2 * first.abs_diff(guess).min(3), "{tried:?}");
                }
            }
        }
    }

    #[test]
    fn a_limit_is_half_a_step_from_two_levels() {
        assert!(LEVELS.windows(2).all(|w| (w[1] / w[0] - HALF_STEP * HALF_STEP).abs() < 1e-12));
    }
}
