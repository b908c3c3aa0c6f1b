//! Rows that are missing, repeated, held or corrupt.
//!
//! - *Missing*: the distance of two stamps spans a further period, and no shorter distance beside it makes up for
//!   it, as it does where a single stamp is late.
//! - *Repeated*: a stamp that is there already.
//! - *Held*: a new stamp with old values. Noisy measurements do not repeat on all joints at once, so where they do,
//!   and the arm goes on afterwards, the row is an old one. Positions alone that repeat are old if the motion
//!   before and after makes at least two steps of an encoder in a row's time: a true encoder cannot stand still
//!   then. So are the rows in which one joint's measurement is stuck (`stuck`).
//! - *Corrupt*: dropped by the reader, an angle or a measurement that leaps away for a single row (an old row behind a
//!   lost one repeats nothing, and its angles lag), or measurements of all joints that are zero for a few rows: the message
//!   had none.

use super::stuck::{self, Stuck};
use super::{CERTAIN, Fault, log10_poisson_tail, resolution, windows_s};
use crate::effects::dropped_samples;
use crate::parameters::{ParameterValue, Parameters};
use aurt_recording::{Recording, median_step_s, white_level_at};
use aurt_traits::RobotNames;

/// Faulty rows below this number are not worth a word.
const FEWEST: usize = 3;

/// Share of faulty rows from which on they can explain a mismatch.
const SUFFICIENT_SHARE: f64 = 0.002;

/// Stamps nearer than this share of a period are one.
const SAME_STAMP: f64 = 0.05;

/// A period of an irregular clock is at most this multiple of its median.
const LONGEST_PERIOD: f64 = 1.4;

/// Encoder steps that a joint has to make per row before a row without any counts as held.
const STEPS_PER_ROW: f64 = 2.0;

/// A run of identical rows up to this long is a fault even where the arm hardly moves. Longer ones at rest are
/// those of a drive that is switched off.
const LONGEST_BURST_ROWS: usize = 20;

/// Share of the way that a joint must have made during the rows in question.
const CAUGHT_UP: f64 = 0.5;

/// Rows on either side over which the motion is measured.
const MOTION_ROWS: usize = 4;

/// Factor between a spike and the white noise, and between a spike and the slope of its neighbourhood.
const SPIKE: f64 = 40.0;

pub(super) struct RowFaults {
    pub(super) fault: Option<Fault>,
    pub(super) spoilt: Vec<bool>,
    pub(super) gaps_s: Vec<[f64; 2]>,
}

pub(super) fn find(name: &str, recording: &Recording) -> RowFaults {
    let time = &recording.time_s;
    let period_s = median_step_s(time).unwrap_or(0.0);
    let mut spoilt = vec![false; time.len()];
    let (missing, gaps_s) = missing(recording, period_s);
    let same_stamp = repeated(recording);
    let repeated = mark(&mut spoilt, |k| same_stamp[k]);
    let held_rows = held(recording, &spoilt);
    let mut held = mark(&mut spoilt, |k| held_rows[k]);
    let corrupt_rows = corrupt(recording, &spoilt);
    let corrupt = mark(&mut spoilt, |k| corrupt_rows[k]) + recording.report.dropped_rows;
    let stuck = stuck::find(recording, &spoilt);
    for s in &stuck {
        held += mark(&mut spoilt, |k| (s.rows[0]..s.rows[1]).contains(&k));
    }
    // Rows that the reader dropped have left gaps of their own.
    let missing = missing.saturating_sub(recording.report.dropped_rows);
    let faulty = missing + repeated + held + corrupt;
    let share = faulty as f64 / (time.len() + missing + recording.report.dropped_rows).max(1) as f64;
    let fault = (faulty >= FEWEST).then(|| {
        let counts = [("missing", missing), ("repeated", repeated), ("held", held), ("corrupt", corrupt)];
        let words: Vec<String> =
            counts.iter().filter(|(_, n)| *n > 0).map(|(kind, n)| format!("{n} {kind}")).collect();
        let mut parameters: Parameters =
            counts.iter().map(|(kind, n)| ((*kind).to_owned(), ParameterValue::exact(*n))).collect();
        parameters.insert("share".to_owned(), ParameterValue::exact(share));
        Fault {
            effect: &dropped_samples::EFFECT,
            joints: (0..recording.joints()).collect(),
            recording: name.to_owned(),
            windows_s: all_windows(time, &spoilt, &gaps_s),
            parameters,
            share,
            log10_probability: CERTAIN,
            suffices: share >= SUFFICIENT_SHARE,
            sentence: format!(
                "{name}: {} rows ({:.2} % in all){}",
                words.join(", "),
                100.0 * share,
                said(recording, &stuck)
            ),
        }
    });
    RowFaults { fault, spoilt, gaps_s }
}

