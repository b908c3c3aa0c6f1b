//! Faults of a recording that have nothing to do with the robot's physics: clipped or stuck measurements, rows that are
//! missing, repeated, held or corrupt.
//!
//! They are looked for in the raw recording, before physics is judged: physics fitted to faulty samples invents
//! effects. What is found is either repaired ([`RecordingFaults::repaired`]: samples whose values are not those of
//! their stamp are left out, and preprocessing interpolates between the rest) or masked
//! ([`RecordingFaults::faulty_rows`]: rows that no repair can restore are left out of fits).

mod rows;
mod saturation;
mod stuck;
#[cfg(test)]
mod tests;

use aurt_recording::Recording;

use crate::effects::{dropped_samples, saturation as clipping};
use crate::parameters::Parameters;
use crate::recordings::rows::RecordingRows;
use crate::vocabulary::Effect;

/// Least decimal logarithm of a probability that is told from zero.
const CERTAIN: f64 = -300.0;

/// A fault of one recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// The effect that it is.
    pub effect: &'static Effect,
    /// The joints concerned; all where whole rows are.
    pub joints: Vec<usize>,
    /// Name of the recording.
    pub recording: String,
    /// When it happens, s from the first stamp; neighbouring instants are merged.
    pub windows_s: Vec<[f64; 2]>,
    /// Parameters under their canonical names.
    pub parameters: Parameters,
    /// Share of the recording's rows that are concerned.
    pub share: f64,
    /// Decimal logarithm of the probability that a recording without the fault shows as much, at most 0 and at
    /// least −300.
    pub log10_probability: f64,
    /// True if the fault alone can explain a mismatch: so many rows are concerned, or the repair improves the fit. What is there
    /// but does not suffice belongs into the notes of a verdict.
    pub suffices: bool,
    pub sentence: String,
}

/// The faults of one recording and the samples that they spoil.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingFaults {
    /// The faults, the most certain first.
    pub faults: Vec<Fault>,
    /// Whether a joint's measurement at a sample shows a limit instead of a torque, `[joint][sample]`.
    pub clipped: Vec<Vec<bool>>,
    /// Whether a sample's values are not those of its stamp (held, repeated or corrupt).
    pub spoilt: Vec<bool>,
    /// Stretches in which samples are missing: stamps before and after, s, as in the recording.
    pub gaps_s: Vec<[f64; 2]>,
}

impl RecordingFaults {
    /// Looks for faults in a recording as it was read.
    ///
    /// On a recording whose clock only jitters, whose values are quantised and whose joints rest for a while,
    /// nothing is found.
    pub fn find(name: &str, recording: &Recording) -> Self {
        Self::find_asked(name, recording, |_| true)
    }

    /// The same with those detectors alone whose effect is asked for: the others do not run, repair nothing and mask
    /// nothing.
    pub fn find_asked(name: &str, recording: &Recording, asked: impl Fn(&Effect) -> bool) -> Self {
        let found = if asked(&dropped_samples::EFFECT) {
            rows::find(name, recording)
        } else {
            rows::RowFaults { fault: None, spoilt: vec![false; recording.samples()], gaps_s: Vec::new() }
        };
        let (mut faults, clipped) = if asked(&clipping::EFFECT) {
            saturation::find(name, recording, &found.spoilt)
        } else {
            (Vec::new(), vec![vec![false; recording.samples()]; recording.joints()])
        };
        faults.extend(found.fault);
        faults.sort_by(|a, b| a.log10_probability.total_cmp(&b.log10_probability));
        Self { faults, clipped, spoilt: found.spoilt, gaps_s: found.gaps_s }
    }

    /// The recording without the samples whose values are not those of their stamp; `None` if there are none. It
    /// is to be preprocessed in the place of the original: positions are then interpolated between true samples.
    pub fn repaired(&self, recording: &Recording) -> Option<Recording> {
        without(recording, &self.spoilt)
    }

    /// Which filtered rows of each joint a fault has touched, `[joint][row]`, to be left out of fits: rows within
    /// the reach of the parallel filter (`cutoff_hz`, that of
    /// [`parallel_filter`](aurt_recording::Segment::parallel_filter)) of a clipped measurement or of a gap too long
    /// to be bridged. `recording` is the original one, `rows` those of the repaired one.
    pub fn faulty_rows(&self, recording: &Recording, rows: &RecordingRows, cutoff_hz: f64) -> Vec<Vec<bool>> {
        let reach_s = REACH_PERIODS / cutoff_hz;
        let bridged_s = BRIDGED_PERIODS / cutoff_hz;
        let spoilt = stretches(&recording.time_s, &self.spoilt, 0.0);
        let long = |span: &&[f64; 2]| span[1] - span[0] > bridged_s;
        let common: Vec<[f64; 2]> = self.gaps_s.iter().chain(&spoilt).filter(long).copied().collect();
        (0..rows.joints.len())
            .map(|joint| {
                let clipped = self.clipped.get(joint).map(Vec::as_slice).unwrap_or_default();
                let mut spans = stretches(&recording.time_s, clipped, 0.0);
                spans.extend(&common);
                spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
                touched(&rows.time_s, &spans, reach_s)
            })
            .collect()
    }
}

