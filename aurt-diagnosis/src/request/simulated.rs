//! Predictions of another simulator as the baseline.

use crate::recordings::rows::RecordingRows;
use crate::request::QuestionedRecording;

/// What a simulator's prediction leaves of a joint's rows. The prediction passes the same filter as the
/// measurement did, without the samples that are left out of it.
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
        let mut on_grid: Vec<f64> = grid.iter().map(|t| interpolate(time, series, *t)).collect();
        segment.silence(joint, 0, &mut on_grid);
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

#[cfg(test)]
mod tests {
    use aurt_recording::{PreprocessOptions, ReadReport, RecordedJoints, Recording};
    use aurt_traits::MeasurementUnit;

    use super::rows_left;
    use crate::recordings::rows::{JointRows, RecordingRows, Role};
    use crate::request::QuestionedRecording;

    /// Around reversals samples are left out of both.
    #[test]
    fn a_simulator_that_is_right_leaves_nothing() {
        let time_s: Vec<f64> = (0..4000).map(|k| f64::from(k) * 0.002).collect();
        let position: Vec<f64> = time_s.iter().map(|t| libm::sin(3.0 * t)).collect();
        let torque: Vec<f64> = time_s.iter().map(|t| 5.0 + 4.0 * libm::cos(3.0 * t).signum()).collect();
        let raw = Recording {
            file: "a.csv".into(),
            time_s,
            position_rad: vec![position],
            velocity_rad_s: None,
            measurement: Some(vec![torque.clone()]),
            unit: MeasurementUnit::NewtonMetre,
            joints: RecordedJoints::Unnamed,
            report: ReadReport::default(),
        };
        let options = PreprocessOptions::new(5.0);
        let read = QuestionedRecording::new(Role::Calibration, "a.csv".into(), raw, options).unwrap();
        let recording = read.repaired(&[]).unwrap();
        let segments = &recording.data.data.segments;
        assert!(segments[0].left_out.as_ref().is_some_and(|joints| joints[0].contains(&true)));
        let measurement: Vec<f64> =
            segments.iter().flat_map(|s| s.measurement.as_ref().unwrap()[0].clone()).collect();
        let rows = RecordingRows {
            name: "a.csv".into(),
            role: Role::Calibration,
            rate_hz: 1.0,
            time_s: vec![0.0; measurement.len()],
            segment_starts: vec![0, measurement.len()],
            joints: vec![JointRows { measurement, ..JointRows::default() }],
        };
        let left = rows_left(&recording, &rows, &[torque], 0);
        let most = left.iter().fold(0.0_f64, |most, r| most.max(r.abs()));
        assert!(!left.is_empty() && most < 1e-3, "{most}");
    }
}
