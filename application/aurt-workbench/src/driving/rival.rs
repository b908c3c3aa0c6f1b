//! What a black box predicts of the positions that a model misses.

use aurt_diagnosis::remainder::boosting::{Boosted, Edges, Growth};
use aurt_drives::DriveRecording;
use serde::Serialize;

/// Rows that are fitted; of more, every k-th is.
const MOST_ROWS: usize = 6000;
/// Stretches that stop the growth in turn, and between which shares vary, in s: several poses.
const STRETCH_S: f64 = 5.0;
/// Fewer held-out stretches tell no deviation.
const FEWEST_STRETCHES: usize = 4;
/// A remainder matters where predicting it lowers the held-out error by a twentieth: 1 − 0.95².
const MATTERS: f64 = 0.0975;
/// How long ago commands still act, in s.
const AGO_S: [f64; 4] = [0.05, 0.1, 0.2, 0.5];

/// What is left of a joint.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rest {
    /// The joint.
    pub joint: usize,
    /// Share of the squared held-out error that boosted trees predict; none of too little data.
    pub predictable: Option<f64>,
    /// Its standard deviation.
    pub deviation: Option<f64>,
    /// The feature by which they split most, if the share matters.
    pub follows: Option<String>,
}

/// Rows of a joint.
#[derive(Default)]
struct Rows {
    features: Vec<Vec<f64>>,
    missed: Vec<f64>,
    stretch: Vec<usize>,
}

/// What trees predict of the joints' errors q_sim − q: fitted and held-out recordings with their rollouts.
pub(super) fn rests(
    fitted: &[(&DriveRecording, Vec<Vec<f64>>)],
    held_out: &[(&DriveRecording, Vec<Vec<f64>>)],
) -> Vec<Rest> {
    let joints = held_out.first().map_or(0, |(r, _)| r.command.len());
    (0..joints)
        .map(|joint| rest(&rows(fitted, joint, MOST_ROWS), &rows(held_out, joint, usize::MAX), joints, joint))
        .collect()
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
        let (mut reversed_s, mut way) = (time_s[0], 0.0);
        for k in 0..time_s.len() {
            let speed = rate(q, k);
            if speed * way < 0.0 {
                reversed_s = time_s[k];
            }
            way = if speed == 0.0 { way } else { speed };
            if k % all.div_ceil(most).max(1) != 0 {
                continue;
            }
            let mut own = vec![command[k] - q[k], rate(command, k), speed, time_s[k] - reversed_s];
            own.extend(AGO_S.map(|ago| command[at(time_s[k] - ago)] - q[k]));
            own.extend(simulated.iter().map(|s| s[k]));
            rows.features.resize(own.len(), Vec::new());
            rows.features.iter_mut().zip(own).for_each(|(f, v)| f.push(v));
            rows.missed.push(q[k] - recording.position_rad[joint][k]);
            rows.stretch.push(first_stretch + ((time_s[k] - time_s[0]) / STRETCH_S) as usize);
        }
        first_stretch = rows.stretch.last().map_or(0, |s| s + 1);
    }
    rows
}

fn rest(own: &Rows, other: &Rows, joints: usize, joint: usize) -> Rest {
    let nothing = Rest { joint, predictable: None, deviation: None, follows: None };
    let growth = Growth::default();
    let stretches = other.stretch.last().map_or(0, |s| s + 1);
    if own.missed.len() < 4 * growth.leaf_rows || stretches < FEWEST_STRETCHES {
        return nothing;
    }
    let edges = Edges::of(&own.features);
    let classes = edges.classes(&own.features);
    // How many trees help is found on alternating stretches; then all rows are fitted.
    let (even, odd): (Vec<usize>, Vec<usize>) =
        (0..own.missed.len()).partition(|k| own.stretch[*k].is_multiple_of(2));
    let stopped = |fitted: &[usize], judged: &[usize]| {
        Boosted::fit(&classes, &own.missed, fitted, Some(judged), growth).trees()
    };
    let trees = usize::midpoint(stopped(&even, &odd), stopped(&odd, &even));
    let all: Vec<usize> = (0..own.missed.len()).collect();
    let boosted = Boosted::fit(&classes, &own.missed, &all, None, Growth { trees, ..growth });
    let classes = edges.classes(&other.features);
    let mut squares = vec![[0.0; 2]; stretches];
    for (row, missed) in other.missed.iter().enumerate() {
        let rest = missed - boosted.predict(&classes, row);
        squares[other.stretch[row]][0] += missed * missed;
        squares[other.stretch[row]][1] += rest * rest;
    }
    let sum = squares.iter().fold([0.0; 2], |s, x| [s[0] + x[0], s[1] + x[1]]);
    let value = 1.0 - sum[1] / sum[0];
    // The jackknife over stretches.
    let n = stretches as f64;
    let without: Vec<f64> = squares.iter().map(|x| 1.0 - (sum[1] - x[1]) / (sum[0] - x[0])).collect();
    let mean = without.iter().sum::<f64>() / n;
    let deviation = ((n - 1.0) / n * without.iter().map(|v| (v - mean).powi(2)).sum::<f64>()).sqrt();
    if !(value.is_finite() && deviation.is_finite()) {
        return nothing;
    }
    let most = (0..boosted.gains.len()).max_by(|a, b| boosted.gains[*a].total_cmp(&boosted.gains[*b]));
    let follows = most.filter(|_| value > MATTERS.max(2.0 * deviation)).map(|k| names(joints)[k].clone());
    Rest { predictable: Some(value), deviation: Some(deviation), follows, ..nothing }
}