/// The sentence on stuck measurements.
fn said(recording: &Recording, stuck: &[Stuck]) -> String {
    let names = RobotNames::of_joints(recording.joints.names());
    let (time, unit) = (&recording.time_s, recording.unit.symbol());
    let sentence = |s: &Stuck| {
        let [from, to] = [s.rows[0], s.rows[1] - 1].map(|k| time[k] - time[0]);
        // Not −0.
        let (joint, value) = (names.joint(s.joint), s.value + 0.0);
        format!(
            "; the measurement of {joint} is constantly {value} {unit} from {from:.2} to {to:.2} s, though the joint goes to and fro"
        )
    };
    stuck.iter().map(sentence).collect()
}

/// Rows that are held or corrupt.
pub(super) fn unusable(recording: &Recording) -> Vec<bool> {
    let repeated = repeated(recording);
    let mut bad = held(recording, &repeated);
    let old: Vec<bool> = bad.iter().zip(&repeated).map(|(held, repeated)| *held || *repeated).collect();
    let corrupt = corrupt(recording, &old);
    mark(&mut bad, |k| corrupt[k]);
    for s in stuck::find(recording, &bad) {
        bad[s.rows[0]..s.rows[1]].fill(true);
    }
    bad
}

/// Marks further samples; how many were not marked yet.
fn mark(spoilt: &mut [bool], is_bad: impl Fn(usize) -> bool) -> usize {
    let mut count = 0;
    for (k, bad) in spoilt.iter_mut().enumerate() {
        if !*bad && is_bad(k) {
            *bad = true;
            count += 1;
        }
    }
    count
}

/// Rows whose stamp is there already.
fn repeated(recording: &Recording) -> Vec<bool> {
    let time = &recording.time_s;
    let period_s = median_step_s(time).unwrap_or(0.0);
    (0..time.len()).map(|k| k > 0 && time[k] - time[k - 1] <= SAME_STAMP * period_s).collect()
}

/// Number of missing rows and the stretches in which they are; what was left out on purpose is not missing.
fn missing(recording: &Recording, period_s: f64) -> (usize, Vec<[f64; 2]>) {
    let time = &recording.time_s;
    let mut distances: Vec<f64> =
        time.windows(2).map(|w| w[1] - w[0]).filter(|d| *d > SAME_STAMP * period_s).collect();
    if distances.len() < 10 {
        return (0, Vec::new());
    }
    let at = distances.len() * 9 / 10;
    let usual = *distances.select_nth_unstable_by(at, f64::total_cmp).1;
    let longest = usual.clamp(period_s, LONGEST_PERIOD * period_s);
    let mut count = 0;
    let mut gaps = Vec::new();
    for (k, w) in time.windows(2).enumerate() {
        let distance = w[1] - w[0];
        let report = &recording.report;
        let is_made = report.left_out_s.contains(&[w[0], w[1]]) || report.set_back_s.contains(&w[1]);
        if distance <= 1.5 * longest || is_made {
            continue;
        }
        // A late stamp is followed, and an early one preceded, by a distance that is short by as much.
        let before = k.checked_sub(1).map_or(period_s, |p| w[0] - time[p]);
        let after = time.get(k + 2).map_or(period_s, |t| t - w[1]);
        let made_up = (period_s - before).max(0.0) + (period_s - after).max(0.0);
        let rows = ((distance - made_up) / period_s).round() as usize;
        if rows >= 2 {
            count += rows - 1;
            gaps.push([w[0], w[1]]);
        }
    }
    (count, gaps)
}

