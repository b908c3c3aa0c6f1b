use std::ops::Range;

use serde::Serialize;

use crate::error::RecordingError;
use crate::noise::median;
use crate::preprocess::options::PreprocessOptions;
use crate::recording::Recording;

/// Share of a period by which stamps may lie off a uniform grid and still count as uniform.
pub(crate) const UNIFORM_TOLERANCE: f64 = 0.02;

/// Sampling rates that recorders are commonly set to, within one decade.
const COMMON_RATES: [f64; 13] = [1.0, 1.2, 1.25, 1.5, 2.0, 2.4, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];

/// How far (as a ratio) the median rate may lie from a common rate to be taken for it.
const COMMON_TOLERANCE: f64 = 0.05;

/// Grid samples per recorded sample beyond which a grid is refused.
const FINEST_GRID: f64 = 100.0;

/// The time stamps of a recording, judged.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClockReport {
    /// Whether the stamps lie on a uniform grid (to 2 % of a period), apart from gaps that split the recording.
    pub uniform: bool,
    /// Median distance of stamps, in s.
    pub median_period_s: f64,
    /// Shortest distance of different stamps, in s.
    pub min_period_s: f64,
    /// Longest distance of stamps that does not split the recording, in s.
    pub max_period_s: f64,
    /// Samples with the stamp of the one before (or less than 5 % of a period after it) and the same values; merged.
    pub repeated: usize,
    /// Samples with the stamp of the one before (or less than 5 % of a period after it) and other values; averaged.
    pub conflicting: usize,
    /// Share of the grid's samples that the recording has no sample near to (within half a period).
    pub missing_share: f64,
    /// Gaps that split the recording: start and length, in s from the first stamp.
    pub gaps_s: Vec<[f64; 2]>,
}

/// What the stamps say: a rate, whether the samples are on its grid, and runs without gaps.
pub(crate) struct Clock {
    pub(crate) report: ClockReport,
    pub(crate) rate_hz: f64,
    /// Whether samples must be interpolated onto a grid of `rate_hz`.
    pub(crate) resample: bool,
    pub(crate) max_gap_s: f64,
    /// Sample ranges between gaps.
    pub(crate) runs: Vec<Range<usize>>,
}

impl Clock {
    /// Judges the strictly increasing stamps of `recording`; `merged` counts what was merged before.
    ///
    /// The rate of a uniform clock is 1/mean distance of stamps to nine digits (the mean is the most frequent distance
    /// but for the rounding of the stamps). For any other clock the rate is 1/median distance, taken to the nearest common rate
    /// within 5 % and otherwise rounded to three digits.
    pub(crate) fn judge(
        recording: &Recording,
        options: &PreprocessOptions,
        (repeated, conflicting): (usize, usize),
    ) -> Result<Self, RecordingError> {
        let time = &recording.time_s;
        if time.len() < 2 {
            return Err(RecordingError::TooShort {
                path: recording.file.clone(),
                samples: time.len(),
                needed: 2,
                after: " with stamps of their own",
                remedy: "a recording needs time stamps that increase".into(),
            });
        }
        let mut distances: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
        let median = median(&mut distances);
        let max_gap_s = options.max_gap_s.unwrap_or((10.0 * median).max(0.1));
        let mut runs = Vec::new();
        let mut gaps_s = Vec::new();
        let mut start = 0;
        let (mut shortest, mut longest) = (f64::INFINITY, 0.0_f64);
        for (k, w) in time.windows(2).enumerate() {
            let distance = w[1] - w[0];
            shortest = shortest.min(distance);
            if distance > max_gap_s || recording.report.set_back_s.contains(&w[1]) {
                gaps_s.push([w[0] - time[0], distance]);
                runs.push(start..k + 1);
                start = k + 1;
            } else {
                longest = longest.max(distance);
            }
        }
        runs.push(start..time.len());
        let own = uniform_period(time, &runs);
        let (rate_hz, resample) = match (own, options.sample_rate_hz) {
            (Some(period), Some(rate)) if (period * rate - 1.0).abs() < 1e-6 => (rate, false),
            (_, Some(rate)) => (rate, true),
            (Some(period), None) => (to_digits(1.0 / period, 9), false),
            (None, None) => (common_rate(1.0 / median), true),
        };
        if !(rate_hz.is_finite() && rate_hz > 0.0) {
            return Err(RecordingError::clock(
                &recording.file,
                format!("the time stamps give no sampling rate (median distance {median} s)"),
                "check that the time column is in seconds, or set sample_rate_hz",
            ));
        }
        let grid: f64 = runs.iter().map(|r| (time[r.end - 1] - time[r.start]) * rate_hz).sum();
        if resample && grid > FINEST_GRID * (time.len() as f64 + 10.0) {
            return Err(RecordingError::clock(
                &recording.file,
                format!(
                    "a grid of {rate_hz} Hz would have {grid:.0} samples for {} recorded ones",
                    time.len()
                ),
                "the stamps are too irregular, or not in seconds: correct them, or set a lower sample_rate_hz",
            ));
        }
        let missing_share = missing_share(time, &runs, rate_hz);
        let report = ClockReport {
            uniform: own.is_some(),
            median_period_s: median,
            min_period_s: shortest,
            max_period_s: longest,
            repeated,
            conflicting,
            missing_share,
            gaps_s,
        };
        Ok(Self { report, rate_hz, resample, max_gap_s, runs })
    }
}

