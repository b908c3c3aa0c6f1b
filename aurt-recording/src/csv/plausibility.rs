//! Values that a sensor can show but a robot cannot reach.

use std::f64::consts::TAU;

/// A row that its neighbours contradict.
pub(super) struct Finding {
    pub(super) row: usize,
    /// Index of the series that shows it, among those that were looked at.
    pub(super) place: usize,
    /// What is wrong with the value, as the rest of a sentence that starts with it.
    pub(super) what: &'static str,
}

/// No joint of an arm turns this fast, in rad/s.
const IMPOSSIBLE_RAD_S: f64 = 50.0;

/// Smaller steps are never called a jump, in rad.
const JUMP_RAD: f64 = 0.2;

/// Of a whole turn a jump may differ by this much, in rad.
const TURN_TOLERANCE_RAD: f64 = 0.5;

/// Size of the step from sample k to k + 1 if no joint can make it.
fn jump(time: &[f64], position: &[f64], k: usize) -> Option<f64> {
    let step = position[k + 1] - position[k];
    let impossible = step.abs() > JUMP_RAD && step.abs() > IMPOSSIBLE_RAD_S * (time[k + 1] - time[k]);
    impossible.then_some(step)
}

fn is_turn(step: f64) -> bool {
    step.abs() > TAU / 2.0 && (step - TAU * (step / TAU).round()).abs() < TURN_TOLERANCE_RAD
}

/// Single rows in which a position leaps away and is back in the next; a first or last row that the rest leaps
/// away from.
pub(super) fn position_outliers(time: &[f64], positions: &[Vec<f64>]) -> Vec<Finding> {
    let n = time.len();
    let mut findings = Vec::new();
    if n < 3 {
        return findings;
    }
    for (place, q) in positions.iter().enumerate() {
        for k in 0..n - 1 {
            let Some(step) = jump(time, q, k) else { continue };
            let returns = k + 2 < n
                && jump(time, q, k + 1).is_some()
                && (q[k + 2] - q[k]).abs() < 0.1 * step.abs().min((q[k + 2] - q[k + 1]).abs());
            if returns {
                findings.push(Finding { row: k + 1, place, what: "leaps away for one row" });
                continue;
            }
            let alone = |next: usize| (q[next + 1] - q[next]).abs() < 0.1 * step.abs() && !is_turn(step);
            if k == 0 && alone(1) {
                findings.push(Finding { row: 0, place, what: "does not lead to the second row" });
            } else if k + 2 == n && alone(n - 3) {
                findings.push(Finding { row: n - 1, place, what: "does not follow from the row before" });
            }
        }
    }
    findings
}

/// Measurements a thousand times beyond what all joints together show 99 % of the time.
pub(super) fn measurement_outliers(measurements: &[Vec<f64>]) -> Vec<Finding> {
    const FACTOR: f64 = 1000.0;
    const ROWS_NEEDED: usize = 100;
    let largest = |s: &Vec<f64>| s.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let mean = |s: &Vec<f64>| s.iter().map(|v| v.abs()).sum::<f64>() / s.len().max(1) as f64;
    let rows = measurements.first().map_or(0, Vec::len);
    let extreme = measurements.iter().map(largest).fold(0.0, f64::max);
    let usual = measurements.iter().map(mean).fold(0.0, f64::max);
    // A mean is cheap, and never above the quantile by more than the outliers' own share of it.
    if rows < ROWS_NEEDED || extreme <= 10.0 * usual {
        return Vec::new();
    }
    let quantile = |s: &Vec<f64>| {
        let mut sorted: Vec<f64> = s.iter().map(|v| v.abs()).collect();
        let at = rows - 1 - rows / 100;
        *sorted.select_nth_unstable_by(at, f64::total_cmp).1
    };
    let limit = FACTOR * measurements.iter().map(quantile).fold(0.0, f64::max);
    if limit == 0.0 {
        return Vec::new();
    }
    let what = "is more than a thousand times what joints show otherwise";
    measurements
        .iter()
        .enumerate()
        .flat_map(|(place, s)| s.iter().enumerate().map(move |(row, v)| (row, place, v)))
        .filter(|(_, _, v)| v.abs() > limit)
        .map(|(row, place, _)| Finding { row, place, what })
        .collect()
}

/// Where the unwrapping of a joint's positions stands.
#[derive(Clone, Copy, Default)]
pub(super) struct Turns {
    /// What is added to positions, in rad.
    offset: f64,
    /// Stamp and position, as it was read, of the row before.
    before: Option<[f64; 2]>,
}

#[derive(Clone, Copy)]
pub(super) struct JointPosition {
    pub(super) joint: usize,
    /// Whether it slides: lengths have no whole turns.
    pub(super) slides: bool,
    pub(super) tells_jumps: bool,
}

impl JointPosition {
    /// Removes jumps by whole turns from a joint's positions; the sentences say where jumps were removed, and where some stay.
    pub(super) fn unwrap(
        self,
        time: &[f64],
        position: &mut [f64],
        lines: &[u32],
        state: &mut Turns,
    ) -> [Option<String>; 2] {
        let Self { joint, slides, tells_jumps } = self;
        let mut turns = 0;
        let mut first_turn = None;
        let mut other = None;
        for k in 0..position.len() {
            let here = position[k];
            let [stamp, before] = state.before.unwrap_or([time[k], here]);
            let step = here - before;
            if step.abs() > JUMP_RAD && step.abs() > IMPOSSIBLE_RAD_S * (time[k] - stamp) {
                if !slides && is_turn(step) {
                    state.offset -= TAU * (step / TAU).round();
                    turns += 1;
                    first_turn = first_turn.or(Some(lines[k]));
                } else {
                    other = other.or(Some((lines[k], step)));
                }
            }
            state.before = Some([time[k], here]);
            position[k] = here + state.offset;
        }
        let turned = first_turn.map(|line| {
            format!("the position of joint {joint} jumps by whole turns {turns} times (first in line {line}); it was unwrapped")
        });
        let jumped = other.filter(|_| tells_jumps).map(|(line, step)| {
            let (unit, moves) = if slides { ("m", "slide") } else { ("rad", "turn") };
            format!(
                "the position of joint {joint} jumps by {step:.3} {unit} in line {line}, faster than joints {moves}"
            )
        });
        [turned, jumped]
    }
}

/// A remark if positions of joints that turn look like degrees: no arm turns that many times.
pub(super) fn remark_on_degrees(position_rad: &[Vec<f64>], sliding: &[bool]) -> Option<String> {
    const TURNS_RAD: f64 = 30.0;
    let largest = |q: &Vec<f64>| q.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let turning = position_rad.iter().map(largest).enumerate().filter(|(joint, _)| !sliding[*joint]);
    let (joint, angle) = turning.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (angle > TURNS_RAD).then(|| {
        format!("positions reach {angle:.1} on joint {joint}: they are taken as rad; were they degrees (angle = \"deg\")?")
    })
}