/// Rows that repeat positions, measurements or both while the robot moves on.
fn held(recording: &Recording, repeated: &[bool]) -> Vec<bool> {
    let n = recording.samples();
    let mut held = vec![false; n];
    let same = |family: &[Vec<f64>], k: usize| family.iter().all(|s| s[k] == s[k - 1]);
    let repeats = |family: &[Vec<f64>]| -> Vec<bool> {
        (0..n).map(|k| k > 0 && !repeated[k] && same(family, k)).collect()
    };
    let still = repeats(&recording.position_rad);
    let mut frozen = recording.measurement.as_deref().map_or_else(|| vec![false; n], repeats);
    let measurement = recording.measurement.as_deref().unwrap_or_default();
    if !frozen.contains(&true) || !never_together(measurement, |s, k| s[k] == s[k - 1]) {
        frozen.fill(false);
    }
    if !still.contains(&true) && !frozen.contains(&true) {
        return held;
    }
    let usual: Vec<f64> = recording.position_rad.iter().map(|q| usual_step(q)).collect();
    let mut k = 1;
    while k < n {
        if !(still[k] || frozen[k]) {
            k += 1;
            continue;
        }
        let end = (k..n).find(|e| !(still[*e] || frozen[*e])).unwrap_or(n);
        let steps = if frozen[k..end].contains(&true) { None } else { Some(usual.as_slice()) };
        let identical = (k..end).all(|row| still[row] && frozen[row]);
        if identical && end - k <= LONGEST_BURST_ROWS || moves_on(recording, steps, k, end) {
            held[k..end].fill(true);
        }
        k = end;
    }
    held
}

/// The step of an encoder as far as its readings tell: of the steps between rows, the smallest tenth. What is
/// written to a file may be converted and rounded, so the smallest difference of all can be a fraction of it.
fn usual_step(position: &[f64]) -> f64 {
    let mut steps: Vec<f64> = position.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > 0.0).collect();
    if steps.is_empty() {
        return f64::INFINITY;
    }
    let at = steps.len() / 10;
    *steps.select_nth_unstable_by(at, f64::total_cmp).1
}

/// Whether it is practically impossible that the measurements of all joints show something at once by chance, in a row that
/// depends on the one before it: the probabilities of the single ones, taken where not all do, multiply.
fn never_together(measurement: &[Vec<f64>], shows: impl Fn(&[f64], usize) -> bool) -> bool {
    let n = measurement.first().map_or(0, Vec::len);
    let mut counts = vec![0_usize; measurement.len()];
    let mut rows = 0;
    for k in 1..n {
        if measurement.iter().all(|s| shows(s, k)) {
            continue;
        }
        rows += 1;
        for (count, series) in counts.iter_mut().zip(measurement) {
            *count += usize::from(shows(series, k));
        }
    }
    let probability: f64 = counts.iter().map(|c| (*c as f64 + 0.5) / (f64::from(rows) + 1.0)).product();
    log10_poisson_tail(probability * n as f64, 1) < -2.0
}

/// Whether some joint has gone on during the rows `first..end` as fast as before and after them: where a joint
/// really rested, it has not. With `steps`, its motion has to make several of these in a row's time as well, before
/// and after, in one direction.
fn moves_on(recording: &Recording, steps: Option<&[f64]>, first: usize, end: usize) -> bool {
    let time = &recording.time_s;
    let n = time.len();
    let (from, to) = ((first - 1).saturating_sub(MOTION_ROWS), (end + MOTION_ROWS).min(n) - 1);
    if from + 1 >= first || to <= end {
        return false;
    }
    let pause_s = (time[end] - time[first - 1]) / (end - first + 1) as f64;
    recording.position_rad.iter().enumerate().any(|(joint, q)| {
        let slope = |a: usize, b: usize| (q[b] - q[a]) / (time[b] - time[a]).max(f64::MIN_POSITIVE);
        let (before, during, after) = (slope(from, first - 1), slope(first - 1, end), slope(end, to));
        let slower = before.abs().min(after.abs());
        let fast = steps.is_none_or(|s| before * after > 0.0 && slower * pause_s >= STEPS_PER_ROW * s[joint]);
        fast && during != 0.0 && during.abs() > CAUGHT_UP * before.abs().max(after.abs())
    })
}

