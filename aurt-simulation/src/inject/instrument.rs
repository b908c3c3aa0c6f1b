//! Laws of drives, sensors and loggers: they act on what was measured.

use aurt_recording::Recording;

use super::law::{Added, Law};
use super::scene::Scene;
use crate::random::Random;

pub(super) fn torque(added: &Added, scene: &Scene, measured: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut torques = scene.nothing();
    let j = added.joint;
    match &added.law {
        Law::TorqueConstant => {
            let gain = 1.0 / (1.0 + added.signed()) - 1.0;
            torques[j] = measured[j].iter().map(|y| gain * y).collect();
        }
        Law::CurrentOffset => torques[j].fill(added.signed()),
        Law::Saturation { peak } => {
            let limit = (1.0 - added.size) * peak;
            torques[j] = measured[j].iter().map(|y| y.clamp(-limit, limit) - y).collect();
        }
        Law::TimeDelay => {
            for (series, y) in torques.iter_mut().zip(measured) {
                let late = delayed(&scene.motion.time_s, y, added.size);
                *series = late.iter().zip(y).map(|(late, now)| late - now).collect();
            }
        }
        _ => {}
    }
    torques
}

/// A series later by `delay_s`, joined linearly; its first value before it begins.
fn delayed(time_s: &[f64], series: &[f64], delay_s: f64) -> Vec<f64> {
    time_s
        .iter()
        .map(|t| {
            let then = t - delay_s;
            let after = time_s.partition_point(|t| *t <= then);
            let (Some(before), true) = (after.checked_sub(1), after < series.len()) else {
                return series[after.min(series.len() - 1)];
            };
            let span = time_s[after] - time_s[before];
            let share = if span > 0.0 { (then - time_s[before]) / span } else { 0.0 };
            series[before] + share * (series[after] - series[before])
        })
        .collect()
}

/// Rows of a burst, at most.
const LONGEST_BURST: usize = 12;

/// Takes rows out and makes others repeat the row before, in bursts, `share` of all rows, half of each.
pub(super) fn drop_samples(recording: &mut Recording, share: f64, seed: u64) {
    let samples = recording.samples();
    let mut random = Random::labelled(seed, "dropped samples");
    let wanted = (share * samples as f64).round() as usize;
    let mut missing = vec![false; samples];
    let mut done = 0;
    while done < wanted && samples > 4 * LONGEST_BURST {
        let length = (1 + random.index(LONGEST_BURST)).min(wanted - done);
        let first = 1 + random.index(samples - length - 2);
        let held = random.chance(0.5);
        for k in first..first + length {
            if held {
                for series in
                    recording.position_rad.iter_mut().chain(recording.measurement.iter_mut().flatten())
                {
                    series[k] = series[first - 1];
                }
            } else {
                missing[k] = true;
            }
        }
        done += length;
    }
    retain(recording, |k| !missing[k]);
}

/// Leaves out the rows before the first late value, which nothing was measured of.
pub(super) fn begin_late(recording: &mut Recording, delay_s: f64) {
    let first = recording.time_s.first().map_or(0.0, |t| t + delay_s);
    let kept: Vec<bool> = recording.time_s.iter().map(|t| *t >= first).collect();
    retain(recording, |k| kept[k]);
}

fn retain(recording: &mut Recording, is_kept: impl Fn(usize) -> bool) {
    let keep = |series: &mut Vec<f64>| {
        let mut row = 0;
        series.retain(|_| {
            row += 1;
            is_kept(row - 1)
        });
    };
    keep(&mut recording.time_s);
    recording.position_rad.iter_mut().for_each(keep);
    recording.velocity_rad_s.iter_mut().flatten().for_each(keep);
    recording.measurement.iter_mut().flatten().for_each(keep);
}

#[cfg(test)]
mod tests {
    use super::delayed;

    #[test]
    fn a_delay_shifts_a_ramp() {
        let time: Vec<f64> = (0..50).map(|k| 0.01 * f64::from(k)).collect();
        let ramp: Vec<f64> = time.iter().map(|t| 2.0 * t).collect();
        let late = delayed(&time, &ramp, 0.025);
        assert_eq!(late[0], 0.0);
        for k in 3..50 {
            assert!((late[k] - 2.0 * (time[k] - 0.025)).abs() < 1e-12);
        }
        assert_eq!(delayed(&time, &ramp, 0.0), ramp);
    }
}
