//! Time of the step from least squares to the nearest machine, on a UR10e:
//! `cargo bench -p aurt-calibration --bench consistent`.

#![expect(clippy::unwrap_used, reason = "a benchmark that cannot go on has nothing to say")]

#[path = "../examples/known_robot/mod.rs"]
#[expect(dead_code, reason = "examples share it, and each uses a part")]
mod known_robot;

use std::time::Instant;

use aurt_calibration::{CalibrationOptions, Estimator, Fit, accumulate, calibrate, make_consistent};
use aurt_traits::MeasurementUnit;
use known_robot::{F_DYN_HZ, KnownRobot, Noise, measured};

const REPEATS: u32 = 50;

fn main() {
    let mut robot = KnownRobot::new(None);
    for (name, noise, level) in [
        ("white noise", Noise::White, 1.0),
        ("with a memory", Noise::GaussMarkov { time_s: 0.1 }, 1.0),
        ("hardly any noise", Noise::White, 1e-3),
    ] {
        let recordings = [measured(&robot.clean(0, 20.0), "bench", 1, noise, level, None)];
        let options = CalibrationOptions { estimator: Estimator::Wls, ..CalibrationOptions::default() };
        let unit = MeasurementUnit::NewtonMetre;
        let found = calibrate(&robot.model, &recordings, unit, F_DYN_HZ, &options).unwrap();
        let system = accumulate(&robot.model, &recordings, &found.load, &options).unwrap();
        let weights: Vec<f64> = found.sigma.iter().map(|s| 1.0 / s).collect();
        let covariance = system.solve(&weights, |_| true).unwrap().covariance;
        let fit = Fit {
            model: &robot.model,
            system: &system,
            weights: &weights,
            coefficients: &found.coefficients(),
            covariance: &covariance,
            scale: 1.0,
            ranges: &found.ranges,
            options: &options,
        };
        let (_, report) = make_consistent(&fit, None).unwrap();
        assert!(report.converged && report.determined <= robot.truth.len());
        let start = Instant::now();
        for _ in 0..REPEATS {
            std::hint::black_box(make_consistent(&fit, None).unwrap());
        }
        let each = start.elapsed().as_secs_f64() * 1e3 / f64::from(REPEATS);
        println!("{name}: {each:.2} ms, {} Newton steps, loss {:.3e}", report.steps, report.loss);
    }
}
