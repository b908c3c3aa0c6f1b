//! Joints that stick when they reverse.
//!
//! Dry friction holds a joint until the drive's torque has changed from one side of its level to the other. Meanwhile
//! friction is what it has to be, from −F to F, and a law of the velocity says one of both: what it is off by is no missing
//! physics of motion, but belongs to what a right model leaves.

/// Deviations of the velocity's noise within which a joint may stand; chosen beforehand, as the next is, and not fitted to
/// cases.
const RESTS: f64 = 3.0;

/// Share of the root mean square velocity below which a filter's ringing is not told from motion.
const SLOW: f64 = 0.01;

/// Samples in which a joint does not move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stick {
    /// The first one.
    pub(super) from: usize,
    /// The one after the last.
    pub(super) to: usize,
    /// Directions before and after.
    pub(super) directions: [f64; 2],
}

impl Stick {
    /// Friction between, as a share of its level: it changes evenly.
    pub(super) fn friction(&self, sample: usize) -> f64 {
        let share = (sample as f64 + 0.5 - self.from as f64) / (self.to - self.from) as f64;
        let [before, after] = self.directions;
        before + (after - before) * share
    }
}

/// Where a joint rests for longer than it takes to pass through the speeds that are not told from rest, with the
/// accelerations at both ends, and then goes the other way.
pub(super) fn sticks(velocity: &[f64], acceleration: &[f64], noise_std: f64, period_s: f64) -> Vec<Stick> {
    let samples = velocity.len();
    let rms = (velocity.iter().map(|v| v * v).sum::<f64>() / samples.max(1) as f64).sqrt();
    let least = (RESTS * noise_std).max(SLOW * rms);
    let mut found = Vec::new();
    let mut k = 0;
    while k < samples {
        let slow = velocity[k..].iter().take_while(|v| v.abs() < least).count();
        let (before, after) = (k.wrapping_sub(1), k + slow);
        if slow > 0
            && let (Some(v_before), Some(v_after)) = (velocity.get(before), velocity.get(after))
            && v_before * v_after < 0.0
        {
            let passing = |end: usize| least / acceleration[end].abs().max(f64::MIN_POSITIVE) / period_s;
            let (from, to) = (k as f64 + passing(before), after as f64 - passing(after));
            if to - from >= 1.0 {
                let directions = [v_before.signum(), v_after.signum()];
                found.push(Stick { from: from as usize, to: to.ceil() as usize, directions });
            }
        }
        k += slow.max(1);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Velocity and acceleration of a joint that slows down at 5 rad/s², stands for `rest_s`, and goes back.
    fn reversal(rest_s: f64, period_s: f64) -> [Vec<f64>; 2] {
        let velocity = |t: f64| {
            if t < 0.5 { 5.0 * (0.5 - t) } else { -5.0 * (t - 0.5 - rest_s).max(0.0) }
        };
        let times: Vec<f64> = (0..(1.2 / period_s) as usize).map(|k| k as f64 * period_s).collect();
        let moves = |t: f64| t < 0.5 || t > 0.5 + rest_s;
        [
            times.iter().map(|t| velocity(*t)).collect(),
            times.iter().map(|t| if moves(*t) { -5.0 } else { 0.0 }).collect(),
        ]
    }

    #[test]
    fn a_stick_is_as_long_as_the_joint_stands() {
        let [v, a] = reversal(0.06, 1e-3);
        let found = sticks(&v, &a, 0.01, 1e-3);
        assert_eq!(found.len(), 1);
        let Stick { from, to, directions } = found[0];
        assert!(from.abs_diff(500) <= 2 && to.abs_diff(560) <= 2, "{from} {to}");
        assert_eq!(directions, [1.0, -1.0]);
        assert!(
            (found[0].friction(from) - 1.0).abs() < 0.05 && (found[0].friction(to - 1) + 1.0).abs() < 0.05
        );
    }

    #[test]
    fn a_joint_that_turns_at_once_does_not_stick() {
        let [v, a] = reversal(0.0, 1e-3);
        assert_eq!(sticks(&v, &a, 0.01, 1e-3), []);
    }

    #[test]
    fn a_stop_between_two_motions_of_one_direction_is_no_reversal() {
        let [v, a] = reversal(0.06, 1e-3);
        let on: Vec<f64> = v.iter().map(|v| v.abs()).collect();
        assert_eq!(sticks(&on, &a, 0.01, 1e-3), []);
    }
}
