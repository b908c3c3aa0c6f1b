//! Recordings longer than memory against the same recordings read whole.

use std::path::Path;

use aurt_recording::{
    LongPrepared, LongRecording, PreprocessOptions, ReadOptions, Recording, RecordingError, Segment,
    preprocess, read_recording,
};

/// Longer than a piece that is read and than two stretches, at rest at both ends, with a gap and a whole turn.
fn write(path: &Path, rows: usize, corrupt: bool) {
    let mut text = String::from("time,q_0,q_1,torque_0,torque_1\n");
    for k in 0..rows {
        let t = k as f64 * 0.002 + if k > 80_000 { 5.0 } else { 0.0 };
        let moving = (k > 700 && k + 900 < rows) as u8 as f64;
        let q = moving * (0.9 * t).sin() + if k > 40_000 { std::f64::consts::TAU } else { 0.0 };
        // A row that its neighbours contradict, and one that cannot be true at all.
        let leap = if corrupt && k == 65_536 { 2.0 } else { 0.0 };
        let torque = if corrupt && k == 1234 { 1e9 } else { 3.0 * (2.3 * t).cos() };
        let noise = ((k * k) % 101) as f64 * 1e-3;
        text.push_str(&format!(
            "{t:.3},{q:.6},{:.6},{torque:.4},{:.4}\n",
            moving * (1.1 * t).cos() + leap,
            noise
        ));
    }
    std::fs::write(path, text).unwrap();
}

fn options(trim_rest: bool) -> PreprocessOptions {
    PreprocessOptions {
        trim_rest,
        gains: Some(vec![2.0, 0.5]),
        offsets: Some(vec![0.1, 0.0]),
        ..PreprocessOptions::new(8.0)
    }
}

fn assert_equal(long: &LongPrepared, whole: &[Segment]) {
    assert_eq!(long.segments().len(), whole.len());
    for (segment, expected) in long.segments().iter().zip(whole) {
        assert_eq!((segment.samples(), segment.rows()), (expected.motion.samples(), expected.rows()));
        assert_eq!(long.decimation(), expected.decimation);
        let (mut next, mut row) = (0, 0);
        long.for_each_stretch::<RecordingError>(segment, |stretch| {
            let (ours, theirs) = (stretch.motion.view(), expected.motion.view());
            assert_eq!((stretch.first_sample, stretch.first_row), (next, row));
            for joint in 0..2 {
                let pairs = [
                    (ours.position_rad(joint), theirs.position_rad(joint), 1e-12),
                    // Differences of positions over 2 ms, once and twice.
                    (ours.velocity_rad_s(joint), theirs.velocity_rad_s(joint), 1e-12 / 0.002),
                    (
                        ours.acceleration_rad_s2(joint),
                        theirs.acceleration_rad_s2(joint),
                        4e-12 / 0.002 / 0.002,
                    ),
                ];
                for (a, b, tolerance) in pairs {
                    for (a, b) in a.iter().zip(&b[next..]) {
                        assert!((a - b).abs() <= tolerance, "{a} {b}");
                    }
                }
                let measured = &expected.measurement.as_ref().unwrap()[joint][row..];
                for (a, b) in stretch.measurement[joint].iter().zip(measured) {
                    assert!((a - b).abs() <= 1e-12 * 10.0, "{a} {b}");
                }
            }
            assert_eq!(ours.time_s(), &theirs.time_s()[next..next + ours.samples()]);
            next += ours.samples();
            row += stretch.measurement[0].len();
            Ok(())
        })
        .unwrap();
        assert_eq!((next, row), (segment.samples(), segment.rows()));
    }
}

