//! Measurements that stay at one value while their joint goes to and fro: the logger wrote an old value, or none.
//!
//! Friction changes its sign with the direction, so that no measurement is constant through a reversal; a coarse one can be
//! for a while. How long it is by itself shows in the other runs of equal values: with m = ΣL²/ΣL, the mean length of the run
//! that a row belongs to, a run as long as L is among n runs with a probability of about n e^(−L/m).

use super::saturation::{LOG10_ACCEPTED, moving};
use aurt_recording::Recording;

/// A joint goes to and fro where it goes both ways by this share of its range.
const SHARE_OF_RANGE: f64 = 0.05;

/// A run of equal values.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stuck {
    pub(super) joint: usize,
    pub(super) value: f64,
    /// The rows, without the end.
    pub(super) rows: [usize; 2],
}

/// The stuck stretches of all joints; rows that are spoilt anyway do not count.
pub(super) fn find(recording: &Recording, spoilt: &[bool]) -> Vec<Stuck> {
    let series = recording.measurement.iter().flatten().enumerate();
    series
        .flat_map(|(joint, series)| of_joint(joint, series, &recording.position_rad[joint], spoilt))
        .collect()
}

fn of_joint(joint: usize, series: &[f64], position: &[f64], spoilt: &[bool]) -> Vec<Stuck> {
    let moves = moving(position);
    let mut runs: Vec<([usize; 2], f64)> = Vec::new();
    let mut from = 0;
    for run in series.chunk_by(|a, b| a == b) {
        let rows = [from, from + run.len()];
        from = rows[1];
        let moving = (rows[0]..rows[1]).filter(|k| moves[*k] && !spoilt[*k]).count();
        if moving > 0 {
            runs.push((rows, moving as f64));
        }
    }
    runs.sort_by(|a, b| a.1.total_cmp(&b.1));
    let least = SHARE_OF_RANGE * ways(position).into_iter().fold(0.0, f64::max);
    let mut stuck = Vec::new();
    while let Some((rows, length)) = runs.pop() {
        let [sum, squares] = runs.iter().fold([0.0, 0.0], |[s, q], (_, l)| [s + l, q + l * l]);
        // A measurement that never changes has no other run to compare with.
        if runs.is_empty()
            || (runs.len() as f64).log10() - length * sum / squares * std::f64::consts::LOG10_E
                > LOG10_ACCEPTED
        {
            break;
        }
        if ways(&position[rows[0]..rows[1]]).iter().all(|way| *way > least) {
            stuck.push(Stuck { joint, value: series[rows[0]], rows });
        }
    }
    stuck.sort_by_key(|s| s.rows);
    stuck
}

/// The largest ways up and down between two samples of a position.
fn ways(position: &[f64]) -> [f64; 2] {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut ways = [0.0_f64; 2];
    for q in position {
        (low, high) = (low.min(*q), high.max(*q));
        ways = [ways[0].max(q - low), ways[1].max(high - q)];
    }
    ways
}
