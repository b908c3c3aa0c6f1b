//! What elimination of parameters does on recordings of a few seconds: how many it keeps, and the error elsewhere.
//!
//! `cargo run --release -p aurt-calibration --example essential -- 40` prints the table of docs/estimation.md; the number is that
//! of the seeds of each row.

#![expect(clippy::unwrap_used, reason = "an example that cannot go on has nothing to say")]

#[expect(dead_code, reason = "the truth is not asked for")]
mod known_robot;

use aurt_calibration::{
    Calibration, CalibrationError, CalibrationOptions, Deviations, Estimator, NamedRecording, accumulate,
    calibrate,
};
use aurt_recording::Recording;
use aurt_traits::{LoadTorque, MeasurementUnit};
use known_robot::{F_DYN_HZ, KnownRobot, NOISE_NM, Noise, RATE_HZ, measured};
use rayon::prelude::*;

/// The robot's recordings are cut from one of this length, so that a short one is no faster.
const WHOLE_S: f64 = 40.0;

fn main() {
    let seeds: u64 = std::env::args().nth(1).map_or(20, |text| text.parse().unwrap());
    let mut robot = KnownRobot::new(None);
    let (clean, other) = (robot.clean(0, WHOLE_S), robot.clean(1, WHOLE_S));
    let unseen = measured(&other, "unseen", 1, Noise::White, 0.0, None);
    let none = LoadTorque::Fitted(vec![0.0; robot.model.parameters().len()]);
    let options = CalibrationOptions::default();
    let judge = accumulate(&robot.model, &[unseen], &none, &options).unwrap();
    // Mean squared error of the torques without noise, in variances of the noise, over the joints.
    let error = |found: &Calibration| -> f64 {
        let rows = judge.factors()[0].rows() as f64;
        let sums = judge.residual_sum(&found.coefficients());
        sums.iter().zip(NOISE_NM).map(|(s, n)| s / rows / (n * n)).sum::<f64>() / 6.0
    };
    println!("{seeds} seeds; UR10e, f_dyn {F_DYN_HZ} Hz, 48 parameters");
    println!(
        "| noise of the currents | recording | refused, % | blocks | kept, mean (least) | error elsewhere over that of `\"wls\"`: \
         median | worst |\n|---|---|---|---|---|---|---|"
    );
    for (name, noise) in
        [("white", Noise::White), ("Gauss–Markov, 0.1 s", Noise::GaussMarkov { time_s: 0.1 })]
    {
        for duration_s in [5.0, 8.0, 9.0, 10.0, 12.0, 16.0, 24.0, 40.0] {
            let of = |seed: u64| -> Option<(usize, usize, f64)> {
                let short = first(&clean, duration_s);
                let recordings: Vec<NamedRecording> = vec![measured(&short, "short", seed, noise, 1.0, None)];
                let fit = |estimator| {
                    let options = CalibrationOptions { estimator, deviations: Deviations::White, ..options };
                    calibrate(&robot.model, &recordings, MeasurementUnit::NewtonMetre, F_DYN_HZ, &options)
                };
                let all = fit(Estimator::Wls).unwrap();
                match fit(Estimator::Essential) {
                    Ok(few) => {
                        let report = few.essential.clone().unwrap();
                        Some((report.blocks, report.kept, (error(&few) / error(&all)).sqrt()))
                    }
                    Err(CalibrationError::TooFewBlocks { .. }) => None,
                    Err(other) => panic!("{other}"),
                }
            };
            let found: Vec<_> = (1..=seeds).into_par_iter().map(of).collect();
            let refused = found.iter().filter(|f| f.is_none()).count();
            let mut told: Vec<(usize, usize, f64)> = found.into_iter().flatten().collect();
            told.sort_by(|a, b| a.2.total_cmp(&b.2));
            let share = 100.0 * refused as f64 / seeds as f64;
            if told.is_empty() {
                println!("| {name} | {duration_s} s | {share:.0} | | | | |");
                continue;
            }
            let count = told.len() as f64;
            let kept = told.iter().map(|t| t.1 as f64).sum::<f64>() / count;
            println!(
                "| {name} | {duration_s} s | {share:.0} | {:.1} | {kept:.1} ({}) | {:.2} | {:.2} |",
                told.iter().map(|t| t.0 as f64).sum::<f64>() / count,
                told.iter().map(|t| t.1).min().unwrap(),
                told[told.len() / 2].2,
                told[told.len() - 1].2,
            );
        }
    }
}

fn first(whole: &Recording, duration_s: f64) -> Recording {
    whole.rows(0..(duration_s * RATE_HZ) as usize)
}
