//! What a single series of samples says of its sensor: resolution and noise.

use aurt_recording::median;

/// Share of the steps between samples that must fit a resolution.
const FITTING_SHARE: f64 = 0.99;

/// The resolution to which values were rounded: the smallest step between neighbouring samples of which all other
/// steps are multiples. `None` if there is none, or fewer than ten samples differ.
pub fn resolution(values: &[f64]) -> Option<f64> {
    let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    // Below this two values differ by rounding of the decimal text alone.
    let dust = 1e-12 * largest;
    let steps: Vec<f64> =
        values.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|s| *s > dust && s.is_finite()).collect();
    if steps.len() < 10 {
        return None;
    }
    let smallest = steps.iter().copied().fold(f64::INFINITY, f64::min);
    // The smallest step carries the rounding of two decimal texts; the mean over large multiples does not.
    let multiples: f64 = steps.iter().map(|s| (s / smallest).round()).sum();
    let step = steps.iter().sum::<f64>() / multiples;
    let fits = |s: &&f64| {
        let multiple = *s / step;
        (multiple - multiple.round()).abs() < 0.02
    };
    let fitting = steps.iter().filter(fits).count();
    // With multiples beyond some hundred everything fits; that is no evidence.
    let telling = multiples / steps.len() as f64;
    (fitting as f64 >= FITTING_SHARE * steps.len() as f64 && telling < 500.0).then_some(step)
}

/// Standard deviation of the part of a uniformly sampled series that has no memory: white noise.
///
/// Fourth differences take smooth motion away and multiply the variance of white noise by 70; the median of their
/// magnitudes is not moved by single leaps.
pub fn white_noise(values: &[f64]) -> Option<f64> {
    let mut differences: Vec<f64> =
        values.windows(5).map(|w| (w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4]).abs()).collect();
    (!differences.is_empty()).then(|| median(&mut differences) / 0.674_489_75 / 70.0_f64.sqrt())
}

pub fn range(values: &[f64]) -> [f64; 2] {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(*v), high.max(*v)])
}

/// Root mean square; 0 of nothing.
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// How often a velocity changes its direction, counting only strokes that reach `threshold`.
pub fn reversals(velocity: &[f64], threshold: f64) -> usize {
    let mut direction = 0.0;
    let mut count = 0;
    for v in velocity.iter().filter(|v| v.abs() > threshold) {
        if direction * v < 0.0 {
            count += 1;
        }
        direction = v.signum();
    }
    count
}

#[cfg(test)]
mod tests {
    use aurt_simulation::Random;

    use super::*;

    #[test]
    fn rounding_shows() {
        let smooth: Vec<f64> = (0..3000).map(|k| (f64::from(k) * 0.003).sin()).collect();
        let rounded: Vec<f64> = smooth.iter().map(|v| (v * 1e4).round() / 1e4).collect();
        let found = resolution(&rounded).unwrap();
        assert!((found - 1e-4).abs() < 1e-7, "{found}");
        assert_eq!(resolution(&smooth), None);
        assert_eq!(resolution(&[1.0; 100]), None);
    }

    #[test]
    fn noise_is_told_from_motion() {
        let mut random = Random::new(1);
        let noise: Vec<f64> = (0..20_000).map(|_| random.unit() - 0.5).collect();
        // A uniform number between −½ and ½ has a standard deviation of 1/√12.
        let series: Vec<f64> =
            noise.iter().enumerate().map(|(k, n)| 5.0 * (k as f64 * 0.01).sin() + 0.02 * n).collect();
        let found = white_noise(&series).unwrap();
        assert!((found / (0.02 / 12.0_f64.sqrt()) - 1.0).abs() < 0.1, "{found}");
        assert_eq!(white_noise(&[1.0; 4]), None);
    }

    #[test]
    fn dithering_about_rest_is_no_reversal() {
        let velocity = [0.0, 0.5, 0.4, -0.01, 0.01, -0.01, 0.5, -0.5, -0.2, 0.3];
        assert_eq!(reversals(&velocity, 0.1), 2);
    }
}
