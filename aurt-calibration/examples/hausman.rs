//! How often the test of Durbin, Wu and Hausman calls least squares biased: with exact positions that is its size, with encoders
//! its power.
//!
//! `cargo run --release -p aurt-calibration --example hausman -- 500` prints the table of docs/estimation.md; the number is that of
//! the seeds of each row.

#![expect(clippy::unwrap_used, reason = "an example that cannot go on has nothing to say")]

#[expect(dead_code, reason = "the truth is not asked for")]
mod known_robot;

use std::time::Instant;

use aurt_calibration::{CalibrationOptions, Deviations, NamedRecording, TermScopes, calibrate, hausman};
use aurt_traits::MeasurementUnit;
use known_robot::{F_DYN_HZ, KnownRobot, Noise, measured};
use rayon::prelude::*;

const DURATION_S: f64 = 20.0;
const ROUNDS: usize = 9;

fn main() {
    let seeds: u64 = std::env::args().nth(1).map_or(200, |text| text.parse().unwrap());
    let mut robot = KnownRobot::new(None);
    let clean = robot.clean(0, DURATION_S);
    println!(
        "{seeds} seeds; UR10e, {DURATION_S} s, f_dyn {F_DYN_HZ} Hz; recordings whose least squares is called biased, %"
    );
    println!(
        "| noise of the currents | encoder | at 5 % | at 1 % | mean χ² over its degrees of freedom |\n|---|---|---|---|---|"
    );
    let options = CalibrationOptions { deviations: Deviations::White, ..CalibrationOptions::default() };
    for (name, noise) in
        [("white", Noise::White), ("Gauss–Markov, 0.1 s", Noise::GaussMarkov { time_s: 0.1 })]
    {
        for (encoder, bits) in [
            ("exact", None),
            ("19 bit", Some(19)),
            ("16 bit", Some(16)),
            ("14 bit", Some(14)),
            ("12 bit", Some(12)),
        ] {
            let test = |seed: u64| {
                let recording: NamedRecording = measured(&clean, "0", 1000 * seed, noise, 1.0, bits);
                let unit = MeasurementUnit::NewtonMetre;
                let recordings = [recording];
                let found = calibrate(&robot.model, &recordings, unit, F_DYN_HZ, &options).unwrap();
                hausman(&robot.model, &[&recordings[0]], &TermScopes::everywhere(), &found).unwrap().unwrap()
            };
            let tests: Vec<_> = (1..=seeds).into_par_iter().map(test).collect();
            let below = |p: f64| {
                100.0 * tests.iter().filter(|t| t.probability < p).count() as f64 / tests.len() as f64
            };
            let mean = tests.iter().map(|t| t.statistic / t.freedom as f64).sum::<f64>() / tests.len() as f64;
            println!("| {name} | {encoder} | {:.1} | {:.1} | {mean:.2} |", below(0.05), below(0.01));
        }
    }
    // What the test costs of a calibration that tells it.
    let recordings = [measured(&clean, "known", 1, Noise::White, 1.0, Some(12))];
    let whole = CalibrationOptions::default();
    let (mut all, mut test) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..ROUNDS {
        let began = Instant::now();
        let found =
            calibrate(&robot.model, &recordings, MeasurementUnit::NewtonMetre, F_DYN_HZ, &whole).unwrap();
        all = all.min(began.elapsed().as_secs_f64());
        let began = Instant::now();
        hausman(&robot.model, &[&recordings[0]], &TermScopes::everywhere(), &found).unwrap().unwrap();
        test = test.min(began.elapsed().as_secs_f64());
    }
    println!(
        "the test takes {:.0} ms, {:.0} % of the {:.0} ms of a calibration that tells it (fastest of {ROUNDS})",
        1e3 * test,
        100.0 * test / all,
        1e3 * all
    );
}