/// Rows in which an angle or a measurement leaps away and is back in the next, or all measurements are zero for a few rows.
fn corrupt(recording: &Recording, old: &[bool]) -> Vec<bool> {
    let n = recording.samples();
    let mut found = off_path(recording, old);
    let measurement = recording.measurement.as_deref().unwrap_or_default();
    let silent: Vec<bool> = (0..n).map(|k| measurement.iter().all(|s| s[k] == 0.0)).collect();
    if !measurement.is_empty() && silent.contains(&true) && never_together(measurement, |s, k| s[k] == 0.0) {
        let mut at = 0;
        for run in silent.chunk_by(|a, b| a == b) {
            let is_inside = at > 0 && at + run.len() < n;
            if run[0] && is_inside && run.len() <= LONGEST_BURST_ROWS {
                found[at..at + run.len()].fill(true);
            }
            at += run.len();
        }
    }
    for series in recording.measurement.iter().flatten() {
        let leap_at = |k: usize| {
            let [a, b, here, c, d] = [series[k - 2], series[k - 1], series[k], series[k + 1], series[k + 2]];
            let around = (a - b).abs().max((b - c).abs()).max((c - d).abs());
            let leap = (here - 0.5 * (b + c)).abs();
            (leap > SPIKE * around).then_some((k, leap))
        };
        let mut leaps = (2..n.saturating_sub(2)).filter_map(leap_at).peekable();
        if leaps.peek().is_some() {
            // A measurement that is held, or clipped, is quiet in between only.
            let changes = (1..n).filter(|k| !old[*k] && series[*k] != series[k - 1]);
            let (time, changing): (Vec<f64>, Vec<f64>) =
                changes.map(|k| (recording.time_s[k], series[k])).unzip();
            let noise = white_level_at(&time, &changing).max(resolution(series));
            leaps.filter(|(_, leap)| *leap > SPIKE * noise).for_each(|(k, _)| found[k] = true);
        }
    }
    found
}

/// Rows in which an angle is off the cubic through the two rows before and the two after it, while the rows beside it are
/// on theirs without it. Rows known to be old do not count.
fn off_path(recording: &Recording, old: &[bool]) -> Vec<bool> {
    let rows: Vec<usize> = (0..old.len()).filter(|k| !old[*k]).collect();
    let time: Vec<f64> = rows.iter().map(|k| recording.time_s[*k]).collect();
    let mut found = vec![false; old.len()];
    for position in &recording.position_rad {
        let path: Vec<f64> = rows.iter().map(|k| position[*k]).collect();
        let off = |at: usize, others: [usize; 4]| {
            let weight = |i: usize| -> f64 {
                let factors = others.iter().filter(|k| **k != i);
                factors.map(|k| (time[at] - time[*k]) / (time[i] - time[*k])).product()
            };
            (path[at] - others.iter().map(|i| weight(*i) * path[*i]).sum::<f64>()).abs()
        };
        let leap_at = |k: usize| {
            let leap = off(k, [k - 2, k - 1, k + 1, k + 2]);
            let around =
                off(k - 1, [k - 3, k - 2, k + 1, k + 2]).max(off(k + 1, [k - 2, k - 1, k + 2, k + 3]));
            (leap > SPIKE * around).then_some((k, leap))
        };
        let mut leaps = (3..path.len().saturating_sub(3)).filter_map(leap_at).peekable();
        if leaps.peek().is_some() {
            // A joint that stands still has none, and differs from its path by rounding.
            let noise = white_level_at(&time, &path).max(resolution(&path));
            let leaps = leaps.filter(|(_, leap)| noise > 0.0 && *leap > SPIKE * noise);
            leaps.for_each(|(k, _)| found[rows[k]] = true);
        }
    }
    found
}

/// The windows of corrupt samples and of gaps, merged.
fn all_windows(time: &[f64], spoilt: &[bool], gaps_s: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut marked = spoilt.to_vec();
    for [from, to] in gaps_s {
        for stamp in [from, to] {
            let k = time.partition_point(|t| t < stamp);
            if let Some(mark) = marked.get_mut(k) {
                *mark = true;
            }
        }
    }
    windows_s(time, &marked)
}