#[test]
fn a_long_file_becomes_what_the_whole_one_does() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.csv");
    write(&path, 150_000, false);
    let whole = read_recording(&path, &ReadOptions::default()).unwrap();
    assert!(whole.report.remarks[0].contains("unwrapped"), "{:?}", whole.report.remarks);
    for trim_rest in [true, false] {
        let long = LongRecording::read(&path, &ReadOptions::default()).unwrap();
        assert_eq!(long.samples(), whole.samples());
        assert_eq!(long.report().rows, whole.report.rows);
        assert_eq!(long.report().columns, whole.report.columns);
        let expected = preprocess(&whole, &options(trim_rest)).unwrap();
        let prepared = long.prepare(&options(trim_rest)).unwrap();
        assert_equal(&prepared, &expected.segments);
        assert_eq!(prepared.report().notes(), expected.report.notes());
        for (ours, theirs) in prepared.report().segments.iter().zip(&expected.report.segments) {
            assert_eq!((ours.samples, ours.rows), (theirs.samples, theirs.rows));
            let times = [ours.from_s, ours.to_s, ours.cut_s[0], ours.cut_s[1]];
            let expected = [theirs.from_s, theirs.to_s, theirs.cut_s[0], theirs.cut_s[1]];
            for (a, b) in times.iter().zip(expected) {
                assert!((a - b).abs() < 1e-6, "{times:?} {expected:?}");
            }
        }
    }
}

/// Rows are dropped as they are of whole recordings, at the cut between two pieces too; what is left has holes, which
/// stretches cannot fill.
#[test]
fn corrupt_rows_are_dropped_alike() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.csv");
    write(&path, 70_000, true);
    let whole = read_recording(&path, &ReadOptions::default()).unwrap();
    assert_eq!(whole.report.dropped_rows, 2);
    let long = LongRecording::read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(long.samples(), whole.samples());
    let error = long.prepare(&options(true)).unwrap_err().to_string();
    assert!(error.contains("off a grid") && error.contains("2 corrupt rows were dropped"), "{error}");
}

fn recording(samples: usize) -> Recording {
    let time_s: Vec<f64> =
        (0..samples).map(|k| 0.002 * k as f64 + if k > 60_000 { 4.0 } else { 0.0 }).collect();
    let moving = |k: usize| f64::from(u8::from(k > 700 && k + 900 < samples));
    let series =
        |f: &dyn Fn(usize, f64) -> f64| time_s.iter().enumerate().map(|(k, t)| f(k, *t)).collect::<Vec<_>>();
    let position =
        vec![series(&|k, t| moving(k) * (0.9 * t).sin()), series(&|k, t| moving(k) * (1.7 * t).cos())];
    let current = vec![series(&|k, t| (2.3 * t).cos() + (k % 7) as f64), series(&|k, _| (k % 11) as f64)];
    let recording = Recording::from_arrays(time_s, position).unwrap();
    recording.with_measurement(current, aurt_traits::MeasurementUnit::Ampere).unwrap()
}

#[test]
fn stretches_overlap_enough() {
    let whole = recording(110_000);
    for trim_rest in [true, false] {
        let mut long = LongRecording::new("long".into(), 2, true, whole.unit).unwrap();
        for first in (0..whole.samples()).step_by(33_333) {
            let end = (first + 33_333).min(whole.samples());
            long.push(&whole.rows(first..end)).unwrap();
        }
        let expected = preprocess(&whole, &options(trim_rest)).unwrap();
        assert_eq!(expected.segments.len(), 2);
        assert_equal(&long.prepare(&options(trim_rest)).unwrap(), &expected.segments);
    }
}

#[test]
fn what_stretches_cannot_do_is_refused() {
    let whole = recording(5000);
    let long = |change: &dyn Fn(&mut Recording)| {
        let mut recording = whole.clone();
        change(&mut recording);
        let mut long = LongRecording::new("long".into(), 2, true, whole.unit).unwrap();
        long.push(&recording).unwrap();
        long
    };
    let refused = |long: LongRecording, options: &PreprocessOptions, words: &str| {
        let error = long.prepare(options).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    };
    refused(long(&|r| r.time_s[700] += 5e-4), &options(true), "off a grid");
    refused(long(&|r| r.time_s[701] = r.time_s[700]), &options(true), "same stamp");
    refused(
        long(&|_| {}),
        &PreprocessOptions { sample_rate_hz: Some(400.0), ..options(true) },
        "another was asked for",
    );
    let delayed = PreprocessOptions { delay_s: Some(vec![0.004, 0.0]), ..options(true) };
    refused(long(&|_| {}), &delayed, "read whole");
    let mut wrong = long(&|_| {});
    assert!(matches!(wrong.push(&whole), Err(RecordingError::Clock { .. })));
    wrong = LongRecording::new("long".into(), 3, true, whole.unit).unwrap();
    assert!(matches!(wrong.push(&whole), Err(RecordingError::Count { .. })));
}
