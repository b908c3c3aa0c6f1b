//! Positions that leap and stay: encoders that slip, zeros that are set anew within a recording.

use aurt_recording::Recording;
use aurt_report::rendering::number::significant;
use aurt_traits::RobotNames;

/// Rows on either side that a leap is compared with.
const NEIGHBOURS: usize = 5;
/// Factor between a leap and the steps around it, which inertia keeps alike.
const ABRUPT: f64 = 5.0;
/// Factor between the speed of a leap and the largest elsewhere in the recording.
const FASTER: f64 = 3.0;

struct Slip {
    row: usize,
    size_rad: f64,
    speed_rad_s: f64,
}

/// The leaps of a recording's positions, in sentences: joint, time, size.
pub(super) fn slips(name: &str, recording: &Recording) -> Vec<String> {
    let names = RobotNames::of_joints(recording.joints.names());
    let moved_s = since_motion_s(recording);
    let origin_s = recording.time_s.first().copied().unwrap_or_default();
    let of_joint = |joint: usize| {
        let (slips, usual_rad_s) = leaps(&recording.position_rad[joint], &moved_s);
        let first = slips.first()?;
        let more = match slips.len() {
            1 => String::new(),
            n => format!(", and {} times more", n - 1),
        };
        Some(format!(
            "{name}: the position of {} leaps by {} rad at {:.3} s{more}: {} rad/s, elsewhere at most {}; an encoder that slips, or a \
             zero that is set anew: what comes after it has another zero, cut the recording there with `window_s`",
            names.joint(joint),
            significant(first.size_rad, 3),
            recording.time_s[first.row] - origin_s,
            significant(first.speed_rad_s, 3),
            significant(usual_rad_s, 3)
        ))
    };
    (0..recording.joints()).filter_map(of_joint).collect()
}

/// For each row the time since a position last changed before it, s: rows that are held delay a motion, and do not hurry it.
fn since_motion_s(recording: &Recording) -> Vec<f64> {
    let time_s = &recording.time_s;
    let mut last = 0;
    (0..time_s.len())
        .map(|row| {
            let since_s = time_s[row] - time_s[last];
            let changes = |q: &Vec<f64>| row > 0 && q[row] != q[row - 1];
            if recording.position_rad.iter().any(changes) {
                last = row;
            }
            since_s
        })
        .collect()
}

/// The leaps of a joint, and its largest speed beside them, rad/s. A joint that goes no further than it leaps tells nothing.
fn leaps(position_rad: &[f64], moved_s: &[f64]) -> (Vec<Slip>, f64) {
    let steps: Vec<f64> = position_rad.windows(2).map(|q| q[1] - q[0]).collect();
    let speed = |k: usize| {
        let speed = steps[k].abs() / moved_s[k + 1];
        if speed.is_finite() { speed } else { 0.0 }
    };
    let is_abrupt = |k: usize| {
        let around = k.saturating_sub(NEIGHBOURS)..(k + NEIGHBOURS + 1).min(steps.len());
        let others = around.filter(|other| *other != k).map(|other| steps[other].abs());
        steps[k].abs() > ABRUPT * others.fold(0.0, f64::max)
    };
    let (abrupt, smooth): (Vec<usize>, Vec<usize>) = (0..steps.len()).partition(|k| is_abrupt(*k));
    let usual_rad_s = smooth.iter().map(|k| speed(*k)).fold(0.0, f64::max);
    let way_rad: f64 = smooth.iter().map(|k| steps[*k].abs()).sum();
    let is_slip = |k: &usize| speed(*k) > FASTER * usual_rad_s && steps[*k].abs() < way_rad;
    let slip = |k: usize| Slip { row: k + 1, size_rad: steps[k], speed_rad_s: speed(k) };
    (abrupt.into_iter().filter(is_slip).map(slip).collect(), usual_rad_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sine of 1 rad/s, at 250 Hz.
    fn sine() -> Vec<f64> {
        (0..2500).map(|k| (f64::from(k) * 0.004).sin()).collect()
    }

    fn clock() -> Vec<f64> {
        vec![0.004; 2500]
    }

    #[test]
    fn a_leap_that_stays_is_told_with_time_and_size() {
        let mut slipped = sine();
        slipped[1200..].iter_mut().for_each(|q| *q += 0.08);
        let (slips, usual_rad_s) = leaps(&slipped, &clock());
        let [slip] = &slips[..] else { panic!("{} leaps", slips.len()) };
        assert!(slip.row == 1200 && (slip.size_rad - 0.08).abs() < 0.005, "{} {}", slip.row, slip.size_rad);
        assert!((0.95..1.05).contains(&usual_rad_s) && slip.speed_rad_s > 15.0);
    }

    #[test]
    fn motions_spikes_and_held_rows_are_none() {
        assert!(leaps(&sine(), &clock()).0.is_empty());
        let mut spike = sine();
        spike[700] += 0.08;
        assert!(leaps(&spike, &clock()).0.is_empty());
        // Twenty rows are held, then the motion has gone on.
        let mut held = sine();
        let mut since_s = clock();
        let last = held[600];
        held[601..620].fill(last);
        (601..=620).for_each(|k| since_s[k] = 0.004 * (k - 600) as f64);
        assert!(leaps(&held, &since_s).0.is_empty());
        // A joint that rests but for one step.
        let mut step = vec![0.0; 2500];
        step[900..].fill(0.3);
        assert!(leaps(&step, &clock()).0.is_empty());
    }
}
