//! Confidence intervals hold the truth as often as they promise.

use crate::known_robot;

use aurt_calibration::{Deviations, Estimator};
use known_robot::{KnownRobot, Noise, measured};
use rayon::prelude::*;

const SEEDS: u64 = 150;

#[test]
fn intervals_of_95_percent_hold_the_truth_that_often() {
    let mut robot = KnownRobot::new(None);
    let clean = robot.clean(1, 16.0);
    let holds = |seed: u64| -> Vec<bool> {
        let recordings = [measured(&clean, "known", seed, Noise::White, 1.0, None)];
        let found = robot.calibrated(&recordings, Estimator::Wls, Deviations::Memory);
        assert_eq!(found.parameters.len(), robot.truth.len());
        robot.held(&found)
    };
    let held: Vec<Vec<bool>> = (1..=SEEDS).into_par_iter().map(holds).collect();
    // 150 seeds × some fifty parameters: the share scatters by a quarter percent, that of one parameter by 1.8 %.
    let of = |k: usize| held.iter().filter(|one| one[k]).count() as f64 / SEEDS as f64;
    let shares: Vec<f64> = (0..robot.truth.len()).map(of).collect();
    let share = shares.iter().sum::<f64>() / shares.len() as f64;
    println!("{:.1} % of the intervals hold the truth", 100.0 * share);
    assert!((0.93..0.97).contains(&share), "{share}: {shares:?}");
    assert!(shares.iter().all(|share| *share > 0.87), "{shares:?}");
}