/// The common period of all runs if every stamp lies within tolerance of its run's grid.
fn uniform_period(time: &[f64], runs: &[Range<usize>]) -> Option<f64> {
    let (mut duration, mut steps) = (0.0, 0);
    for run in runs {
        duration += time[run.end - 1] - time[run.start];
        steps += run.len() - 1;
    }
    if steps == 0 {
        return None;
    }
    let period = duration / steps as f64;
    let on_grid = runs.iter().all(|run| {
        let origin = time[run.start];
        // The grid's offset is free: half the range of the deviations counts.
        let (mut low, mut high) = (0.0_f64, 0.0_f64);
        for (k, t) in time[run.clone()].iter().enumerate() {
            let deviation = t - origin - k as f64 * period;
            low = low.min(deviation);
            high = high.max(deviation);
        }
        (high - low) / 2.0 <= UNIFORM_TOLERANCE * period
    });
    on_grid.then_some(period)
}

fn common_rate(rate_hz: f64) -> f64 {
    let decade = libm::pow(10.0, libm::log10(rate_hz).floor());
    let nearest = COMMON_RATES
        .iter()
        .map(|r| r * decade)
        .min_by(|a, b| libm::log(a / rate_hz).abs().total_cmp(&libm::log(b / rate_hz).abs()));
    match nearest {
        Some(common) if libm::log(common / rate_hz).abs() <= COMMON_TOLERANCE => common,
        _ => to_digits(rate_hz, 3),
    }
}

/// A positive number rounded to some decimal digits.
pub(crate) fn to_digits(value: f64, digits: i32) -> f64 {
    let shift = digits - 1 - libm::log10(value).floor() as i32;
    // Dividing by a power of ten that is exact gives the nearest double to the decimal number.
    let rounded = if shift >= 0 {
        (value * 10.0_f64.powi(shift)).round() / 10.0_f64.powi(shift)
    } else {
        (value / 10.0_f64.powi(-shift)).round() * 10.0_f64.powi(-shift)
    };
    if rounded.is_finite() { rounded } else { value }
}

/// Share of grid samples that no stamp is near to: a distance of about k periods hides k − 1 samples.
fn missing_share(time: &[f64], runs: &[Range<usize>], rate_hz: f64) -> f64 {
    let (mut grid, mut missing) = (0.0, 0.0);
    for run in runs {
        grid += (time[run.end - 1] - time[run.start]) * rate_hz + 1.0;
        missing += time[run.clone()]
            .windows(2)
            .map(|w| (((w[1] - w[0]) * rate_hz).round() - 1.0).max(0.0))
            .sum::<f64>();
    }
    if grid > 0.0 { missing / grid } else { 0.0 }
}
