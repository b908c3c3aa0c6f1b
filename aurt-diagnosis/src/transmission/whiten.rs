//! A filter that makes noise of any colour white: linear prediction of a joint's own residual.
//!
//! What the spectrum of the residual holds – the measurement's noise with its memory, the positions' noise coloured by
//! differentiation and by the arm's inertia, what slow physics leaves – is taken from the residual itself. A hypothesis
//! is then judged at each frequency by what is left there.

/// Prediction error filter 1 − Σ a_m z⁻ᵐ, divided by the standard deviation of what it leaves.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Whitener {
    taps: Vec<f64>,
}

/// Residuals beyond this many median deviations are taken as this large: an impact is no noise.
const CLIPPED: f64 = 4.0;
/// Median of |x| of a normal variable with unit deviation.
const NORMAL_MEDIAN: f64 = 0.674_49;
/// Samples that are filtered at once, in registers.
const LANES: usize = 8;
/// White noise added for numerical reasons, as a share of the power.
const RIDGE: f64 = 1e-9;

impl Whitener {
    /// From the samples of a residual that count, of the given order (Levinson–Durbin recursion on the
    /// autocorrelation); `None` if too few count or nothing is left.
    pub fn of(residual: &[f64], counts: &[bool], order: usize) -> Option<Self> {
        let counted = counts.iter().filter(|c| **c).count();
        if counted < 8 * (order + 1) {
            return None;
        }
        let limit = CLIPPED * median_magnitude(residual, counts) / NORMAL_MEDIAN;
        let clipped: Vec<f64> = residual
            .iter()
            .zip(counts)
            .map(|(r, counts)| if *counts { r.clamp(-limit, limit) } else { 0.0 })
            .collect();
        let mut correlation: Vec<f64> =
            (0..=order).map(|lag| clipped.iter().zip(&clipped[lag..]).map(|(a, b)| a * b).sum()).collect();
        correlation[0] *= 1.0 + RIDGE;
        let mut power = correlation[0];
        let positive = power > 0.0 && power.is_finite();
        if !positive {
            return None;
        }
        let mut predictor: Vec<f64> = Vec::with_capacity(order);
        for m in 1..=order {
            let known: f64 = predictor.iter().zip(correlation[1..m].iter().rev()).map(|(a, r)| a * r).sum();
            let reflection = (correlation[m] - known) / power;
            let mirrored: Vec<f64> = predictor.iter().rev().copied().collect();
            predictor.iter_mut().zip(mirrored).for_each(|(a, b)| *a -= reflection * b);
            predictor.push(reflection);
            power *= 1.0 - reflection * reflection;
        }
        let mut taps = vec![1.0];
        taps.extend(predictor.iter().map(|a| -a));
        let mut whitener = Self { taps };
        let left = whitener.apply(residual);
        let scale = median_magnitude(&left, counts) / NORMAL_MEDIAN;
        if scale.is_nan() || scale <= 0.0 {
            return None;
        }
        whitener.taps.iter_mut().for_each(|t| *t /= scale);
        Some(whitener)
    }

    /// Samples at the start that lack predecessors.
    pub fn memory(&self) -> usize {
        self.taps.len() - 1
    }

    /// The filtered series; samples that lack predecessors are filtered as if these were zero.
    pub fn apply(&self, series: &[f64]) -> Vec<f64> {
        let memory = self.memory();
        let mut padded = vec![0.0; memory + series.len().next_multiple_of(LANES)];
        padded[memory..memory + series.len()].copy_from_slice(series);
        let mut out = vec![0.0; padded.len() - memory];
        for (chunk, start) in out.chunks_exact_mut(LANES).zip((memory..).step_by(LANES)) {
            let mut sum = [0.0; LANES];
            for (lag, tap) in self.taps.iter().enumerate() {
                for (s, value) in sum.iter_mut().zip(&padded[start - lag..][..LANES]) {
                    *s += tap * value;
                }
            }
            chunk.copy_from_slice(&sum);
        }
        out.truncate(series.len());
        out
    }
}

/// Median of the magnitudes of the samples that count.
fn median_magnitude(series: &[f64], counts: &[bool]) -> f64 {
    let mut magnitudes: Vec<f64> =
        series.iter().zip(counts).filter(|(_, counts)| **counts).map(|(r, _)| r.abs()).collect();
    if magnitudes.is_empty() {
        return 0.0;
    }
    let middle = magnitudes.len() / 2;
    *magnitudes.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dice::Dice;

    fn noise(count: usize) -> Vec<f64> {
        let mut dice = Dice(7);
        (0..count).map(|_| dice.normal()).collect()
    }

    #[test]
    fn coloured_noise_comes_out_white_and_of_unit_variance() {
        let white = noise(20_000);
        let mut coloured = vec![0.0; white.len()];
        for k in 2..white.len() {
            coloured[k] = 1.6 * coloured[k - 1] - 0.8 * coloured[k - 2] + 0.3 * white[k];
        }
        let counts = vec![true; white.len()];
        let whitener = Whitener::of(&coloured, &counts, 6).unwrap();
        let out = whitener.apply(&coloured);
        let power =
            |lag: usize| out.iter().zip(&out[lag..]).map(|(a, b)| a * b).sum::<f64>() / out.len() as f64;
        assert!((power(0) - 1.0).abs() < 0.05, "{}", power(0));
        assert!((1..5).all(|lag| power(lag).abs() < 0.03), "{:?}", (1..5).map(power).collect::<Vec<_>>());
    }

    #[test]
    fn nothing_has_no_colour() {
        assert!(Whitener::of(&[0.0; 500], &[true; 500], 6).is_none());
        assert!(Whitener::of(&noise(500), &[false; 500], 6).is_none());
    }
}
