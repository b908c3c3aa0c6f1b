//! Clocks as recorders have them: jitter, repeats, gaps, drop-outs, delays.

use std::f64::consts::TAU;
use std::path::PathBuf;

use aurt_recording::{
    PreprocessOptions, Preprocessed, ReadReport, Recording, RecordingError, ZeroPhase, preprocess,
};
use aurt_traits::MeasurementUnit;
use proptest::prelude::*;

/// Angle and measurement of joint j at time t: two slow sines, so that every method of interpolation is close.
fn truth(joint: usize, t: f64) -> (f64, f64) {
    let phase = joint as f64;
    ((TAU * 0.4 * t + phase).sin(), 3.0 * (TAU * 0.3 * t + phase).cos())
}

fn sampled(time_s: Vec<f64>) -> Recording {
    let of = |pick: fn((f64, f64)) -> f64| {
        (0..2).map(|j| time_s.iter().map(|t| pick(truth(j, *t))).collect()).collect()
    };
    Recording {
        file: PathBuf::from("made.csv"),
        position_rad: of(|v| v.0),
        velocity_rad_s: None,
        measurement: Some(of(|v| v.1)),
        unit: MeasurementUnit::NewtonMetre,
        joints: aurt_recording::RecordedJoints::Unnamed,
        report: ReadReport::default(),
        time_s,
    }
}

fn uniform(samples: usize, rate_hz: f64) -> Vec<f64> {
    (0..samples).map(|k| k as f64 / rate_hz).collect()
}

fn refused(recording: &Recording, options: &PreprocessOptions) -> RecordingError {
    match preprocess(recording, options) {
        Ok(done) => panic!("accepted: {:?}", done.report),
        Err(error) => error,
    }
}

/// Compares a segment with the truth, up to its ends.
fn close_to_truth(done: &Preprocessed, tolerance: f64) {
    for segment in &done.segments {
        let motion = segment.motion.view();
        for joint in 0..2 {
            let raw = &segment.raw_measurement.as_ref().unwrap()[joint];
            for k in 0..motion.samples() {
                let t = motion.time_s()[k];
                let (position, measured) = truth(joint, t);
                assert!((motion.position_rad(joint)[k] - position).abs() < tolerance, "position at {t}");
                assert!((raw[k] - measured).abs() < tolerance, "measurement at {t}");
            }
            for (row, y) in segment.measurement.as_ref().unwrap()[joint].iter().enumerate() {
                let (_, measured) = truth(joint, motion.time_s()[segment.sample(row)]);
                assert!((y - measured).abs() < tolerance, "row {row}");
            }
        }
    }
}

#[test]
fn alternating_stamps_are_resampled_at_the_rate_behind_them() {
    // A robot's 2 ms ticks, of which every fifth or sixth is recorded.
    let time_s = (0..2000).scan(0.0, |t, k| {
        let now = *t;
        *t += if k % 3 == 2 { 0.012 } else { 0.01 };
        Some(now)
    });
    let recording = sampled(time_s.collect());
    let done = preprocess(&recording, &PreprocessOptions::new(2.5)).unwrap();
    assert!(done.report.resampled && !done.report.clock.uniform);
    assert_eq!(done.report.rate_hz, 100.0);
    assert_eq!(done.report.decimation.factor, 8);
    assert_eq!(done.report.clock.missing_share, 0.0);
    close_to_truth(&done, 2e-3);

    let finer = PreprocessOptions { sample_rate_hz: Some(250.0), ..PreprocessOptions::new(2.5) };
    let done = preprocess(&recording, &finer).unwrap();
    assert_eq!((done.report.rate_hz, done.segments[0].decimation), (250.0, 20));
    close_to_truth(&done, 2e-3);
}

#[test]
fn rounded_stamps_of_a_uniform_clock_are_used_as_they_are() {
    for (rate_hz, digits) in [(500.0, 3), (300.0, 4), (1000.0, 4), (125.0, 3), (64.0, 4), (333.0, 5)] {
        let scale = 10.0_f64.powi(digits);
        let time_s = uniform(3000, rate_hz).iter().map(|t| 1e4 + (t * scale).round() / scale).collect();
        let done = preprocess(&sampled(time_s), &PreprocessOptions::new(2.0)).unwrap();
        assert!(done.report.clock.uniform && !done.report.resampled, "{rate_hz} Hz with {digits} digits");
        assert!((done.report.rate_hz / rate_hz - 1.0).abs() < 1e-4, "{}", done.report.rate_hz);
    }
}

