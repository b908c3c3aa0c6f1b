//! What commands and positions cannot be, or cannot tell, and what speaks against a model of them.

use aurt_calibration::drives::{DriveRecording, DrivenArm};
use aurt_traits::{Command, CommandSignal, RobotNames};

use super::Judged;

/// Travel below which a joint rests: two ticks of an encoder with 4096 a turn, rad.
const RESTS_RAD: f64 = 2.0 * std::f64::consts::TAU / 4096.0;
/// Shifts of the command that are tried, s; a servo's own lag stays below the last.
const SHIFTS_S: f64 = 1.0;
const LONGEST_LAG_S: f64 = 0.5;

/// Currents without sign, which no drive can be estimated from.
pub(super) fn unsigned(recording: &DriveRecording, arm: &DrivenArm, names: RobotNames<'_>) -> Option<String> {
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
        .map(|j| {
            let joint = names.joint(j);
            format!("the current of {joint} is never negative, and the joint moves both ways: its sign is not recorded")
        })
}

/// What a person should know of a recording of position commands.
pub(super) fn doubts(
    recording: &DriveRecording,
    signal: CommandSignal,
    names: RobotNames<'_>,
) -> Vec<String> {
    let travel = |s: &Vec<f64>| {
        let (low, high) =
            s.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
        high - low
    };
    let mut said = exchanged(recording, names);
    for (j, (command, position)) in recording.command.iter().zip(&recording.position_rad).enumerate() {
        let [asked, done] = [command, position].map(travel);
        if asked > RESTS_RAD && done <= RESTS_RAD {
            said.push(format!(
                "{} never moves while its command varies by {asked:.4} rad: it does not leave its dead band and dry friction, and \
                 nothing of its drive is determined; record larger commands",
                names.joint(j)
            ));
        }
    }
    if let Some(rows) = rows_per_command(recording).filter(|_| signal == CommandSignal::Linear) {
        said.push(format!(
            "the command changes with every {rows:.1}th row while it moves and holds between: write command = \"hold\""
        ));
    }
    said.extend(of_another_clock(recording));
    said
}

/// A command that moves is repeated in this many rows, and in as many rows it changes, at least.
const STAIRS: usize = 20;

/// Rows from change to change of a moving command that is sent less often than it is recorded: a staircase. None of one that
/// changes with every row, or that does not move for long. A command that moves goes on in its direction with most changes; one
/// that names pose after pose does not, and tells nothing of what lies between two rows.
pub(super) fn rows_per_command(recording: &DriveRecording) -> Option<f64> {
    let (mut rows, mut changes, mut repeats, mut onward) = (0, 0, 0, 0);
    for command in &recording.command {
        let changed: Vec<usize> = (1..command.len()).filter(|k| command[*k] != command[*k - 1]).collect();
        // Between changes that are the same number of rows apart it moves; longer pauses are rests.
        let gaps: Vec<usize> = changed.windows(2).map(|w| w[1] - w[0]).collect();
        let mut sorted = gaps.clone();
        sorted.sort_unstable();
        let Some(usual) = sorted.get(sorted.len() / 2).copied() else { continue };
        let by = |row: usize| command[row] - command[row - 1];
        for (gap, pair) in gaps.iter().zip(changed.windows(2)).filter(|(gap, _)| **gap <= 2 * usual) {
            rows += gap;
            changes += 1;
            repeats += usize::from(*gap > 1);
            onward += usize::from(by(pair[0]) * by(pair[1]) > 0.0);
        }
    }
    let is_staircase = changes >= STAIRS && 2 * repeats > changes && 2 * onward > changes;
    is_staircase.then(|| rows as f64 / changes as f64)
}

/// Positions that are nearer to the commands by half at a shift that is no lag of a servo.
fn of_another_clock(recording: &DriveRecording) -> Option<String> {
    let time_s = &recording.time_s;
    let n = time_s.len();
    let period_s = (time_s[n - 1] - time_s[0]) / (n - 1) as f64;
    let most = ((SHIFTS_S / period_s) as usize).min(n / 4) as i64;
    let after_s = time_s.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
    let is_lag = |shift: i64| (-2.0 * after_s..=LONGEST_LAG_S).contains(&(shift as f64 * period_s));
    let least = |shifts: &dyn Fn(i64) -> bool| {
        let errors =
            (-most..=most).filter(|s| shifts(*s)).map(|shift| (apart(recording, shift, most), shift));
        errors.min_by(|a, b| a.0.total_cmp(&b.0))
    };
    let (error, shift) = least(&|shift| !is_lag(shift))?;
    let (as_lag, _) = least(&is_lag)?;
    let how = if shift < 0 { "precede" } else { "follow" };
    (error < 0.25 * as_lag).then(|| {
        format!(
            "positions {how} their commands by {:.2} s: the two seem to be of different clocks; stamp both by one",
            shift.abs() as f64 * period_s
        )
    })
}

/// The sum of the variances of positions minus commands that are shifted by so many samples, of at most `most`.
fn apart(recording: &DriveRecording, shift: i64, most: i64) -> f64 {
    let n = recording.time_s.len();
    let rows = || (most as usize..n - most as usize).step_by(n.div_ceil(4000));
    let pairs = recording.command.iter().zip(&recording.position_rad);
    pairs
        .map(|(c, q)| {
            let error = |k: usize| q[k] - c[(k as i64 - shift) as usize];
            let count = rows().count().max(1) as f64;
            let mean = rows().map(error).sum::<f64>() / count;
            rows().map(|k| (error(k) - mean).powi(2)).sum::<f64>() / count
        })
        .sum()
}

