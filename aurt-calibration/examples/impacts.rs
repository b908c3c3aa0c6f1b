//! How often 95 % intervals hold the truth, and how far estimates are off, with and without knocks in 1 % of the rows: least
//! squares beside weights by row.
//!
//! `cargo run --release -p aurt-calibration --example impacts -- 100` prints the table of docs/estimation.md; the number is that of
//! the seeds of each row.

#![expect(clippy::unwrap_used, reason = "an example that cannot go on has nothing to say")]

mod knocks;
#[expect(dead_code, reason = "examples share it, and each uses a part")]
mod known_robot;

use aurt_calibration::{Deviations, Estimator};
use knocks::with_knocks;
use known_robot::{F_DYN_HZ, KnownRobot, Noise, measured};
use rayon::prelude::*;

const DURATION_S: f64 = 20.0;

fn main() {
    let seeds: u64 = std::env::args().nth(1).map_or(100, |text| text.parse().unwrap());
    let mut robot = KnownRobot::new(None);
    let clean = robot.clean(1, DURATION_S);
    let knocked = with_knocks(clean.clone());
    println!("{seeds} seeds; UR10e, {DURATION_S} s, f_dyn {F_DYN_HZ} Hz");
    println!(
        "| noise of the currents | knocks | `\"wls\"`: intervals that hold, % | `\"irls\"` | `\"irls\"`, rows taken as white | \
         mean squared error, `\"irls\"` over `\"wls\"` |"
    );
    println!("|---|---|---|---|---|---|");
    let estimates = [
        (Estimator::Wls, Deviations::Memory),
        (Estimator::Irls, Deviations::Memory),
        (Estimator::Irls, Deviations::White),
    ];
    let noises = [("white", Noise::White), ("Gauss–Markov, 0.1 s", Noise::GaussMarkov { time_s: 0.1 })];
    for (noise_name, noise) in noises {
        for (knocks, recording) in [("none", &clean), ("1 % of the rows", &knocked)] {
            let found: Vec<[(usize, Vec<f64>); 3]> = (1..=seeds)
                .into_par_iter()
                .map(|seed| {
                    let noisy = [measured(recording, "noisy", seed, noise, 1.0, None)];
                    estimates.map(|(estimator, deviations)| {
                        let found = robot.calibrated(&noisy, estimator, deviations);
                        let held = robot.held(&found).into_iter().filter(|held| *held).count();
                        let of_truth = found.parameters.iter().zip(&robot.truth);
                        (held, of_truth.map(|(p, truth)| (p.value - truth).powi(2)).collect())
                    })
                })
                .collect();
            let share = |k: usize| {
                let held: usize = found.iter().map(|f| f[k].0).sum();
                100.0 * held as f64 / (found.len() * robot.truth.len()) as f64
            };
            // Each parameter counts alike, whatever its unit.
            let squares = |k: usize, i: usize| found.iter().map(|f| f[k].1[i]).sum::<f64>();
            let logarithms = (0..robot.truth.len()).map(|i| (squares(1, i) / squares(0, i)).ln());
            let ratio = (logarithms.sum::<f64>() / robot.truth.len() as f64).exp();
            println!(
                "| {noise_name} | {knocks} | {:.1} | {:.1} | {:.1} | {ratio:.3} |",
                share(0),
                share(1),
                share(2)
            );
        }
    }
}
