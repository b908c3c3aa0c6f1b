use std::ops::Range;

use crate::error::RecordingError;
use crate::long::recording::LongRecording;
use crate::noise::median;
use crate::preprocess::PreprocessOptions;
use crate::preprocess::clock::{ClockReport, UNIFORM_TOLERANCE, to_digits};
use crate::preprocess::resample::SAME_STAMP;

/// Samples read at once; the median distance of stamps is that of the first ones.
const AT_ONCE: usize = 1 << 16;

/// A uniform clock: its rate and its runs without gaps.
pub(super) struct Uniform {
    pub(super) rate_hz: f64,
    pub(super) runs: Vec<Range<usize>>,
    /// First and last stamp of each run, s from the first of all.
    pub(super) spans_s: Vec<[f64; 2]>,
    pub(super) max_gap_s: f64,
    /// The median distance of stamps is that of the first ones.
    pub(super) report: ClockReport,
}

/// How far the stamps of a run lie off a grid.
struct Run {
    samples: Range<usize>,
    from_s: f64,
    to_s: f64,
    low_s: f64,
    high_s: f64,
}

impl Uniform {
    /// Judges the stamps of a recording as preprocessing of whole recordings does.
    pub(super) fn of(recording: &LongRecording, options: &PreprocessOptions) -> Result<Self, RecordingError> {
        let refused = |reason: String| {
            RecordingError::clock(
                &recording.file,
                match recording.report.dropped_rows {
                    0 => reason,
                    rows => format!("{reason} ({rows} corrupt rows were dropped, which leaves holes)"),
                },
                "recordings longer than memory need uniform stamps: resample it, or read it whole",
            )
        };
        let first = stamps(recording, 0..AT_ONCE.min(recording.samples()))?;
        let mut distances: Vec<f64> = first.windows(2).map(|w| w[1] - w[0]).collect();
        if distances.is_empty() {
            return Err(refused("there are fewer than two samples".into()));
        }
        let median_s = median(&mut distances);
        let max_gap_s = options.max_gap_s.unwrap_or((10.0 * median_s).max(0.1));
        let mut runs: Vec<Run> = Vec::new();
        let (mut shortest, mut longest) = (f64::INFINITY, 0.0_f64);
        for_each_stamp(recording, |k, t| {
            let distance = runs.last().map_or(f64::INFINITY, |run| t - run.to_s);
            shortest = shortest.min(distance);
            match runs.last_mut() {
                Some(run) if distance <= max_gap_s && !recording.report.set_back_s.contains(&t) => {
                    longest = longest.max(distance);
                    if distance <= SAME_STAMP * median_s {
                        return Err(refused(format!("samples {} and {k} have the same stamp {t} s", k - 1)));
                    }
                    run.to_s = t;
                    run.samples.end = k + 1;
                }
                _ => runs.push(Run { samples: k..k + 1, from_s: t, to_s: t, low_s: 0.0, high_s: 0.0 }),
            }
            Ok(())
        })?;
        let duration: f64 = runs.iter().map(|r| r.to_s - r.from_s).sum();
        let steps: usize = runs.iter().map(|r| r.samples.len() - 1).sum();
        let period_s = duration / steps.max(1) as f64;
        let mut of = 0;
        for_each_stamp(recording, |k, t| {
            while k >= runs[of].samples.end {
                of += 1;
            }
            let run = &mut runs[of];
            let deviation = t - run.from_s - (k - run.samples.start) as f64 * period_s;
            run.low_s = run.low_s.min(deviation);
            run.high_s = run.high_s.max(deviation);
            Ok(())
        })?;
        let widest = runs.iter().map(|r| (r.high_s - r.low_s) / 2.0).fold(0.0, f64::max);
        let own_rate = options.sample_rate_hz.is_none_or(|rate| (period_s * rate - 1.0).abs() < 1e-6);
        if widest > UNIFORM_TOLERANCE * period_s || !own_rate {
            return Err(refused(if own_rate {
                format!("stamps lie up to {widest:.3e} s off a grid of {period_s:.6} s")
            } else {
                format!("the recording's own rate is {:.6} Hz, another was asked for", 1.0 / period_s)
            }));
        }
        let rate_hz = options.sample_rate_hz.unwrap_or_else(|| to_digits(1.0 / period_s, 9));
        if !(rate_hz.is_finite() && rate_hz > 0.0) {
            return Err(refused("the time stamps give no sampling rate".into()));
        }
        let origin_s = runs.first().map_or(0.0, |r| r.from_s);
        let report = ClockReport {
            uniform: true,
            median_period_s: median_s,
            min_period_s: shortest,
            max_period_s: longest,
            repeated: 0,
            conflicting: 0,
            missing_share: 0.0,
            gaps_s: runs.windows(2).map(|r| [r[0].to_s - origin_s, r[1].from_s - r[0].to_s]).collect(),
        };
        let spans_s = runs.iter().map(|r| [r.from_s - origin_s, r.to_s - origin_s]).collect();
        Ok(Self { rate_hz, runs: runs.into_iter().map(|r| r.samples).collect(), spans_s, max_gap_s, report })
    }
}

fn stamps(recording: &LongRecording, samples: Range<usize>) -> Result<Vec<f64>, RecordingError> {
    let mut columns = recording.spill.read(samples).map_err(|source| recording.failed(source))?;
    Ok(columns.swap_remove(0))
}

fn for_each_stamp(
    recording: &LongRecording,
    mut visit: impl FnMut(usize, f64) -> Result<(), RecordingError>,
) -> Result<(), RecordingError> {
    for first in (0..recording.samples()).step_by(AT_ONCE) {
        let time = stamps(recording, first..(first + AT_ONCE).min(recording.samples()))?;
        (first..).zip(time).try_for_each(|(k, t)| visit(k, t))?;
    }
    Ok(())
}
