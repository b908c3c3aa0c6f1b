//! One instrument, one noise.

use aurt_recording::{Preprocessed, WhiteAndMarkov};

use super::floor::CONTRADICTION;
use super::spectrum::RecordingNoise;

/// Sampling rates that differ by less are one: clocks are right to 1e-4, and a logger that is set to another rate is off by
/// more. At another rate white noise folds otherwise, and its level is another one.
const SAME_RATE: f64 = 0.01;

/// Gives recordings in question the measurement's noise of those that the model was calibrated on, joint by joint, where
/// their own contradicts it: [`CONTRADICTION`] times the power behind the parallel filter.
///
/// The noise is estimated from what the model leaves above the filter. Of recordings in question that is noise *and* what
/// the model lacks: dry friction and loads that it does not know turn with the motion, and their tails, ∝ 1/f², look like
/// noise with a long memory. The instruments are those of the calibration, whose residual has no such tails.
pub(crate) fn hold_to_reference(
    noise: &mut [RecordingNoise],
    data: &[&Preprocessed],
    is_reference: impl Fn(usize) -> bool,
) {
    let joints = noise.first().map_or(0, |n| n.measurement.len());
    for joint in 0..joints {
        let powers: Vec<f64> = noise.iter().zip(data).map(|(n, d)| measured_power(n, d, joint)).collect();
        let references = (0..noise.len()).filter(|r| is_reference(*r));
        let Some(loudest) = references.max_by(|a, b| powers[*a].total_cmp(&powers[*b])) else { return };
        let known: WhiteAndMarkov = noise[loudest].measurement[joint];
        for r in (0..noise.len()).filter(|r| !is_reference(*r)) {
            let same_rate = (noise[r].measurement[joint].rate_hz / known.rate_hz - 1.0).abs() < SAME_RATE;
            if same_rate && powers[r] > CONTRADICTION * powers[loudest] {
                noise[r].set_measurement(joint, known);
            }
        }
    }
}

/// Mean square of the measurement's noise behind the parallel filter.
fn measured_power(noise: &RecordingNoise, data: &Preprocessed, joint: usize) -> f64 {
    let first = noise.segments.first().zip(data.segments.first());
    first.map_or(0.0, |(noise, segment)| noise.measured_power_behind(joint, &segment.parallel_filter))
}
