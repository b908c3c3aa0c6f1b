//! Dry friction whose sign noise decides, or that holds its joint.

use aurt_recording::Segment;

use super::spectrum::{SegmentNoise, integral};
use super::sticks::sticks;
use crate::error::DiagnosisError;

/// Speed over its noise beyond which the sign is certain: Φ(−6) = 1e-9.
const CERTAIN: f64 = 6.0;

/// D²/⟨δt²⟩ = (1/√π)² of a crossing, see [`wrong_sign`].
const CROSSING: f64 = std::f64::consts::FRAC_1_PI;

/// Sum over the rows that count of the expected squared error of a joint's dry friction F sgn q̇, whose velocity v has the
/// noise σ_v.
///
/// The sign is wrong with the probability p = Φ(−|v|/σ_v). On average that is the error 2F p sgn v, a doublet around each
/// reversal, which passes the parallel filter H like any torque; around it scatters 4F² p(1−p), of which H passes at most
/// the share that it passes of the velocity's noise. A fast reversal, through which noise is constant, is a step shifted by
/// δt = n/q̈, of the energy 4F² ⟨δt²⟩ ∫|H|²df; with D = ∫p(1−p)dt = σ_v/(√π |q̈|) that is 4F² D · π D ∫|H|²df. The less counts.
///
/// Where the joint sticks, friction goes from −F to F while it stands, and the sign that the model takes is off by that.
///
/// # Errors
/// What the filter reports.
pub(super) fn wrong_sign(
    noise: &SegmentNoise,
    segment: &Segment,
    joint: usize,
    counts: &[bool],
) -> Result<f64, DiagnosisError> {
    let filter = &segment.parallel_filter;
    let (variance, passed) = noise.velocity_noise(joint, filter);
    let motion = segment.motion.view();
    let recorded = motion.velocity_rad_s(joint);
    let period_s = 1.0 / segment.rate_hz;
    let left_out = |at: usize| segment.left_out.as_ref().is_some_and(|samples| samples[joint][at]);
    let counted = |at: usize| {
        !left_out(at) && segment.row(at).and_then(|row| counts.get(row).copied()).unwrap_or(false)
    };
    let mut mean = vec![0.0; recorded.len()];
    let mut stuck = vec![false; recorded.len()];
    let resolution = noise.velocity_resolution(joint);
    for stick in sticks(recorded, motion.acceleration_rad_s2(joint), resolution, period_s) {
        for at in (stick.from..stick.to.min(mean.len())).filter(|at| counted(*at)) {
            mean[at] = noise.sensitivity.step_at(joint, at) * (stick.friction(at) - recorded[at].signum());
            stuck[at] = true;
        }
    }
    let scatter = variance.sqrt();
    // Behind the filter the velocity has little of its noise, and stands for the one that it really is.
    let velocity = filter.filter(recorded)?;
    let bandwidth_hz = 2.0 * integral(0.0, 0.5 * segment.rate_hz, |f| filter.gain(f).powi(2));
    let mut energy = 0.0;
    let mut k = 0;
    while k < velocity.len() {
        let uncertain = velocity[k..].iter().take_while(|v| v.abs() < CERTAIN * scatter).count();
        let (mut duration_s, mut spread) = (0.0, 0.0);
        for (at, v) in velocity.iter().enumerate().skip(k).take(uncertain) {
            if !counted(at) || stuck[at] {
                continue;
            }
            let wrong = normal_below(-v.abs() / scatter);
            let jump = 2.0 * noise.sensitivity.step_at(joint, at);
            mean[at] = jump * wrong * v.signum();
            duration_s += wrong * (1.0 - wrong) * period_s;
            spread += jump * jump * wrong * (1.0 - wrong);
        }
        energy += spread * passed.min(duration_s * bandwidth_hz / CROSSING);
        k += uncertain.max(1);
    }
    let shifted: f64 = filter.filter(&mean)?.iter().map(|e| e * e).sum();
    Ok((shifted + energy) / segment.decimation as f64)
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
