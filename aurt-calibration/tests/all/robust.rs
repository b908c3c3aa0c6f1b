//! Weights by row: impacts do not count, intervals hold the truth, and without impacts estimates are those of least squares.

use crate::{knocks, known_robot};

use aurt_calibration::{
    Calibration, CalibrationOptions, Deviations, Estimator, TermScopes, accumulate, noise_bandwidth_factor,
};
use aurt_recording::Recording;
use aurt_traits::LoadTorque;
use knocks::with_knocks;
use known_robot::{KnownRobot, Noise, measured};
use rayon::prelude::*;

const DURATION_S: f64 = 20.0;

/// Intervals that hold the truth, of how many, and the sum of squared errors in given deviations.
#[derive(Debug, Clone, Copy, Default)]
struct Score {
    held: usize,
    of: usize,
    squares: f64,
}

impl Score {
    fn of(robot: &KnownRobot, found: &Calibration, std_devs: &[f64]) -> Self {
        let held = robot.held(found);
        let errors = found.parameters.iter().zip(&robot.truth).map(|(p, truth)| p.value - truth);
        Self {
            held: held.iter().filter(|held| **held).count(),
            of: held.len(),
            squares: errors.zip(std_devs).map(|(error, std_dev)| (error / std_dev).powi(2)).sum(),
        }
    }

    fn and(self, other: Self) -> Self {
        let squares = self.squares + other.squares;
        Self { held: self.held + other.held, of: self.of + other.of, squares }
    }

    fn share(self) -> f64 {
        self.held as f64 / self.of as f64
    }
}

fn std_devs(found: &Calibration) -> Vec<f64> {
    found.parameters.iter().map(|p| p.std_dev.unwrap()).collect()
}

/// Scores of least squares and of weights by row over seeds, in the same deviations, those of least squares without knocks.
fn scores(
    robot: &KnownRobot,
    clean: &Recording,
    recording: &Recording,
    (noise, deviations): (Noise, Deviations),
) -> [Score; 2] {
    let quiet = [measured(clean, "quiet", 1, noise, 1.0, None)];
    let scale = std_devs(&robot.calibrated(&quiet, Estimator::Wls, Deviations::Memory));
    let of = |seed: u64| {
        let noisy = [measured(recording, "noisy", seed, noise, 1.0, None)];
        [Estimator::Wls, Estimator::Irls]
            .map(|estimator| Score::of(robot, &robot.calibrated(&noisy, estimator, deviations), &scale))
    };
    (1..=100_u64)
        .into_par_iter()
        .map(of)
        .reduce(<[Score; 2]>::default, |a, b| [a[0].and(b[0]), a[1].and(b[1])])
}

#[test]
fn with_knocks_intervals_hold_and_estimates_are_better_than_those_of_least_squares() {
    let mut robot = KnownRobot::new(None);
    let clean = robot.clean(1, DURATION_S);
    let knocked = with_knocks(clean.clone());
    for noise in [Noise::White, Noise::GaussMarkov { time_s: 0.1 }] {
        let [plain, robust] = scores(&robot, &clean, &knocked, (noise, Deviations::Memory));
        assert!((0.92..0.98).contains(&robust.share()), "{noise:?} {robust:?} {}", robust.share());
        assert!(robust.squares < 0.8 * plain.squares, "{noise:?} {robust:?} {plain:?}");
    }
}

#[test]
fn without_knocks_intervals_of_independent_rows_hold() {
    let mut robot = KnownRobot::new(None);
    let clean = robot.clean(1, DURATION_S);
    let [plain, robust] = scores(&robot, &clean, &clean, (Noise::White, Deviations::White));
    assert!((0.92..0.98).contains(&robust.share()), "{robust:?} {}", robust.share());
    // Better weights of the joints outweigh what is lost on normal noise.
    assert!(robust.squares < 1.1 * plain.squares, "{robust:?} {plain:?}");
}

#[test]
fn knocks_have_no_weight_and_are_reported() {
    let mut robot = KnownRobot::new(None);
    let clean = robot.clean(0, DURATION_S);
    let recordings = [measured(&with_knocks(clean), "knocks", 3, Noise::White, 1.0, None)];
    let found = robot.calibrated(&recordings, Estimator::Irls, Deviations::Memory);
    let rejected = &found.robust.as_ref().unwrap().rejected;
    assert!(rejected.iter().all(|share| (0.005..0.1).contains(share)), "{rejected:?}");
}

/// Tukey's weights have 95 % of the efficiency of least squares on normal noise, so that deviations are 1.026 times those of least
/// squares with the same σ_j, and a little more for what the fit takes up.
#[test]
fn without_knocks_deviations_are_about_those_of_least_squares_with_the_same_weights() {
    let mut robot = KnownRobot::new(None);
    let clean = robot.clean(1, DURATION_S);
    let ratios: Vec<f64> = (1..=12)
        .into_par_iter()
        .map(|seed| {
            let recordings = [measured(&clean, "quiet", seed, Noise::White, 1.0, None)];
            let found = robot.calibrated(&recordings, Estimator::Irls, Deviations::White);
            let (everywhere, options) = (TermScopes::everywhere(), CalibrationOptions::default());
            let system =
                accumulate(&robot.model, &recordings, &everywhere, &LoadTorque::Literal, &options).unwrap();
            let weights: Vec<f64> = found.sigma.iter().map(|s| 1.0 / s).collect();
            let plain = system.solve(&weights, |_| true).unwrap();
            let segment = &recordings[0].data.segments[0];
            let bandwidth = noise_bandwidth_factor(&segment.parallel_filter, segment.decimation);
            let n = found.parameters.len();
            let ratio =
                |(k, std_dev): (usize, f64)| std_dev / (bandwidth * plain.covariance[k * n + k]).sqrt();
            std_devs(&found).into_iter().enumerate().map(ratio).sum::<f64>() / n as f64
        })
        .collect();
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    assert!((1.0..1.08).contains(&mean), "{mean} {ratios:?}");
}

#[test]
fn exact_measurements_are_no_obstacle() {
    let mut robot = KnownRobot::new(None);
    let recordings = [measured(&robot.clean(1, DURATION_S), "exact", 1, Noise::White, 0.0, None)];
    let found = robot.calibrated(&recordings, Estimator::Irls, Deviations::Memory);
    for (p, truth) in found.parameters.iter().zip(&robot.truth) {
        assert!((p.value - truth).abs() < 0.05 * truth.abs().max(1.0), "{}: {} {truth}", p.name, p.value);
    }
}
