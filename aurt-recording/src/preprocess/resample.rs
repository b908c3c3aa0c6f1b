use std::borrow::Cow;

use crate::noise::median_step_s;
use crate::preprocess::spline::CubicSpline;
use crate::recording::Recording;

/// Share of the median distance of stamps below which two stamps are one: a curve through both samples would turn
/// the noise between them into a steep slope.
pub(crate) const SAME_STAMP: f64 = 0.05;

/// The recording with every stamp once: samples that share a stamp, or nearly so, become one, with the mean of their
/// values. Also how many samples repeated the one before, and how many contradicted it.
pub(crate) fn merge_repeated(recording: &Recording) -> (Cow<'_, Recording>, (usize, usize)) {
    let time = &recording.time_s;
    let same_s = median_step_s(time).map_or(0.0, |step_s| SAME_STAMP * step_s);
    let mut first_of = Vec::with_capacity(time.len());
    for (k, stamp) in time.iter().enumerate() {
        if first_of.last().is_none_or(|first: &usize| stamp - time[*first] > same_s) {
            first_of.push(k);
        }
    }
    if first_of.len() == time.len() {
        return (Cow::Borrowed(recording), (0, 0));
    }
    let ends: Vec<usize> = first_of.iter().skip(1).copied().chain([time.len()]).collect();
    let series: Vec<&Vec<f64>> = recording.families().flatten().collect();
    let (mut repeated, mut conflicting) = (0, 0);
    for (first, end) in first_of.iter().zip(&ends) {
        for k in first + 1..*end {
            if series.iter().all(|s| s[k] == s[k - 1]) {
                repeated += 1;
            } else {
                conflicting += 1;
            }
        }
    }
    let mean = |series: &[f64]| -> Vec<f64> {
        let of_group = |(first, end): (&usize, &usize)| {
            let base = series[*first];
            base + series[*first..*end].iter().map(|v| v - base).sum::<f64>() / (end - first) as f64
        };
        first_of.iter().zip(&ends).map(of_group).collect()
    };
    (Cow::Owned(recording.with_series(mean)), (repeated, conflicting))
}

/// The stamps of a uniform grid from `from_s` to `to_s`. The last one may lie past the end by rounding alone.
pub(crate) fn grid(from_s: f64, to_s: f64, rate_hz: f64) -> Vec<f64> {
    let steps = ((to_s - from_s) * rate_hz + 1e-6).floor().max(0.0) as usize;
    (0..=steps).map(|k| from_s + k as f64 / rate_hz).collect()
}

/// Values of a smooth series at `times`, by a cubic spline through the samples.
pub(crate) fn smooth(time: &[f64], values: &[f64], times: &[f64]) -> Vec<f64> {
    CubicSpline::new(time, values).sample(times)
}

/// Values of a noisy series at the increasing `times`, by straight lines between the samples; held at the ends.
pub(crate) fn linear(time: &[f64], values: &[f64], times: impl Iterator<Item = f64>) -> Vec<f64> {
    let last = time.len() - 1;
    let mut k = 0;
    times
        .map(|t| {
            while k + 1 < last && t >= time[k + 1] {
                k += 1;
            }
            if last == 0 || t <= time[k] {
                return values[k];
            }
            if t >= time[k + 1] {
                return values[k + 1];
            }
            let share = (t - time[k]) / (time[k + 1] - time[k]);
            values[k] + share * (values[k + 1] - values[k])
        })
        .collect()
}