#[test]
fn missing_samples_are_filled_in_and_counted() {
    let time_s: Vec<f64> =
        uniform(4000, 200.0).into_iter().enumerate().filter(|(k, _)| k % 50 != 7).map(|(_, t)| t).collect();
    let done = preprocess(&sampled(time_s), &PreprocessOptions::new(4.0)).unwrap();
    assert!(done.report.resampled);
    assert_eq!(done.report.rate_hz, 200.0);
    assert!((done.report.clock.missing_share - 0.02).abs() < 1e-3);
    assert_eq!(done.segments.len(), 1);
    close_to_truth(&done, 2e-3);
}

#[test]
fn gaps_split_and_short_stretches_are_dropped() {
    // 0–8 s, a gap, 20 samples, a gap, 12–20 s, all on one grid.
    let kept = |t: &f64| *t < 8.0 || (9.0..9.1).contains(t) || *t > 12.0;
    let time_s: Vec<f64> = uniform(4000, 200.0).into_iter().filter(kept).collect();
    let recording = sampled(time_s);
    let done = preprocess(&recording, &PreprocessOptions::new(4.0)).unwrap();
    let report = &done.report;
    assert!(!report.resampled, "each stretch is uniform");
    assert_eq!(report.clock.gaps_s.len(), 2);
    assert_eq!((done.segments.len(), report.dropped_segments.len()), (2, 1), "{report:?}");
    assert!((report.dropped_segments[0].from_s - 9.0).abs() < 1e-9);
    close_to_truth(&done, 2e-3);
    let notes = report.notes().join("\n");
    assert!(notes.contains("2 gaps longer than 0.1 s") && notes.contains("is not used"), "{notes}");

    let options = PreprocessOptions { max_gap_s: Some(20.0), ..PreprocessOptions::new(4.0) };
    let whole = preprocess(&recording, &options).unwrap();
    assert!(whole.report.resampled);
    assert_eq!(whole.segments.len(), 1);
}

#[test]
fn repeated_stamps_are_merged() {
    let mut time_s = uniform(2000, 100.0);
    for k in (100..2000).step_by(100) {
        time_s[k] = time_s[k - 1];
    }
    let mut recording = sampled(time_s);
    // Every second repetition contradicts the sample before.
    for k in (200..2000).step_by(200) {
        recording.measurement.as_mut().unwrap()[0][k] += 1e-3;
    }
    let done = preprocess(&recording, &PreprocessOptions::new(2.0)).unwrap();
    assert_eq!((done.report.clock.repeated, done.report.clock.conflicting), (10, 9));
    close_to_truth(&done, 2e-3);
    let notes = done.report.notes().join("\n");
    assert!(notes.contains("10 samples repeated") && notes.contains("9 samples carried"), "{notes}");
}

#[test]
fn nearly_repeated_stamps_do_not_become_steep_slopes() {
    let mut time_s = uniform(2000, 100.0);
    for k in (100..2000).step_by(100) {
        time_s[k] = time_s[k - 1] + 1e-6;
    }
    let mut recording = sampled(time_s);
    for k in (100..2000).step_by(100) {
        recording.position_rad[0][k] += 1e-4;
    }
    let done = preprocess(&recording, &PreprocessOptions::new(2.0)).unwrap();
    assert_eq!(done.report.clock.conflicting, 19);
    close_to_truth(&done, 2e-3);
}

#[test]
fn the_instrument_is_undone() {
    let rate_hz = 500.0;
    for jitter in [0.0, 0.2] {
        let time_s: Vec<f64> =
            (0..5000).map(|k| (k as f64 + jitter * (k as f64 * 1.7).sin()) / rate_hz).collect();
        let mut recording = sampled(time_s.clone());
        let (gains, offsets, delays) = (vec![2.0, -0.5], vec![0.3, -1.0], vec![0.013, 0.0]);
        let raw =
            |j: usize| time_s.iter().map(|t| truth(j, t - delays[j]).1 / gains[j] + offsets[j]).collect();
        recording.measurement = Some(vec![raw(0), raw(1)]);
        let options = PreprocessOptions {
            gains: Some(gains),
            offsets: Some(offsets),
            delay_s: Some(delays.clone()),
            ..PreprocessOptions::new(10.0)
        };
        let done = preprocess(&recording, &options).unwrap();
        assert_eq!(done.report.resampled, jitter > 0.0);
        close_to_truth(&done, 2e-3);
    }
}

