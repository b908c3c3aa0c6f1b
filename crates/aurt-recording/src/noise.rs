//! The noise of a series of samples, beneath its motion.

/// The difference operator whose output is taken as noise: of fourth order, so that motion far below half the
/// sampling rate is gone.
const DIFFERENCE: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];

/// Standard deviation of the white part of a series, from its fourth differences; the median of their
/// magnitudes is used, so that impacts and reversals do not count.
#[must_use]
pub fn white_level(series: &[f64]) -> f64 {
    let power: f64 = DIFFERENCE.iter().map(|c| c * c).sum();
    let mut magnitudes: Vec<f64> = series
        .windows(DIFFERENCE.len())
        .map(|w| w.iter().zip(DIFFERENCE).map(|(x, c)| x * c).sum::<f64>().abs())
        .collect();
    if magnitudes.is_empty() {
        return 0.0;
    }
    let middle = magnitudes.len() / 2;
    let (_, median, _) = magnitudes.select_nth_unstable_by(middle, f64::total_cmp);
    // The median of |x| of a normal variable is 0.6745 of its standard deviation.
    *median / 0.674_49 / power.sqrt()
}

#[cfg(test)]
mod tests {
    use super::white_level;

    #[test]
    fn noise_is_measured_beneath_a_motion() {
        let mut state = 1_u64;
        let mut normal = || {
            let mut uniform = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1_u64 << 53) as f64
            };
            (0..12).map(|_| uniform()).sum::<f64>() - 6.0
        };
        let series: Vec<f64> = (0..5000).map(|k| 3.0 * (k as f64 * 0.01).sin() + 0.02 * normal()).collect();
        let level = white_level(&series);
        assert!((level - 0.02).abs() < 0.001, "{level}");
    }
}
