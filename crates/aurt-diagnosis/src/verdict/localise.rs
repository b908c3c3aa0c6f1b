//! Where a residual sits: the coordinate that it follows, and the windows in which it stands out.

use crate::recordings::rows::RecordingRows;

/// Classes of equal count in which a coordinate is divided.
const CLASSES: usize = 16;

/// Rows per stretch in the alternation of learning and judging.
const STRETCH_S: f64 = 2.0;

/// The coordinate that a residual follows best, and the share of its power that it predicts out of sample:
/// class means over the coordinate, learned on every other stretch of time and judged on the others, and the
/// other way round.
#[must_use]
pub fn follows(
    recordings: &[&RecordingRows],
    residuals: &[&[Vec<f64>]],
    joint: usize,
    load_torque: &[Vec<f64>],
) -> Option<(String, f64)> {
    let mut best: Option<(String, f64)> = None;
    let joints = recordings.first().map_or(0, |r| r.joints.len());
    let mut coordinates: Vec<(String, Vec<Vec<f64>>)> = Vec::new();
    let mut own = |name: &str, of: &dyn Fn(usize, &RecordingRows) -> Vec<f64>| {
        coordinates
            .push((name.to_owned(), recordings.iter().enumerate().map(|(r, rows)| of(r, rows)).collect()));
    };
    own("position", &|_, r| r.joints[joint].position_rad.clone());
    own("velocity", &|_, r| r.joints[joint].velocity_rad_s.clone());
    own("acceleration", &|_, r| r.joints[joint].acceleration_rad_s2.clone());
    own("load torque", &|r, _| load_torque[r].clone());
    own("power", &|r, rows| {
        load_torque[r].iter().zip(&rows.joints[joint].velocity_rad_s).map(|(a, b)| a * b).collect()
    });
    own("position since reversal", &|_, r| since_reversal(r, joint));
    own("time", &|_, r| r.time_s.iter().map(|t| t - r.time_s[0]).collect());
    for other in (0..joints).filter(|k| *k != joint) {
        own(&format!("velocity of joint {other}"), &|_, r| r.joints[other].velocity_rad_s.clone());
        own(&format!("position of joint {other}"), &|_, r| r.joints[other].position_rad.clone());
    }
    for (name, values) in coordinates {
        let share = predicted_share(recordings, residuals, joint, &values);
        if best.as_ref().is_none_or(|(_, s)| share > *s) {
            best = Some((name, share));
        }
    }
    best.filter(|(_, share)| *share > 0.05)
}

/// Angle travelled since the joint last reversed, with the sign of motion.
fn since_reversal(recording: &RecordingRows, joint: usize) -> Vec<f64> {
    let rows = &recording.joints[joint];
    let mut anchor = rows.position_rad.first().copied().unwrap_or(0.0);
    let mut sign = 0.0;
    rows.position_rad
        .iter()
        .zip(&rows.velocity_rad_s)
        .map(|(q, v)| {
            if *v != 0.0 && v.signum() != sign {
                sign = v.signum();
                anchor = *q;
            }
            sign * (q - anchor).abs().sqrt()
        })
        .collect()
}

fn predicted_share(
    recordings: &[&RecordingRows],
    residuals: &[&[Vec<f64>]],
    joint: usize,
    values: &[Vec<f64>],
) -> f64 {
    let mut sorted: Vec<f64> = values.iter().flatten().copied().collect();
    sorted.sort_by(f64::total_cmp);
    if sorted.len() < 8 * CLASSES {
        return 0.0;
    }
    let edges: Vec<f64> = (1..CLASSES).map(|k| sorted[k * sorted.len() / CLASSES]).collect();
    let mut sums = [[(0.0, 0.0); CLASSES]; 2];
    let walk = |visit: &mut dyn FnMut(usize, usize, f64)| {
        for ((recording, residual), value) in recordings.iter().zip(residuals).zip(values) {
            let stretch = (STRETCH_S * recording.rate_hz).max(1.0) as usize;
            for (k, (r, x)) in residual[joint].iter().zip(value).enumerate() {
                visit((k / stretch) % 2, edges.partition_point(|e| e < x), *r);
            }
        }
    };
    walk(&mut |half, class, r| {
        sums[half][class].0 += r;
        sums[half][class].1 += 1.0;
    });
    let (mut before, mut after) = (0.0, 0.0);
    walk(&mut |half, class, r| {
        let (sum, count) = sums[1 - half][class];
        let predicted = if count > 3.0 { sum / count } else { 0.0 };
        before += r * r;
        after += (r - predicted).powi(2);
    });
    if before > 0.0 { 1.0 - after / before } else { 0.0 }
}

/// Length of the bins in which windows are looked for, s.
const BIN_S: f64 = 0.5;

/// Times a bin's root mean square must exceed the larger of noise floor and median bin.
const STANDS_OUT: f64 = 3.5;

/// Rows before and after a reversal in which its jolt shows: rows are as dense as the filter lets anything be seen.
const JOLT_ROWS: usize = 2;

/// Windows (s from the recording's first row) in which a joint's residual stands out of the rest of its recording, its
/// reversals apart: where it sticks and breaks loose is told by no window of time.
#[must_use]
pub fn windows(recording: &RecordingRows, joint: usize, residual: &[f64], floor: f64) -> Vec<[f64; 2]> {
    let bin = (BIN_S * recording.rate_hz).max(2.0) as usize;
    let velocity = &recording.joints[joint].velocity_rad_s;
    let turns: Vec<usize> = (1..velocity.len()).filter(|k| velocity[*k] * velocity[*k - 1] <= 0.0).collect();
    let jolted = |row: &usize| {
        let after = turns.partition_point(|turn| *turn + JOLT_ROWS <= *row);
        turns.get(after).is_some_and(|turn| row + JOLT_ROWS >= *turn)
    };
    let levels: Vec<f64> = (0..residual.len())
        .step_by(bin)
        .map(|from| {
            let rows = (from..(from + bin).min(residual.len())).filter(|row| !jolted(row));
            let (sum, count) = rows.fold((0.0, 0.0), |(s, n), row| (s + residual[row].powi(2), n + 1.0));
            f64::sqrt(if count > 0.0 { sum / count } else { 0.0 })
        })
        .collect();
    let mut sorted: Vec<f64> = levels.iter().copied().filter(|level| *level > 0.0).collect();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let threshold = STANDS_OUT * median.max(floor);
    let time = |row: usize| recording.time_s[row.min(recording.rows() - 1)] - recording.time_s[0];
    let mut found: Vec<[f64; 2]> = Vec::new();
    for (k, _) in levels.iter().enumerate().filter(|(_, level)| **level > threshold) {
        let window = [time(k * bin), time((k + 1) * bin)];
        match found.last_mut() {
            Some(last) if window[0] - last[1] < 1.5 * BIN_S => last[1] = window[1],
            _ => found.push(window),
        }
    }
    found
}