#[test]
fn a_measured_velocity_in_degrees_is_noticed() {
    let mut recording = sampled(uniform(2000, 200.0));
    let velocity = |j: usize, factor: f64| {
        recording.time_s.iter().map(|t| factor * TAU * 0.4 * (TAU * 0.4 * t + j as f64).cos()).collect()
    };
    recording.velocity_rad_s = Some(vec![velocity(0, 1.0), velocity(1, 57.3)]);
    let done = preprocess(&recording, &PreprocessOptions::new(5.0)).unwrap();
    let [good, bad] = [done.report.velocity_scale[0].unwrap(), done.report.velocity_scale[1].unwrap()];
    assert!((good - 1.0).abs() < 1e-2 && (bad - 57.3).abs() < 0.5, "{good} {bad}");
    assert!(done.report.notes().iter().any(|n| n.contains("joint 1")));
}

#[test]
fn cut_offs_are_held_against_the_nyquist_frequency() {
    let recording = sampled(uniform(2000, 100.0));
    let error = refused(&recording, &PreprocessOptions::new(10.0));
    let message = error.to_string();
    let RecordingError::AboveNyquist { largest_f_dyn_hz, .. } = error else { panic!("{message}") };
    assert!(message.contains("made.csv") && message.contains("f_dyn_hz can be at most 9.99;"), "{message}");
    assert!(message.contains("50 Hz is not below half the sampling rate (100 Hz / 2)"), "{message}");
    assert!(preprocess(&recording, &PreprocessOptions::new(largest_f_dyn_hz)).is_ok());
    assert!(preprocess(&recording, &PreprocessOptions::new(9.99)).is_ok());
    let set = PreprocessOptions { position_cutoff_hz: Some(20.0), ..PreprocessOptions::new(20.0) };
    assert!(preprocess(&recording, &set).is_ok());
    let set = PreprocessOptions { parallel_cutoff_hz: Some(50.0), ..PreprocessOptions::new(5.0) };
    let message = refused(&recording, &set).to_string();
    assert!(message.contains("parallel_cutoff_hz can be at most 49.9 Hz"), "{message}");
    let told = PreprocessOptions { parallel_cutoff_hz: Some(49.9), ..set };
    assert!(preprocess(&recording, &told).is_ok());
}

#[test]
fn options_out_of_range() {
    let recording = sampled(uniform(2000, 100.0));
    let base = PreprocessOptions::new(2.0);
    let bad = [
        PreprocessOptions::new(0.0),
        PreprocessOptions::new(-1.0),
        PreprocessOptions::new(f64::NAN),
        PreprocessOptions::new(f64::INFINITY),
        PreprocessOptions::new(1e-300),
        PreprocessOptions::new(1e-6),
        PreprocessOptions { sample_rate_hz: Some(0.0), ..base.clone() },
        PreprocessOptions { sample_rate_hz: Some(1e9), ..base.clone() },
        PreprocessOptions { position_cutoff_hz: Some(f64::NAN), ..base.clone() },
        PreprocessOptions { parallel_cutoff_hz: Some(1e-9), ..base.clone() },
        PreprocessOptions { max_gap_s: Some(-1.0), ..base.clone() },
        PreprocessOptions { max_gap_s: Some(1e-9), ..base.clone() },
        PreprocessOptions { rest_velocity_rad_s: f64::NAN, ..base.clone() },
        PreprocessOptions { rest_velocity_rad_s: 100.0, ..base.clone() },
        PreprocessOptions { gains: Some(vec![1.0]), ..base.clone() },
        PreprocessOptions { gains: Some(vec![1.0, 0.0]), ..base.clone() },
        PreprocessOptions { offsets: Some(vec![1.0; 3]), ..base.clone() },
        PreprocessOptions { delay_s: Some(vec![f64::NAN, 0.0]), ..base.clone() },
        PreprocessOptions { delay_s: Some(vec![1e9, 0.0]), ..base.clone() },
        PreprocessOptions { delay_s: Some(vec![-1e9, 1e9]), sample_rate_hz: Some(50.0), ..base },
    ];
    for options in bad {
        let error = refused(&recording, &options);
        println!("{error}");
    }
}