/// A recording without rows that are held or corrupt; `None` if there are none. Samples with the same stamp are left to
/// preprocessing, which merges them.
pub fn without_unusable_rows(recording: &Recording) -> Option<Recording> {
    without(recording, &rows::unusable(recording))
}

fn without(recording: &Recording, bad: &[bool]) -> Option<Recording> {
    if !bad.contains(&true) {
        return None;
    }
    let keep = |series: &[f64]| -> Vec<f64> {
        series.iter().zip(bad).filter(|(_, bad)| !**bad).map(|(v, _)| *v).collect()
    };
    let family = |family: &Vec<Vec<f64>>| -> Vec<Vec<f64>> { family.iter().map(|s| keep(s)).collect() };
    Some(Recording {
        file: recording.file.clone(),
        time_s: keep(&recording.time_s),
        position_rad: family(&recording.position_rad),
        velocity_rad_s: recording.velocity_rad_s.as_ref().map(family),
        measurement: recording.measurement.as_ref().map(family),
        unit: recording.unit,
        joints: recording.joints.clone(),
        report: recording.report.clone(),
    })
}

/// The zero-phase low-pass answers an impulse within about this share of a period of its cut-off on either side.
const REACH_PERIODS: f64 = 0.5;

/// Gaps shorter than this share of a period of the cut-off are bridged by interpolation: what lies below the
/// cut-off cannot turn within them.
const BRIDGED_PERIODS: f64 = 0.5;

/// Runs of marked samples as spans of time, joined where less than `join_s` apart.
fn stretches(time_s: &[f64], marked: &[bool], join_s: f64) -> Vec<[f64; 2]> {
    let mut spans: Vec<[f64; 2]> = Vec::new();
    let mut follows = false;
    for (t, marked) in time_s.iter().zip(marked) {
        if *marked {
            match spans.last_mut() {
                Some(last) if follows || t - last[1] <= join_s => last[1] = *t,
                _ => spans.push([*t, *t]),
            }
        }
        follows = *marked;
    }
    spans
}

/// Which of the ascending `times` lie within `reach_s` of a span; `spans` ascend by their start.
fn touched(times: &[f64], spans: &[[f64; 2]], reach_s: f64) -> Vec<bool> {
    let mut marked = vec![false; times.len()];
    for [from, to] in spans {
        let first = times.partition_point(|t| *t < from - reach_s);
        let end = times.partition_point(|t| *t <= to + reach_s);
        marked[first..end.max(first)].fill(true);
    }
    marked
}

/// The windows of some samples in s from the first stamp, those less than `JOIN_S` apart joined.
fn windows_s(time_s: &[f64], marked: &[bool]) -> Vec<[f64; 2]> {
    let origin = time_s.first().copied().unwrap_or(0.0);
    let spans = stretches(time_s, marked, JOIN_S);
    spans.into_iter().map(|[from, to]| [from - origin, to - origin]).collect()
}

/// Windows less than this apart are reported as one, s.
const JOIN_S: f64 = 0.1;

/// Smallest distance of different values of a series that is more than rounding: its resolution. Zero for a
/// series of one value.
fn resolution(series: &[f64]) -> f64 {
    let mut sorted = series.to_vec();
    sorted.sort_by(f64::total_cmp);
    let range = sorted.last().copied().unwrap_or(0.0) - sorted.first().copied().unwrap_or(0.0);
    let steps = sorted.windows(2).map(|w| w[1] - w[0]).filter(|d| *d > 1e-9 * range);
    let smallest = steps.fold(f64::INFINITY, f64::min);
    if smallest.is_finite() { smallest } else { 0.0 }
}

/// Decimal logarithm of the probability that a Poisson variable of the mean `mean` is at least `count`, bounded
/// by its leading term and the ratio of the terms that follow.
fn log10_poisson_tail(mean: f64, count: usize) -> f64 {
    let n = count as f64;
    if n <= mean {
        return 0.0;
    }
    let log_factorial: f64 = (2..=count).map(|k| (k as f64).ln()).sum();
    let leading = n * mean.max(f64::MIN_POSITIVE).ln() - mean - log_factorial;
    let rest = -(1.0 - mean / (n + 1.0)).ln();
    ((leading + rest) / std::f64::consts::LN_10).clamp(CERTAIN, 0.0)
}