/// Joints of which a rollout explains less than half, or which the command itself meets better.
pub(super) fn of_rollouts(judged: &[Judged], deviation_rad: f64, names: RobotNames<'_>) -> Vec<String> {
    let mut doubts = Vec::new();
    for recording in judged {
        for (joint, (rms, spread)) in recording.rms.iter().zip(&recording.spread).enumerate() {
            let explained = 1.0 - (rms / spread).powi(2);
            if *spread > deviation_rad && explained < 0.5 {
                doubts.push(format!(
                    "the model explains {:.0} % of {} ({}): check signs, units and the order of columns",
                    100.0 * explained.max(0.0),
                    names.joint(joint),
                    recording.label
                ));
            }
        }
        let rms = super::over_joints(&recording.rms);
        if let Some(command) = recording.command_rms.filter(|command| *command < rms && rms > deviation_rad) {
            doubts.push(format!(
                "the command itself is nearer to the positions than the model ({:.2} and {:.2} mrad, {})",
                1e3 * command,
                1e3 * rms,
                recording.label
            ));
        }
    }
    doubts
}

/// Joints that do not follow the position that they are told at any lag: the other sign, or another joint's command.
fn exchanged(recording: &DriveRecording, names: RobotNames<'_>) -> Vec<String> {
    let mut said = Vec::new();
    let n = recording.time_s.len();
    let lasts_s =
        recording.time_s.last().zip(recording.time_s.first()).map_or(0.0, |(last, first)| last - first);
    let most = ((LONGEST_LAG_S / lasts_s.max(LONGEST_LAG_S) * n as f64) as usize).min(n / 4);
    for (joint, position) in recording.position_rad.iter().enumerate() {
        let follows = |command: &Vec<f64>| {
            let at = |lag: usize| correlation(&command[most - lag..n - lag], &position[most..]);
            (0..=most).map(at).fold(f64::NEG_INFINITY, f64::max)
        };
        let follows: Vec<f64> = recording.command.iter().map(follows).collect();
        let own = follows[joint];
        let others = (0..follows.len()).filter(|k| *k != joint);
        let other = others.max_by(|a, b| follows[*a].total_cmp(&follows[*b]));
        if own < -HALF {
            said.push(format!(
                "{} moves against its command: one of them has the other sign",
                names.joint(joint)
            ));
        } else if let Some(other) = other.filter(|k| own < HALF && follows[*k] > HALF) {
            said.push(format!(
                "{} follows the command of {} and not its own: columns may be exchanged",
                names.joint(joint),
                names.joint(other)
            ));
        }
    }
    said
}

/// The correlation with which one series explains half of another.
const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Pearson's correlation; 0 for a series that is constant.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |s: &[f64]| s.iter().sum::<f64>() / s.len().max(1) as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let [mut aa, mut ab, mut bb] = [0.0; 3];
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (a - mean_a, b - mean_b);
        aa += a * a;
        ab += a * b;
        bb += b * b;
    }
    if aa > 0.0 && bb > 0.0 { ab / (aa * bb).sqrt() } else { 0.0 }
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
        let doubts =
            |recording: &DriveRecording| doubts(recording, CommandSignal::Linear, RobotNames::default());
        assert!(doubts(&recording(4, 1.0)).is_empty());
        assert!(doubts(&recording(40, 1.0))[0].contains("follow their commands by 0.80 s"));
        let mut early = recording(30, 1.0);
        std::mem::swap(&mut early.command, &mut early.position_rad);
        assert!(doubts(&early)[0].contains("precede their commands by 0.60 s"));
        assert!(doubts(&recording(0, 1e-4))[0].contains("never moves"));
        // Sent with every fifth row.
        let mut slow = recording(4, 1.0);
        slow.command[0] = (0..600).map(|k| slow.command[0][k / 5 * 5]).collect();
        assert!(doubts(&slow)[0].contains("every 5.0th row") && doubts(&slow)[0].contains("hold"));
        assert!(super::doubts(&slow, CommandSignal::Hold, RobotNames::default()).is_empty());
    }

    #[test]
    fn poses_that_are_held_are_no_command_that_is_sent_seldom() {
        let mut slow = recording(4, 1.0);
        slow.command[0] = (0..600).map(|k| slow.command[0][k / 5 * 5]).collect();
        assert_eq!(rows_per_command(&slow), Some(5.0));
        // Fifty poses of twelve rows in no order.
        let pose = |k: usize| [0.0, 0.8, -0.3, 0.4, -0.9, 0.6, -0.1][k / 12 * 3 % 7];
        slow.command[0] = (0..600).map(pose).collect();
        assert_eq!(rows_per_command(&slow), None);
    }

    #[test]
    fn exchanged_commands_and_signs_are_told() {
        let series =
            |rate: f64| -> Vec<f64> { (0..400).map(|k| (rate * 0.02 * f64::from(k)).sin()).collect() };
        let [a, b] = [series(1.0), series(1.7)];
        let told = |command: [&Vec<f64>; 2]| {
            let command = command.map(Clone::clone).to_vec();
            let position_rad = vec![a.clone(), b.clone()];
            let time_s = (0..400).map(|k| 0.02 * f64::from(k)).collect();
            exchanged(
                &DriveRecording { time_s, command, position_rad, ..DriveRecording::default() },
                RobotNames::default(),
            )
        };
        assert_eq!(told([&a, &b]), [""; 0]);
        let exchanged = told([&b, &a]);
        assert!(
            exchanged.len() == 2 && exchanged[0].contains("joint 0 follows the command of joint 1"),
            "{exchanged:?}"
        );
        let against: Vec<f64> = a.iter().map(|c| -c).collect();
        let against = told([&against, &b]);
        assert!(
            against.len() == 1 && against[0].contains("joint 0 moves against its command"),
            "{against:?}"
        );
    }
}
