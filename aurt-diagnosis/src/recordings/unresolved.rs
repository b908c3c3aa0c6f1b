//! Where the direction of a joint's motion is not resolved.
//!
//! Dry friction follows sgn q̇. Where a joint sticks, or creeps more slowly than its encoder resolves, the computed sign is
//! that of noise, while friction is whatever holds the joint: the error of the model there is no missing physics.

use aurt_recording::{
    PositionNoise, PreprocessOptions, Preprocessed, Recording, RecordingError, Segment, ZeroPhase,
    velocity_gain,
};

/// Deviations of the velocity's noise within which a joint may stand.
const RESTS: f64 = 3.0;

/// A joint dwells at low speed if it takes this many times as long as the slopes at both ends need to pass through. A reversal
/// at constant acceleration takes once as long, a velocity that touches zero as a parabola twice.
const DWELLS: f64 = 2.0;

/// A row does not count if more than this share of it comes from motion whose direction is not resolved. Dry friction is wrong
/// there by at most twice its level, and other rows by at most this share of that.
const MIXED: f64 = 0.02;

/// Points of an integral over frequencies.
const POINTS: usize = 256;

/// The rows of each joint, `[joint][row]`, of which a good part is motion whose direction is not resolved.
///
/// # Errors
/// What the filters report.
pub(crate) fn unresolved(
    raw: &Recording,
    data: &Preprocessed,
    options: &PreprocessOptions,
) -> Result<Vec<Vec<bool>>, RecordingError> {
    let cutoff_hz = options.effective_position_cutoff_hz();
    let of_joint = |(joint, position): (usize, &Vec<f64>)| {
        let noise = PositionNoise::of(&raw.time_s, position);
        let mut rows = Vec::new();
        for segment in &data.segments {
            let samples = samples(segment, joint, least_speed(&noise, segment, cutoff_hz)?)?;
            rows.extend((0..segment.rows()).map(|row| samples[segment.sample(row)]));
        }
        Ok(rows)
    };
    raw.position_rad.iter().enumerate().map(of_joint).collect()
}

/// The least speed whose direction is seen, rad/s.
///
/// White noise of the position gives the velocity the variance ∫ S |P V|² df, with the gains P of the position filter and V
/// of the stencil that differentiates. A joint of speed v on a lattice of step Δ gives pulses at the rate v/Δ. The position
/// filter leaves their harmonics up to its cutoff f_c, of the power 2 v f_c Δ, which exceeds v² below v = 2 f_c Δ.
fn least_speed(noise: &PositionNoise, segment: &Segment, cutoff_hz: f64) -> Result<f64, RecordingError> {
    let filter = ZeroPhase::butterworth(segment.parallel_filter.order(), cutoff_hz, segment.rate_hz)?;
    let band_hz = 0.5 * segment.rate_hz / POINTS as f64;
    let white = 2.0 * noise.white_rad * noise.white_rad / noise.rate_hz.min(segment.rate_hz);
    let variance: f64 = (0..POINTS)
        .map(|k| (k as f64 + 0.5) * band_hz)
        .map(|f| white * (filter.gain(f) * velocity_gain(f, segment.rate_hz)).powi(2) * band_hz)
        .sum();
    Ok((RESTS * variance.sqrt()).max(2.0 * cutoff_hz * noise.step_rad.unwrap_or(0.0)))
}

/// The samples of a segment's motion that the parallel filter mixes with those in which a joint dwells below a speed. A short
/// stick shows in the velocity as it is, creeping on an encoder's lattice in that behind the parallel filter.
fn samples(segment: &Segment, joint: usize, least: f64) -> Result<Vec<bool>, RecordingError> {
    let motion = segment.motion.view();
    let velocity = motion.velocity_rad_s(joint);
    let mut dwells = vec![false; velocity.len()];
    if least > 0.0 {
        dwell(velocity, least, &mut dwells);
        dwell(&segment.parallel_filter.filter(velocity)?, least, &mut dwells);
    }
    if !dwells.contains(&true) {
        return Ok(dwells);
    }
    let shares: Vec<f64> = dwells.iter().map(|dwells| f64::from(u8::from(*dwells))).collect();
    Ok(segment.parallel_filter.filter(&shares)?.iter().map(|share| share.abs() > MIXED).collect())
}

/// Marks where a velocity dwells below a speed.
fn dwell(velocity: &[f64], least: f64, marks: &mut [bool]) {
    let passing = |k: usize| {
        let (from, to) = (k.saturating_sub(1), (k + 1).min(velocity.len() - 1));
        let slope = (velocity[to] - velocity[from]) / (to - from) as f64;
        least / slope.abs().max(f64::MIN_POSITIVE)
    };
    let mut k = 0;
    while k < velocity.len() {
        let slow = velocity[k..].iter().take_while(|v| v.abs() < least).count();
        if slow > 1 {
            // A recording that begins or ends at rest passes through no speed there.
            let ends = [(k, 0), (k + slow, velocity.len())];
            let inner = ends.iter().zip([k, k + slow - 1]).filter(|((end, edge), _)| end != edge);
            if slow as f64 > DWELLS * inner.map(|(_, at)| passing(at)).sum::<f64>() {
                marks[k..k + slow].fill(true);
            }
        }
        k += slow.max(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 500.0;

    fn marked(velocity: impl Fn(f64) -> f64) -> Vec<usize> {
        let velocity: Vec<f64> = (0..1000).map(|k| velocity(k as f64 / RATE_HZ - 1.0)).collect();
        let mut marks = vec![false; velocity.len()];
        dwell(&velocity, 0.02, &mut marks);
        (0..marks.len()).filter(|k| marks[*k]).collect()
    }

    #[test]
    fn a_joint_that_turns_at_once_does_not_dwell() {
        assert!(marked(|t| 0.5 * t).is_empty());
        assert!(marked(|t| -libm::sin(7.0 * t)).is_empty());
    }

    #[test]
    fn a_joint_that_sticks_or_creeps_dwells() {
        let stuck = marked(|t| if t.abs() < 0.1 { 0.0 } else { 2.0 * (t - t.signum() * 0.1) });
        assert!(stuck.len() >= 100 && stuck.len() <= 114, "{}", stuck.len());
        let creeps = marked(|t| if t.abs() < 0.2 { 0.01 * (90.0 * t).sin() } else { 2.0 * (t.abs() - 0.2) });
        assert!(creeps.len() >= 195 && creeps.len() <= 215, "{}", creeps.len());
    }

    #[test]
    fn a_joint_that_still_rests_where_a_recording_begins_dwells() {
        assert_eq!(marked(|t| 2.0 * (t + 0.8).max(0.0)), (0..105).collect::<Vec<_>>());
        assert!(marked(|t| 0.5 * (t + 0.99)).is_empty());
    }
}
