//! Predictions of another simulator as the baseline.

use crate::recordings::rows::RecordingRows;
use crate::request::QuestionedRecording;

/// What a simulator's prediction leaves of a joint's rows. The prediction passes the same filter as the
/// measurement did.
pub(crate) fn rows_left(
    recording: &QuestionedRecording,
    rows: &RecordingRows,
    simulated: &[Vec<f64>],
    joint: usize,
) -> Vec<f64> {
    let measured = &rows.joints[joint].measurement;
    let (time, series) = (&recording.raw.time_s, &simulated[joint]);
    let mut left = Vec::with_capacity(measured.len());
    let mut first = 0;
    for segment in &recording.data.data.segments {
        let grid = segment.motion.view().time_s();
        let on_grid: Vec<f64> = grid.iter().map(|t| interpolate(time, series, *t)).collect();
        let filtered = segment.parallel_filter.filter(&on_grid).unwrap_or(on_grid);
        left.extend(measured[first..].iter().zip(segment.at_rows(&filtered)).map(|(y, s)| y - s));
        first += segment.rows();
    }
    left
}

/// Linear interpolation of a series over ascending times.
fn interpolate(time: &[f64], series: &[f64], t: f64) -> f64 {
    let after = time.partition_point(|x| *x < t).clamp(1, time.len().max(2) - 1);
    let (a, b) = (after - 1, after);
    let span = time[b] - time[a];
    if span <= 0.0 {
        return series[b];
    }
    let share = ((t - time[a]) / span).clamp(0.0, 1.0);
    series[a] + share * (series[b] - series[a])
}