#[test]
fn recordings_that_cannot_be_used() {
    let options = PreprocessOptions::new(2.0);
    for samples in 0..18 {
        let error = refused(&sampled(uniform(samples, 100.0)), &options);
        assert!(matches!(error, RecordingError::TooShort { .. }), "{samples}: {error}");
    }
    // Trimmed data lose another two samples, and filters remember 0.84 s at either end.
    let whole = PreprocessOptions { count_ends: true, ..options.clone() };
    assert!(preprocess(&sampled(uniform(25, 100.0)), &whole).is_ok());
    assert!(matches!(refused(&sampled(uniform(165, 100.0)), &options), RecordingError::TooShort { .. }));

    let mut still = sampled(uniform(2000, 100.0));
    still.position_rad.iter_mut().flatten().for_each(|q| *q = 1.0);
    let error = refused(&still, &options);
    assert!(matches!(error, RecordingError::AtRest { .. }), "{error}");
    let validation = PreprocessOptions { trim_rest: false, ..options.clone() };
    // The position filter and the differences remember 24 samples at either end, and rows stay on the grid of the whole run.
    assert_eq!(preprocess(&still, &validation).unwrap().segments[0].motion.samples(), 1998 - 24 - 30);

    let mut backwards = sampled(uniform(100, 100.0));
    backwards.time_s[50] = 0.1;
    assert!(matches!(preprocess(&backwards, &options), Err(RecordingError::Clock { .. })));
    let mut poisoned = sampled(uniform(100, 100.0));
    poisoned.position_rad[1][3] = f64::NAN;
    assert!(matches!(preprocess(&poisoned, &options), Err(RecordingError::Sample { .. })));
    let mut ragged = sampled(uniform(100, 100.0));
    ragged.position_rad[1].pop();
    assert!(matches!(preprocess(&ragged, &options), Err(RecordingError::Count { .. })));
    let mut frozen = sampled(uniform(100, 100.0));
    frozen.time_s.fill(1.0);
    assert!(matches!(preprocess(&frozen, &options), Err(RecordingError::TooShort { .. })));
}

#[test]
fn filters_out_of_range() {
    for (order, cutoff_hz, rate_hz) in [
        (0, 1.0, 10.0),
        (13, 1.0, 10.0),
        (4, 5.0, 10.0),
        (4, 0.0, 10.0),
        (4, -1.0, 10.0),
        (4, f64::NAN, 10.0),
        (4, 1.0, f64::INFINITY),
        (4, 1e-6, 10.0),
    ] {
        assert!(ZeroPhase::butterworth(order, cutoff_hz, rate_hz).is_err(), "{order} {cutoff_hz} {rate_hz}");
    }
    let filter = ZeroPhase::butterworth(4, 1.0, 10.0).unwrap();
    assert!(matches!(filter.filter(&[0.0; 15]), Err(RecordingError::TooShortToFilter { needed: 16, .. })));
    assert!(filter.filter(&[0.0; 16]).is_ok());
    assert!(filter.filter(&[]).is_err());
    assert!(filter.filter_all(&[vec![0.0; 20], vec![0.0; 21]]).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn jitter_of_any_kind_gives_nearly_the_same_motion(
        jitter in 0.0_f64..0.45,
        seed in any::<u32>(),
        rate_hz in 80.0_f64..400.0,
        loss in 0.0_f64..0.05,
    ) {
        let mut state = u64::from(seed);
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let time_s: Vec<f64> = (0..1500)
            .filter_map(|k| {
                let stamp = (k as f64 + jitter * (2.0 * random() - 1.0)) / rate_hz;
                (random() > loss).then_some(stamp)
            })
            .collect();
        let recording = sampled(time_s);
        let options = PreprocessOptions { max_gap_s: Some(1.0), ..PreprocessOptions::new(3.0) };
        let done = preprocess(&recording, &options).unwrap();
        prop_assert!((done.report.rate_hz / rate_hz).ln().abs() < 0.12, "{} {rate_hz}", done.report.rate_hz);
        close_to_truth(&done, 3e-3);
    }

    #[test]
    fn arbitrary_clocks_never_panic(
        stamps in prop::collection::vec(prop_oneof![Just(0.0), -1e3_f64..1e3, Just(1e20), 0.0_f64..1e-9], 0..60),
        f_dyn_hz in prop_oneof![1e-6_f64..1e3, Just(1e-300), Just(1e300)],
        max_gap_s in prop::option::of(1e-9_f64..1e3),
    ) {
        let mut time_s = stamps;
        time_s.sort_by(f64::total_cmp);
        let options = PreprocessOptions { max_gap_s, ..PreprocessOptions::new(f_dyn_hz) };
        let _ = preprocess(&sampled(time_s), &options);
    }
}
