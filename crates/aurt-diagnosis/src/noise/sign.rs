//! Dry friction whose sign noise decides.

use aurt_recording::Segment;

use super::spectrum::SegmentNoise;

/// Speed over its noise beyond which the sign is certain: Φ(−6) = 1e-9.
const CERTAIN: f64 = 6.0;

/// Expected squared error, at a motion sample, of a joint's dry friction F sgn q̇ whose velocity v has the noise σ_v.
///
/// The sign is wrong with the probability p = Φ(−|v|/σ_v), so that the friction is off by 2F p on average, which every
/// filter lets through, and scatters around that by 4F² p(1−p), of which the parallel filter passes the share that it
/// passes of the velocity's noise.
pub(super) fn wrong_sign(
    noise: &SegmentNoise,
    segment: &Segment,
    joint: usize,
    rows: impl Iterator<Item = (usize, f64)>,
) -> f64 {
    let (variance, passed) = noise.velocity_noise(joint, &segment.parallel_filter);
    if variance <= 0.0 {
        return 0.0;
    }
    let scatter = variance.sqrt();
    rows.filter(|(_, velocity)| velocity.abs() < CERTAIN * scatter)
        .map(|(row, velocity)| {
            let wrong = normal_below(-velocity.abs() / scatter);
            let step = noise.sensitivity.step_at(joint, row * segment.decimation);
            4.0 * step * step * (wrong * wrong + wrong * (1.0 - wrong) * passed)
        })
        .sum()
}

/// Φ(x) for x ≤ 0 to 1e-7 (Abramowitz and Stegun, 26.2.17).
fn normal_below(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.231_641_9 * x.abs());
    let series = [0.319_381_530, -0.356_563_782, 1.781_477_937, -1.821_255_978, 1.330_274_429];
    let sum = series.iter().rev().fold(0.0, |sum, c| t * (c + sum));
    sum * (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt()
}

#[cfg(test)]
mod tests {
    use super::normal_below;

    #[test]
    fn the_normal_distribution_is_that_of_tables() {
        for (x, expected) in [(0.0, 0.5), (-1.0, 0.158_655_254), (-2.0, 0.022_750_132), (-4.0, 3.167_124e-5)]
        {
            assert!((normal_below(x) - expected).abs() < 1e-7, "{x}");
        }
    }
}
