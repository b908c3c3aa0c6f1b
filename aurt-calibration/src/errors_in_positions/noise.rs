//! Noise as encoders make it, and what filters leave of it.

use aurt_recording::{PositionNoise, Segment, ZeroPhase, acceleration_gain};
use aurt_traits::Motion;

use crate::CalibrationError;
use crate::statistics::Random;

/// Points of the integral over frequency.
const POINTS: usize = 512;

/// Share of the noise in the mean square of a joint's filtered accelerations.
pub(super) fn acceleration_share(
    segments: &[Segment],
    joint: usize,
    noise: &PositionNoise,
    filter: &ZeroPhase,
) -> f64 {
    let (mut power, mut samples) = (0.0, 0);
    for segment in segments {
        let series = segment.motion.view().acceleration_rad_s2(joint);
        power += series.iter().map(|a| a * a).sum::<f64>();
        samples += series.len();
    }
    let rate_hz = filter.rate_hz();
    let width_hz = 0.5 * rate_hz / POINTS as f64;
    let of_noise: f64 = (0..POINTS)
        .map(|k| (k as f64 + 0.5) * width_hz)
        .map(|f| noise.psd(f) * (filter.gain(f) * acceleration_gain(f, rate_hz)).powi(2) * width_hz)
        .sum();
    if power > 0.0 { (of_noise * samples as f64 / power).min(1.0) } else { 0.0 }
}

/// The segment with the noise of its positions added once more: the encoder, with its zero anywhere within a step, looks at
/// the motion again, and what it is off by passes `filter`, that of the positions. The motion passes `smoother` before: where
/// filters leave steps of the lattice in it, a second look would see them exactly.
pub(super) fn noisier(
    segment: &Segment,
    noises: &[PositionNoise],
    [filter, smoother]: [&ZeroPhase; 2],
    random: &mut Random,
) -> Result<Segment, CalibrationError> {
    let view = segment.motion.view();
    let (joints, samples, period_s) = (view.joints(), view.samples(), 1.0 / segment.rate_hz);
    let mut position = Vec::with_capacity(joints * samples);
    let mut velocity = Vec::with_capacity(joints * samples);
    let mut acceleration = Vec::with_capacity(joints * samples);
    let none = PositionNoise::none(segment.rate_hz);
    for joint in 0..joints {
        let noise = noises.get(joint).unwrap_or(&none);
        let (q, v, a) =
            (view.position_rad(joint), view.velocity_rad_s(joint), view.acceleration_rad_s2(joint));
        // A sample more at either end, as preprocessing has it for the differences.
        let before = q.first().zip(v.first()).map(|(q, v)| q - v * period_s);
        let after = q.last().zip(v.last()).map(|(q, v)| q + v * period_s);
        let longer: Vec<f64> = before.into_iter().chain(q.iter().copied()).chain(after).collect();
        let smooth = smoother.filter(&longer)?;
        // White noise of the grid has the spectrum of that of the recording.
        let white = noise.white_rad * (segment.rate_hz / noise.rate_hz).sqrt();
        let zero = random.uniform();
        let error = smooth.iter().map(|q| {
            let seen = q + if white > 0.0 { white * random.normal() } else { 0.0 };
            let shown = noise.step_rad.map_or(seen, |step| ((seen / step + zero).round() - zero) * step);
            shown - q
        });
        let error: Vec<f64> = error.collect();
        let error = filter.filter(&error)?;
        for (k, e) in error.windows(3).enumerate() {
            position.push(q[k] + e[1]);
            velocity.push(v[k] + (e[2] - e[0]) / (2.0 * period_s));
            acceleration.push(a[k] + (e[2] - 2.0 * e[1] + e[0]) / (period_s * period_s));
        }
    }
    let motion = Motion::new(joints, view.time_s().to_vec(), position, velocity, acceleration)?;
    Ok(Segment { motion, ..segment.clone() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segment(rate_hz: f64) -> (Segment, ZeroPhase) {
        let filter = ZeroPhase::butterworth(4, 0.1 * rate_hz, rate_hz).unwrap();
        let time: Vec<f64> = (0..4000).map(|k| f64::from(k) / rate_hz).collect();
        let of = |f: &dyn Fn(f64) -> f64| time.iter().map(|t| f(*t)).collect::<Vec<f64>>();
        let motion = Motion::new(
            1,
            time.clone(),
            of(&|t| 0.7 * libm::sin(1.9 * t)),
            of(&|t| 1.33 * libm::cos(1.9 * t)),
            of(&|t| -2.527 * libm::sin(1.9 * t)),
        );
        let segment = Segment {
            motion: motion.unwrap(),
            measurement: None,
            raw_measurement: None,
            left_out: None,
            rate_hz,
            decimation: 1,
            parallel_filter: filter.clone(),
            kept_rows: 0..4000,
        };
        (segment, filter)
    }

    /// What is drawn has the power in the accelerations that the spectrum says, white or of a lattice.
    #[test]
    fn drawn_noise_is_as_strong_as_its_spectrum() {
        let (segment, filter) = segment(250.0);
        let q = segment.motion.view().position_rad(0).to_vec();
        let time = segment.motion.view().time_s().to_vec();
        let mut random = Random::new(3);
        let white: Vec<f64> = q.iter().map(|q| q + 2e-4 * random.normal()).collect();
        let lattice: Vec<f64> = q.iter().map(|q| (q / 1.5e-3).round() * 1.5e-3).collect();
        for shown in [white, lattice] {
            let noise = PositionNoise::of(&time, &shown);
            let said = acceleration_share(std::slice::from_ref(&segment), 0, &noise, &filter);
            let smoother = ZeroPhase::butterworth(4, 3.0, 250.0).unwrap();
            let drawn = noisier(&segment, &[noise], [&filter, &smoother], &mut random).unwrap();
            let (a, b) = (segment.motion.view(), drawn.motion.view());
            let pairs = a.acceleration_rad_s2(0).iter().zip(b.acceleration_rad_s2(0));
            let found = pairs.map(|(a, b)| (b - a).powi(2)).sum::<f64>()
                / a.acceleration_rad_s2(0).iter().map(|a| a * a).sum::<f64>();
            assert!((found / said - 1.0).abs() < 0.35, "{found} {said}");
        }
    }
}
