//! What a single series of samples says of its sensor: resolution and noise.

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
    if differences.is_empty() {
        return None;
    }
    let middle = differences.len() / 2;
    let median = *differences.select_nth_unstable_by(middle, f64::total_cmp).1;
    Some(median / 0.674_489_75 / 70.0_f64.sqrt())
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

/// The frequency below which 99.9 % of the power of a uniformly sampled series lies, in Hz, beside noise whose one-sided
/// spectrum is `noise_psd`; `None` if nothing exceeds the noise.
///
/// Hann's window keeps a series that does not end as it began from having power at all frequencies. A bin of noise of mean N
/// has more than x N with the probability e^−x: none of n bins has more than 2 N ln n but with the probability 1/n, and those
/// that have are motion.
pub fn bandwidth_hz(values: &[f64], rate_hz: f64, noise_psd: impl Fn(f64) -> f64) -> Option<f64> {
    const MOST_SAMPLES: usize = 4096;
    const SHARE: f64 = 0.999;
    // Means of neighbours: what lies above the lower rate is not motion of an arm.
    let block = values.len().div_ceil(MOST_SAMPLES).max(1);
    let series: Vec<f64> =
        values.chunks_exact(block).map(|c| c.iter().sum::<f64>() / c.len() as f64).collect();
    let n = series.len();
    if n < 16 {
        return None;
    }
    let mean = series.iter().sum::<f64>() / n as f64;
    let turn = |k: usize| std::f64::consts::TAU * k as f64 / n as f64;
    let windowed: Vec<f64> =
        series.iter().enumerate().map(|(k, v)| (v - mean) * (0.5 - 0.5 * turn(k).cos())).collect();
    let block_rate_hz = rate_hz / block as f64;
    // Σ w² of Hann's window is 3n/8.
    let per_psd = 0.5 * block_rate_hz * 0.375 * n as f64;
    let noise = |frequency_hz: f64| -> f64 {
        // Means of neighbours fold what lies above half their rate.
        let aliases = (0..=block / 2).flat_map(|m| {
            let whole_hz = m as f64 * block_rate_hz;
            [whole_hz + frequency_hz, whole_hz - frequency_hz]
        });
        let passed = |f: f64| {
            let half = std::f64::consts::PI * f / rate_hz;
            noise_psd(f) * ((block as f64 * half).sin() / (block as f64 * half.sin())).powi(2)
        };
        per_psd * aliases.filter(|f| *f > 0.0 && *f <= 0.5 * rate_hz).map(passed).sum::<f64>()
    };
    let reach = 2.0 * (n as f64).ln();
    let power: Vec<f64> = (1..n / 2)
        .map(|k| {
            // Goertzel's recurrence for one bin of the discrete Fourier transform.
            let (mut before, mut last) = (0.0, 0.0);
            for v in &windowed {
                (before, last) = (last, v + 2.0 * turn(k).cos() * last - before);
            }
            let power = last * last + before * before - 2.0 * turn(k).cos() * last * before;
            if power > reach * noise(k as f64 * block_rate_hz / n as f64) { power } else { 0.0 }
        })
        .collect();
    let total: f64 = power.iter().sum();
    let mut sum = 0.0;
    let bin = power.iter().position(|p| {
        sum += p;
        sum >= SHARE * total
    })?;
    (total > 0.0).then(|| (bin + 1) as f64 * block_rate_hz / n as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uniform pseudo-random numbers between −½ and ½, one after the other from fractional parts.
    fn random(n: usize) -> Vec<f64> {
        let mut state = 0.5_f64;
        (0..n)
            .map(|_| {
                state = (state * 97.0 + 0.123_456_789).fract();
                state - 0.5
            })
            .collect()
    }

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
        let noise = random(20_000);
        // A uniform number between −½ and ½ has a standard deviation of 1/√12.
        let series: Vec<f64> =
            noise.iter().enumerate().map(|(k, n)| 5.0 * (k as f64 * 0.01).sin() + 0.02 * n).collect();
        let found = white_noise(&series).unwrap();
        assert!((found / (0.02 / 12.0_f64.sqrt()) - 1.0).abs() < 0.1, "{found}");
        assert_eq!(white_noise(&[1.0; 4]), None);
    }

    #[test]
    fn the_highest_of_several_tones_is_found() {
        let tone = |f: f64, t: f64| (std::f64::consts::TAU * f * t).sin();
        let series: Vec<f64> = (0..20_000)
            .map(|k| f64::from(k) / 500.0)
            .map(|t| tone(0.4, t) + 0.5 * tone(1.5, t) + 0.002 * tone(40.0, t))
            .collect();
        let found = bandwidth_hz(&series, 500.0, |_| 0.0).unwrap();
        assert!((found - 1.5).abs() < 0.05, "{found}");
        assert_eq!(bandwidth_hz(&[1.0; 400], 100.0, |_| 0.0), None);
    }

    /// A motion of 0.6 Hz that does not end as it began, with white noise of its positions as differentiation makes it.
    #[test]
    fn neither_noise_nor_the_ends_of_a_recording_are_motion() {
        let rate_hz = 500.0;
        let tau = std::f64::consts::TAU;
        for (samples, sigma) in [(6_150, 0.0), (6_150, 1e-5), (6_150, 1e-3), (70_000, 1e-4)] {
            let noise: Vec<f64> = random(samples + 2).iter().map(|n| sigma * 12.0_f64.sqrt() * n).collect();
            let velocity: Vec<f64> = (0..samples)
                .map(|k| {
                    let own = 0.5 * tau * 0.6 * (tau * 0.6 * k as f64 / rate_hz).cos();
                    own + 0.5 * rate_hz * (noise[k + 2] - noise[k])
                })
                .collect();
            let psd =
                |f: f64| sigma * sigma / (0.5 * rate_hz) * aurt_recording::velocity_gain(f, rate_hz).powi(2);
            let found = bandwidth_hz(&velocity, rate_hz, psd).unwrap();
            assert!((0.55..0.9).contains(&found), "{samples} {sigma}: {found}");
        }
    }

    #[test]
    fn dithering_about_rest_is_no_reversal() {
        let velocity = [0.0, 0.5, 0.4, -0.01, 0.01, -0.01, 0.5, -0.5, -0.2, 0.3];
        assert_eq!(reversals(&velocity, 0.1), 2);
    }
}
