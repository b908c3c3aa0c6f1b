//! Knocks: forces of short duration at all joints.

use aurt_recording::Recording;

use crate::known_robot::{NOISE_NM, RATE_HZ};

const KNOCK_S: f64 = 0.05;

/// A recording with knocks of 50 ms in one per cent of its rows, each of 60 deviations of the noise at every joint, two of three
/// in the same direction.
pub fn with_knocks(mut clean: Recording) -> Recording {
    let duration_s = clean.time_s.len() as f64 / RATE_HZ;
    let count = (0.01 * duration_s / KNOCK_S).round() as usize;
    let length = (KNOCK_S * RATE_HZ) as usize;
    for (series, noise_nm) in clean.measurement.iter_mut().flatten().zip(NOISE_NM) {
        for knock in 0..count {
            let start = ((knock as f64 + 0.57) * duration_s / count as f64 * RATE_HZ) as usize;
            let force_nm = if knock % 3 == 0 { -60.0 } else { 60.0 } * noise_nm;
            series.iter_mut().skip(start).take(length).for_each(|y| *y += force_nm);
        }
    }
    clean
}
