//! What commands and positions cannot be, or cannot tell.

use aurt_drives::{DriveRecording, DrivenArm};
use aurt_traits::Command;

/// Travel below which a joint rests: two ticks of an encoder with 4096 a turn, rad.
const RESTS_RAD: f64 = 2.0 * std::f64::consts::TAU / 4096.0;
/// Shifts of the command that are tried, s; a servo's own lag stays below the last.
const SHIFTS_S: f64 = 1.0;
const LONGEST_LAG_S: f64 = 0.5;

/// Currents without sign, which no drive can be estimated from.
pub(super) fn unsigned(recording: &DriveRecording, arm: &DrivenArm) -> Option<String> {
    let both_ways = |q: &[f64]| {
        let travels = |sign: f64| {
            let mut low = f64::INFINITY;
            q.iter().fold(0.0, |most: f64, q| {
                low = low.min(sign * q);
                most.max(sign * q - low)
            })
        };
        travels(1.0).min(travels(-1.0)) > 10.0 * RESTS_RAD
    };
    (0..arm.joints.len())
        .find(|j| {
            let command = &recording.command[*j];
            let one_sign = command.iter().all(|c| *c >= 0.0) && command.iter().any(|c| *c > 0.0);
            let of_current = arm.joints[*j].drive.command() == Command::Current;
            of_current && one_sign && both_ways(&recording.position_rad[*j])
        })
        .map(|j| format!("the current of joint {j} is never negative, and the joint moves both ways: its sign is not recorded"))
}

/// What a person should know of a recording of position commands.
pub(super) fn doubts(recording: &DriveRecording) -> Vec<String> {
    let travel = |s: &Vec<f64>| {
        let (low, high) =
            s.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
        high - low
    };
    let mut said = Vec::new();
    for (j, (command, position)) in recording.command.iter().zip(&recording.position_rad).enumerate() {
        let [asked, done] = [command, position].map(travel);
        if asked > RESTS_RAD && done <= RESTS_RAD {
            said.push(format!(
                "joint {j} never moves while its command varies by {asked:.4} rad: it does not leave its dead band and dry friction, and \
                 nothing of its drive is determined; record larger commands"
            ));
        }
    }
    let lag_s = lag_s(recording);
    let after = recording.time_s.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
    if lag_s < -2.0 * after || lag_s > LONGEST_LAG_S {
        let how = if lag_s < 0.0 { "precede" } else { "follow" };
        said.push(format!(
            "positions {how} their commands by {:.2} s: the two seem to be of different clocks; stamp both by one",
            lag_s.abs()
        ));
    }
    said
}

/// The shift of the commands at which they are nearest to the positions, s.
fn lag_s(recording: &DriveRecording) -> f64 {
    let time_s = &recording.time_s;
    let n = time_s.len();
    let period_s = (time_s[n - 1] - time_s[0]) / (n - 1) as f64;
    let most = ((SHIFTS_S / period_s) as usize).min(n / 4) as i64;
    let stride = n.div_ceil(4000);
    let apart = |shift: i64| -> f64 {
        let rows = (most as usize..n - most as usize).step_by(stride);
        let error = |k: usize| -> f64 {
            let from = (k as i64 - shift) as usize;
            let pairs = recording.command.iter().zip(&recording.position_rad);
            pairs.map(|(c, q)| (c[from] - q[k]).powi(2)).sum()
        };
        rows.map(error).sum()
    };
    let best = (-most..=most).min_by(|a, b| apart(*a).total_cmp(&apart(*b)).then(a.abs().cmp(&b.abs())));
    best.unwrap_or(0) as f64 * period_s
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(lag: usize, moves: f64) -> DriveRecording {
        let wave = |k: usize| (0.03 * k as f64).sin() + 0.3 * (0.11 * k as f64).sin();
        DriveRecording {
            time_s: (0..600).map(|k| 0.02 * f64::from(k)).collect(),
            command: vec![(0..600).map(|k| wave(k + 100)).collect()],
            position_rad: vec![(0..600).map(|k| moves * wave(k + 100 - lag)).collect()],
            ..DriveRecording::default()
        }
    }

    #[test]
    fn joints_that_rest_and_clocks_that_differ_are_told() {
        assert!(doubts(&recording(4, 1.0)).is_empty());
        assert!(doubts(&recording(40, 1.0))[0].contains("follow their commands by 0.80 s"));
        let mut early = recording(30, 1.0);
        std::mem::swap(&mut early.command, &mut early.position_rad);
        assert!(doubts(&early)[0].contains("precede their commands by 0.60 s"));
        assert!(doubts(&recording(0, 1e-4))[0].contains("never moves"));
    }
}
