//! Where the direction of a joint's motion is not resolved.
//!
//! Dry friction follows sgn q̇. Where a joint sticks, or creeps more slowly than its encoder resolves, the computed sign is
//! that of noise, while friction is whatever holds the joint: the model's error there does not show missing physics. A stick that
//! is shorter than the position filter resolves looks like a reversal, so all reversals count as such.
//!
//! These samples are left out of measurement and regressor before both are filtered. Behind the filter each of them would be in
//! all rows within the filter's memory, and how many these are would depend on `f_dyn_hz`.

use aurt_recording::{
    PositionNoise, PreprocessOptions, Preprocessed, Recording, RecordingError, Segment, ZeroPhase,
    velocity_gain,
};

/// Deviations of the velocity's noise within which a joint may stand.
const RESTS: f64 = 3.0;

/// A row does not count if more than this share of it is left out: more of it would be missing than is there.
const MIXED: f64 = 0.5;

/// Cut-offs of the position filter are at most this share of the rate, as the band of gears is: the stencil that differentiates
/// passes 0.76 of a slope there.
const HIGHEST: f64 = 0.2;

/// From one cut-off that is tried to the next. The loss is flat around its minimum: 10 % beside it costs less than 1 %.
const STEP: f64 = 1.1;

/// Points of an integral over frequencies.
const POINTS: usize = 256;

/// Leaves the samples of each joint whose direction is not resolved out of all rows; the rows, `[joint][row]`, of which little
/// is left.
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
            let velocity = segment.motion.view().velocity_rad_s(joint);
            Ok(samples(velocity, least_speed(noise, segment, cutoff_hz)?, segment.rate_hz, cutoff_hz))
        };
        let left_out = noise.iter().enumerate().map(of_joint).collect::<Result<Vec<_>, RecordingError>>()?;
        for (rows, left_out) in rows.iter_mut().zip(&left_out) {
            let shares: Vec<f64> = left_out.iter().map(|out| f64::from(u8::from(*out))).collect();
            let shares = segment.parallel_filter.filter(&shares)?;
            rows.extend(segment.at_rows(&shares).iter().map(|share| *share > MIXED));
        }
        if left_out.iter().flatten().any(|out| *out) {
            segment.leave_out(Some(left_out))?;
        }
    }
    Ok(rows)
}

/// The cut-off of the position filter at which least is lost around reversals, where none is asked for and it is not below
/// that of `f_dyn_hz`.
///
/// The filter blurs a reversal over 1/f_c to both sides, and the velocity's noise hides its direction for 2 v(f_c)/|q̈|, with the least speed
/// v that is seen and the acceleration of the joint's reversals. The sum of both over all reversals is smallest there. What a
/// regressor is linear in loses nothing: the parallel filter takes the noise that the position filter leaves.
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
            lost_s += reversals.iter().map(|slope| 2.0 * (1.0 / cutoff_hz + least / slope)).sum::<f64>();
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

/// The samples of a segment's motion in which a joint is slower than `least` or reverses, and those that the position filter
/// mixes with them: over 1/f_c to both sides, a speed is not what it was. A joint that creeps on an encoder's lattice stands
/// between the steps, so its steps are among them.
fn samples(velocity: &[f64], least: f64, rate_hz: f64, cutoff_hz: f64) -> Vec<bool> {
    let reach = (rate_hz / cutoff_hz).ceil() as usize;
    let mut unresolved = vec![false; velocity.len()];
    for k in 0..velocity.len() {
        let reverses = k > 0 && velocity[k] * velocity[k - 1] <= 0.0;
        if reverses || velocity[k].abs() < least {
            unresolved[k.saturating_sub(reach)..(k + reach + 1).min(velocity.len())].fill(true);
        }
    }
    unresolved
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 500.0;
    const CUTOFF_HZ: f64 = 50.0;

    fn unresolved(velocity: impl Fn(f64) -> f64) -> Vec<usize> {
        let velocity: Vec<f64> = (0..1000).map(|k| velocity(k as f64 / RATE_HZ - 1.0)).collect();
        let marks = samples(&velocity, 0.02, RATE_HZ, CUTOFF_HZ);
        (0..marks.len()).filter(|k| marks[*k]).collect()
    }

    #[test]
    fn a_reversal_costs_what_the_filter_blurs() {
        // Slower than 0.02 rad/s for ± 10 ms, and ten samples of the filter on both sides.
        let around = unresolved(|t| 2.0 * t);
        assert_eq!((around[0], around.len()), (500 - 14, 29));
        assert!(unresolved(|t| 0.05 + t.abs()).is_empty());
    }

    #[test]
    fn a_joint_that_sticks_is_left_out_as_long_as_it_does() {
        let stuck = unresolved(|t| if t.abs() < 0.1 { 0.0 } else { 2.0 * (t - t.signum() * 0.1) });
        assert!((119..=131).contains(&stuck.len()), "{}", stuck.len());
    }

    #[test]
    fn steps_of_an_encoder_between_which_a_joint_stands_are_left_out() {
        // Pulses of 0.1 rad/s that last for 10 ms, every 40 ms.
        let creeps = |t: f64| if (t + 1.0).rem_euclid(0.04) < 0.01 { 0.1 } else { 0.0 };
        let marks = unresolved(|t| if t.abs() < 0.2 { creeps(t) } else { t.abs() });
        let of_pulses = 0.4 * RATE_HZ;
        assert!((of_pulses..of_pulses + 40.0).contains(&(marks.len() as f64)), "{}", marks.len());
        assert_eq!(marks.len(), marks[marks.len() - 1] - marks[0] + 1, "without a hole");
    }
}
