//! Sample by sample, preprocessing is that of the paper's tool (`reference/make_reference.py`, `alignment`).

use std::f64::consts::PI;

use aurt_recording::{PreprocessOptions, Recording, Segment, preprocess};
use aurt_traits::MeasurementUnit;
use serde_json::Value;

use crate::filters::series;

/// A motion between two rests, as in `make_reference.py`.
fn position(samples: usize, rate_hz: f64, joint: usize) -> Vec<f64> {
    let (start, end) = (0.15 * samples as f64, 0.85 * samples as f64);
    let at = |k: usize| {
        let (k, j) = (k as f64, joint as f64);
        let inside = k > start && k < end;
        let window = if inside { (PI * (k - start) / (end - start)).sin().powi(2) } else { 0.0 };
        0.4 * window * (2.0 * PI * 1.5 * k / rate_hz + j).sin() + 0.1 * j
    };
    (0..samples).map(at).collect()
}

fn table(value: &Value) -> Vec<Vec<f64>> {
    let row = |v: &Value| v.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
    value.as_array().unwrap().iter().map(row).collect()
}

fn close(own: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(own.len(), expected.len());
    let scale = expected.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    for (own, expected) in own.iter().zip(expected) {
        assert!((own - expected).abs() <= tolerance * scale, "{own} {expected} (scale {scale})");
    }
}

fn every_seventh(values: &[f64]) -> Vec<f64> {
    values.iter().step_by(7).copied().collect()
}

#[test]
fn motion_and_measurement_equal_those_of_the_original_tool() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/reference/alignment.json");
    let cases: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    for case in cases.as_array().unwrap() {
        let count = |key: &str| case[key].as_u64().unwrap() as usize;
        let (samples, rate_hz) = (count("samples"), case["rate_hz"].as_f64().unwrap());
        let raw = vec![series(samples, 11), series(samples, 12)];
        let time_s = (0..samples).map(|k| 3.0 + k as f64 / rate_hz).collect();
        let positions = (0..2).map(|j| position(samples, rate_hz, j)).collect();
        let recording = Recording::from_arrays(time_s, positions).unwrap();
        let recording = recording.with_measurement(raw.clone(), MeasurementUnit::Ampere).unwrap();
        let options = PreprocessOptions {
            count_ends: true,
            ..PreprocessOptions::new(case["f_dyn_hz"].as_f64().unwrap())
        };
        let done = preprocess(&recording, &options).unwrap();
        let segment: &Segment = &done.segments[0];
        assert!(!done.report.resampled);
        assert_eq!(segment.decimation, count("decimation"));
        let (first, end) = (count("first"), count("end"));
        let motion = segment.motion.view();
        assert_eq!(motion.samples(), end - first);
        assert_eq!(motion.samples().div_ceil(segment.decimation), count("regressor_rows"));
        assert!((motion.time_s()[0] - recording.time_s[first + 1]).abs() < 1e-12);
        let measurement = segment.measurement.as_ref().unwrap();
        assert_eq!(segment.rows(), measurement[0].len());
        for joint in 0..2 {
            let expected = |key: &str| table(&case[key])[joint].clone();
            close(&every_seventh(motion.position_rad(joint)), &expected("position"), 1e-13);
            close(&every_seventh(motion.velocity_rad_s(joint)), &expected("velocity"), 1e-12);
            close(&every_seventh(motion.acceleration_rad_s2(joint)), &expected("acceleration"), 1e-10);
            close(&measurement[joint], &expected("measurement"), 1e-13);
            let unfiltered = &segment.raw_measurement.as_ref().unwrap()[joint];
            assert_eq!(*unfiltered, raw[joint][first + 1..end + 1]);
        }

        let whole = preprocess(&recording, &PreprocessOptions { trim_rest: false, ..options }).unwrap();
        let segment = &whole.segments[0];
        assert_eq!(segment.motion.samples(), samples - 2);
        for joint in 0..2 {
            let expected = table(&case["validation_measurement"])[joint].clone();
            close(&segment.measurement.as_ref().unwrap()[joint], &expected, 1e-13);
            assert_eq!(segment.raw_measurement.as_ref().unwrap()[joint], raw[joint][1..samples - 1]);
        }
    }
}
