//! Weights by row: impacts do not count, and without impacts estimates are those of least squares.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../examples/known_robot/mod.rs"]
mod known_robot;

use aurt_calibration::{Calibration, CalibrationOptions, Estimator, NamedRecording, calibrate};
use aurt_recording::Recording;
use aurt_traits::MeasurementUnit;
use known_robot::{F_DYN_HZ, KnownRobot, NOISE_NM, Noise, RATE_HZ, measured};

const DURATION_S: f64 = 30.0;

fn fit(robot: &KnownRobot, recording: &NamedRecording, estimator: Estimator) -> Calibration {
    let options = CalibrationOptions { estimator, ..CalibrationOptions::default() };
    let unit = MeasurementUnit::NewtonMetre;
    calibrate(&robot.model, std::slice::from_ref(recording), unit, F_DYN_HZ, &options).unwrap()
}

/// Six knocks of 50 ms, one per cent of the rows, each of 60 deviations of the noise at every joint.
fn with_knocks(mut clean: Recording) -> Recording {
    for (series, noise_nm) in clean.measurement.as_mut().unwrap().iter_mut().zip(NOISE_NM) {
        for knock in 0..6 {
            let start = ((2.3 + 4.1 * f64::from(knock)) * RATE_HZ) as usize;
            let force_nm = if knock % 3 == 0 { -60.0 } else { 60.0 } * noise_nm;
            series[start..start + (0.05 * RATE_HZ) as usize].iter_mut().for_each(|y| *y += force_nm);
        }
    }
    clean
}

/// Root of the mean squared error, in the deviations that least squares has without knocks.
fn error(robot: &KnownRobot, found: &Calibration, quiet: &Calibration) -> f64 {
    let squares = found.parameters.iter().zip(&robot.truth).zip(&quiet.parameters);
    let squares: Vec<f64> =
        squares.map(|((p, truth), quiet)| ((p.value - truth) / quiet.std_dev.unwrap()).powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

fn held(robot: &KnownRobot, found: &Calibration) -> (usize, usize) {
    let inside = found.parameters.iter().zip(&robot.truth).filter(|(p, truth)| {
        let [low, high] = p.interval_95.unwrap();
        (low..=high).contains(truth)
    });
    (inside.count(), found.parameters.len())
}

#[test]
fn knocks_in_one_per_cent_of_the_rows_do_not_count() {
    let mut robot = KnownRobot::new(None);
    let clean = robot.clean(0, DURATION_S);
    let knocked = with_knocks(clean.clone());
    let (mut inside, mut all) = (0, 0);
    for seed in 1..=10 {
        let of = |r: &Recording| measured(r, "knocks", seed, Noise::White, 1.0, None);
        let quiet = fit(&robot, &of(&clean), Estimator::Wls);
        let [plain, robust] =
            [Estimator::Wls, Estimator::Irls].map(|estimator| fit(&robot, &of(&knocked), estimator));
        let [plain_error, robust_error] = [&plain, &robust].map(|found| error(&robot, found, &quiet));
        assert!(robust_error < 1.6 && plain_error > 2.0 * robust_error, "{plain_error} {robust_error}");
        let rejected = &robust.robust.as_ref().unwrap().rejected;
        assert!(rejected.iter().all(|share| (0.005..0.1).contains(share)), "{rejected:?}");
        let (held, of) = held(&robot, &robust);
        inside += held;
        all += of;
    }
    let share = inside as f64 / all as f64;
    assert!((0.9..0.995).contains(&share), "{share}");
}

#[test]
fn without_impacts_it_is_about_least_squares() {
    let mut robot = KnownRobot::new(None);
    let clean = robot.clean(1, DURATION_S);
    for seed in 1..=4 {
        let noise = if seed < 3 { Noise::White } else { Noise::GaussMarkov { time_s: 0.1 } };
        let recording = measured(&clean, "quiet", seed, noise, 1.0, None);
        let [plain, robust] =
            [Estimator::Wls, Estimator::Irls].map(|estimator| fit(&robot, &recording, estimator));
        for (a, b) in plain.parameters.iter().zip(&robust.parameters) {
            let a_std = a.std_dev.unwrap();
            assert!((a.value - b.value).abs() < 1.5 * a_std, "{}: {} {}", a.name, a.value, b.value);
        }
        let longer = plain.parameters.iter().zip(&robust.parameters);
        let longer = longer.map(|(a, b)| b.std_dev.unwrap() / a.std_dev.unwrap()).sum::<f64>();
        let mean = longer / plain.parameters.len() as f64;
        assert!((0.8..1.35).contains(&mean), "{mean}");
        for (found, true_sigma) in robust.sigma.iter().zip(&plain.sigma) {
            assert!((found / true_sigma - 1.0).abs() < 0.15, "{found} {true_sigma}");
        }
    }
}
