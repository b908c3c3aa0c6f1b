//! What speaks against a model of drives, or against the columns that it was estimated from.

use aurt_drives::DriveRecording;

use super::Judged;

/// Joints of which a rollout explains less than half, or which the command itself meets better.
pub(super) fn of_rollouts(judged: &[Judged], deviation_rad: f64) -> Vec<String> {
    let mut doubts = Vec::new();
    for recording in judged {
        for (joint, (rms, spread)) in recording.rms.iter().zip(&recording.spread).enumerate() {
            let explained = 1.0 - (rms / spread).powi(2);
            if *spread > deviation_rad && explained < 0.5 {
                doubts.push(format!(
                    "the model explains {:.0} % of joint {joint} ({}): check signs, units and the order of columns",
                    100.0 * explained.max(0.0),
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

/// Joints that do not follow the position that they are told: the other sign, or another joint's command.
pub(super) fn of_commands(recordings: &[(&str, &DriveRecording)]) -> Vec<String> {
    let mut doubts = Vec::new();
    for (label, recording) in recordings {
        for (joint, position) in recording.position_rad.iter().enumerate() {
            let follows: Vec<f64> = recording.command.iter().map(|c| correlation(c, position)).collect();
            let own = follows[joint];
            let of_another =
                (0..follows.len()).filter(|k| *k != joint).max_by(|a, b| follows[*a].total_cmp(&follows[*b]));
            if own < -HALF {
                doubts.push(format!(
                    "joint {joint} moves against its command ({label}): one of them has the other sign"
                ));
            } else if let Some(other) = of_another.filter(|k| own < HALF && follows[*k] > HALF) {
                doubts.push(format!(
                    "joint {joint} follows the command of joint {other} and not its own ({label}): columns may be exchanged"
                ));
            }
        }
    }
    doubts
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

    #[test]
    fn exchanged_commands_and_signs_are_told() {
        let series =
            |rate: f64| -> Vec<f64> { (0..400).map(|k| (rate * 0.02 * f64::from(k)).sin()).collect() };
        let [a, b] = [series(1.0), series(1.7)];
        let told = |command: [&Vec<f64>; 2]| {
            let command = command.map(Clone::clone).to_vec();
            let position_rad = vec![a.clone(), b.clone()];
            of_commands(&[("a.csv", &DriveRecording { command, position_rad, ..DriveRecording::default() })])
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
