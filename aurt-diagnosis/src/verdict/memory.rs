//! Noise whose memory is longer than what the filters let see.
//!
//! Above the cut-off of the filters a recording shows its white noise; what wanders more slowly than the motion (a current
//! sensor's drift, an amplifier's 1/f) it shows only inside the band of the motion. There it is told from missing physics by
//! what it is not: physics follows a coordinate of the arm, stands in windows of time, or hums at one frequency.
//! What does none of these is taken for noise, up to [`MOST`] times the noise that is seen, and a note says so.

use crate::recordings::rows::RecordingRows;
use crate::verdict::JointResidual;

/// Largest ratio of unseen to seen noise. First-order Gauss–Markov noise of half the white one's deviation and a memory of a
/// second comes to 4.6 times the white one behind a filter of 3 Hz at 500 samples per second.
const MOST: f64 = 5.0;

/// A hum holds 1 − (noise/all)² of the power in one line, three quarters where it doubles what is left; a first-order process
/// spreads over T/τ lines, a dozen or more in recordings of ten memories.
const LINE: f64 = 0.5;

/// Rows of one recording that are looked at for a line.
const LONGEST: usize = 2048;

/// The factor by which the noise of each joint is larger than the recordings show above their filters.
pub(super) fn factors(
    residual: &[JointResidual],
    rows: &[&RecordingRows],
    left: &[Vec<Vec<f64>>],
) -> Vec<f64> {
    residual
        .iter()
        .map(|joint| {
            let factor = joint.unexplained_rms / joint.floor_rms.max(f64::MIN_POSITIVE);
            let shapeless = joint.follows.is_none() && joint.windows_s.is_empty();
            let hums = || {
                let series = rows.iter().zip(left).filter(|(r, _)| r.rows() > 0);
                series.map(|(_, left)| strongest_line(&left[joint.joint])).fold(0.0, f64::max) > LINE
            };
            // However little it is: a joint that keeps some of it would else count as less accounted for than one that keeps more.
            if factor > 1.0 && shapeless && factor <= MOST && !hums() { factor } else { 1.0 }
        })
        .collect()
}

/// Largest share of a series' power that lies in one line and its two neighbours (sidelobes of a frequency between lines).
fn strongest_line(series: &[f64]) -> f64 {
    let series = &series[..series.len().min(LONGEST)];
    let n = series.len();
    let mean = series.iter().sum::<f64>() / n.max(1) as f64;
    let power: Vec<f64> = (1..n / 2)
        .map(|line| {
            let step = std::f64::consts::TAU * line as f64 / n as f64;
            // Goertzel's recursion: one multiplication a row.
            let (mut last, mut before) = (0.0, 0.0);
            for value in series {
                let next = value - mean + 2.0 * step.cos() * last - before;
                (before, last) = (last, next);
            }
            last * last + before * before - 2.0 * step.cos() * last * before
        })
        .collect();
    let all: f64 = power.iter().sum();
    let largest = power.windows(3).map(|w| w.iter().sum::<f64>()).fold(0.0, f64::max);
    if all > 0.0 { largest / all } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::{factors, strongest_line};
    use crate::{dice::Dice, verdict::JointResidual};

    #[test]
    fn what_has_no_shape_is_noise_however_little_and_what_has_one_is_not() {
        let joint = |unexplained_rms: f64, follows: Option<&str>| JointResidual {
            joint: 0,
            baseline_rms: 3.0,
            unexplained_rms,
            floor_rms: 1.0,
            structure_left: false,
            follows: follows.map(str::to_owned),
            follows_share: 0.0,
            windows_s: Vec::new(),
        };
        let found = |residual: JointResidual| factors(&[residual], &[], &[])[0];
        assert_eq!([0.9, 1.2, 2.5, 5.1].map(|rms| found(joint(rms, None))), [1.0, 1.2, 2.5, 1.0]);
        assert_eq!(found(joint(2.5, Some("velocity"))), 1.0);
    }

    #[test]
    fn a_hum_is_a_line_and_wandering_noise_is_none() {
        let mut dice = Dice(7);
        let mut draw = || dice.uniform() - 0.5;
        let hum: Vec<f64> = (0..1500).map(|k| (0.37 * f64::from(k)).sin() + draw()).collect();
        assert!(strongest_line(&hum) > 0.7, "{}", strongest_line(&hum));
        let mut value = 0.0;
        let wandering: Vec<f64> = (0..1500)
            .map(|_| {
                value = 0.97 * value + draw();
                value
            })
            .collect();
        assert!(strongest_line(&wandering) < 0.4, "{}", strongest_line(&wandering));
        assert_eq!(strongest_line(&[]), 0.0);
    }
}
