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

/// A row does not count if more than this share of it is left out.
const MIXED: f64 = 0.5;

/// Cut-offs of the position filter are this share of the rate at most: above, differences are no derivatives.
const HIGHEST: f64 = 0.2;

/// From one cut-off that is tried to the next.
const STEP: f64 = 1.1;

/// Points of an integral over frequencies.
const POINTS: usize = 256;

/// Leaves the samples of each joint whose direction is not resolved out of all rows; the rows, `[joint][row]`, of which little
/// is left.
///
/// # Errors
/// What the filters report.
pub(crate) fn leave_out_unresolved(
    raw: &Recording,
    data: &mut Preprocessed,
    options: &PreprocessOptions,
) -> Result<Vec<Vec<bool>>, RecordingError> {
    let cutoff_hz = options.effective_position_cutoff_hz();
    let noise: Vec<PositionNoise> =
        raw.position_rad.iter().map(|position| PositionNoise::of(&raw.time_s, position)).collect();
    let mut rows = vec![Vec::new(); noise.len()];
    for segment in &mut data.segments {
        let of_joint = |(joint, noise): (usize, &PositionNoise)| {
            samples(segment, joint, least_speed(noise, segment, cutoff_hz)?, cutoff_hz)
        };
        let left_out = noise.iter().enumerate().map(of_joint).collect::<Result<Vec<_>, _>>()?;
        for (rows, left_out) in rows.iter_mut().zip(&left_out) {
            let shares: Vec<f64> = left_out.iter().map(|out| f64::from(u8::from(*out))).collect();
            let shares = segment.parallel_filter.filter(&shares)?;
            rows.extend(segment.at_rows(&shares).iter().map(|share| *share > MIXED));
        }
        if left_out.iter().flatten().any(|out| *out) {
            segment.leave_out(left_out)?;
        }
    }
    Ok(rows)
}

/// The cut-off of the position filter at which least is lost around reversals, where none is asked for and it is not below
/// that of `f_dyn_hz`.
///
/// The filter blurs a reversal over 1/f_c, and the velocity's noise hides its direction for 2 v(f_c)/|q̈|, with the least speed
/// v that is seen and the acceleration of the joint's reversals. The sum of both over all reversals is smallest there. What a
/// regressor is linear in loses nothing: the parallel filter takes the noise that the position filter leaves.
///
/// # Errors
/// What the filters report.
pub(crate) fn position_cutoff_hz(
    raw: &Recording,
    data: &Preprocessed,
    options: &PreprocessOptions,
) -> Result<Option<f64>, RecordingError> {
    let Some(segment) = data.segments.iter().max_by_key(|s| s.motion.samples()) else { return Ok(None) };
    let least_hz = options.effective_position_cutoff_hz();
    let most_hz = HIGHEST * segment.rate_hz;
    if options.position_cutoff_hz.is_some() || most_hz <= least_hz {
        return Ok(None);
    }
    let joints: Vec<(PositionNoise, Vec<f64>)> = raw
        .position_rad
        .iter()
        .enumerate()
        .map(|(joint, position)| (PositionNoise::of(&raw.time_s, position), reversals(segment, joint)))
        .collect();
    let steps = (most_hz / least_hz).ln() / STEP.ln();
    let mut best = (least_hz, f64::INFINITY);
    for cutoff_hz in (0..=steps as usize).map(|k| least_hz * STEP.powi(k as i32)) {
        let mut lost_s = 0.0;
        for (noise, reversals) in &joints {
            let least = least_speed(noise, segment, cutoff_hz)?;
            lost_s += reversals.iter().map(|slope| 1.0 / cutoff_hz + 2.0 * least / slope).sum::<f64>();
        }
        if lost_s < best.1 {
            best = (cutoff_hz, lost_s);
        }
    }
    Ok((best.0 > least_hz).then_some(best.0))
}

/// The accelerations at which a joint reverses, rad/s².
fn reversals(segment: &Segment, joint: usize) -> Vec<f64> {
    let motion = segment.motion.view();
    let (velocity, acceleration) = (motion.velocity_rad_s(joint), motion.acceleration_rad_s2(joint));
    let reverses = |k: &usize| velocity[*k] * velocity[k - 1] < 0.0 && acceleration[*k] != 0.0;
    (1..velocity.len()).filter(reverses).map(|k| acceleration[k].abs()).collect()
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

/// The samples of a segment's motion at which a joint dwells below a speed. A short stick shows in the velocity as it is,
/// creeping on an encoder's lattice in that behind the parallel filter. The position filter smooths over a period of its
/// cutoff: what it shows between two dwells in less is its own ringing, and half of that beside a dwell is not as it was.
fn samples(segment: &Segment, joint: usize, least: f64, cutoff_hz: f64) -> Result<Vec<bool>, RecordingError> {
    let motion = segment.motion.view();
    let velocity = motion.velocity_rad_s(joint);
    let mut dwells = vec![false; velocity.len()];
    if least > 0.0 {
        dwell(velocity, least, &mut dwells);
        dwell(&segment.parallel_filter.filter(velocity)?, least, &mut dwells);
    }
    for k in 1..velocity.len() {
        dwells[k] |= velocity[k].abs() < least || velocity[k] * velocity[k - 1] <= 0.0;
    }
    let guard = (segment.rate_hz / cutoff_hz).ceil() as usize;
    Ok(widened(&dwells, guard))
}

/// Marks with as many more on both sides.
fn widened(marks: &[bool], by: usize) -> Vec<bool> {
    let mut wide = vec![false; marks.len()];
    for k in (0..marks.len()).filter(|k| marks[*k]) {
        wide[k.saturating_sub(by)..(k + by + 1).min(marks.len())].fill(true);
    }
    wide
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
