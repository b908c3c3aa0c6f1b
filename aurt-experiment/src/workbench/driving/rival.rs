//! What a black box predicts of the positions that a model misses.

use aurt_calibration::drives::DriveRecording;
use aurt_diagnosis::remainder::{Judged, Remainder, Rows};

/// Rows that are fitted; of more, every k-th is.
const MOST_ROWS: usize = 6000;
/// Stretches that stop the growth in turn, and between which shares vary, in s: several poses.
const STRETCH_S: f64 = 5.0;
/// How long ago commands still act, in s.
const AGO_S: [f64; 4] = [0.05, 0.1, 0.2, 0.5];

/// What trees predict of the joints' errors q_sim − q: fitted and held-out recordings with their rollouts.
pub(super) fn rests(
    fitted: &[(&DriveRecording, Vec<Vec<f64>>)],
    held_out: &[(&DriveRecording, Vec<Vec<f64>>)],
) -> Vec<Remainder> {
    let joints = held_out.first().map_or(0, |(r, _)| r.command.len());
    let rest = |joint: usize| {
        let judged = Judged::of(&rows(fitted, joint, MOST_ROWS), &rows(held_out, joint, usize::MAX));
        Remainder::of(joint, judged.as_ref(), || names(joints))
    };
    (0..joints).map(rest).collect()
}

fn names(joints: usize) -> Vec<String> {
    let ago = AGO_S.iter().map(|s| format!("command {s} s ago"));
    let own = ["command", "speed of the command", "speed", "time since the last reversal"].map(str::to_owned);
    own.into_iter().chain(ago).chain((0..joints).map(|j| format!("position of joint {j}"))).collect()
}

/// Features of what the model itself computes from commands: the measured positions are what is asked for.
fn rows(recordings: &[(&DriveRecording, Vec<Vec<f64>>)], joint: usize, most: usize) -> Rows {
    let all: usize = recordings.iter().map(|(r, _)| r.time_s.len()).sum();
    let mut rows = Rows::default();
    let mut first_stretch = 0;
    for (recording, simulated) in recordings {
        let (time_s, command, q) = (&recording.time_s, &recording.command[joint], &simulated[joint]);
        let at = |t: f64| time_s.partition_point(|s| *s < t).min(time_s.len() - 1);
        let rate =
            |s: &[f64], k: usize| if k == 0 { 0.0 } else { (s[k] - s[k - 1]) / (time_s[k] - time_s[k - 1]) };
        // Samples before the first are the command's history: nothing is simulated there.
        let first = recording.first;
        let (mut reversed_s, mut way) = (time_s[first], 0.0);
        for k in first..time_s.len() {
            let now = q[k - first];
            let speed = if k == first { 0.0 } else { (now - q[k - first - 1]) / (time_s[k] - time_s[k - 1]) };
            if speed * way < 0.0 {
                reversed_s = time_s[k];
            }
            way = if speed == 0.0 { way } else { speed };
            if k % all.div_ceil(most).max(1) != 0 {
                continue;
            }
            let mut own = vec![command[k] - now, rate(command, k), speed, time_s[k] - reversed_s];
            own.extend(AGO_S.map(|ago| command[at(time_s[k] - ago)] - now));
            own.extend(simulated.iter().map(|s| s[k - first]));
            rows.features.resize(own.len(), Vec::new());
            rows.features.iter_mut().zip(own).for_each(|(f, v)| f.push(v));
            rows.after.push(now - recording.position_rad[joint][k]);
            rows.stretch.push(first_stretch + ((time_s[k] - time_s[0]) / STRETCH_S) as usize);
        }
        first_stretch = rows.stretch.last().map_or(0, |s| s + 1);
    }
    rows.before.clone_from(&rows.after);
    rows
}
