//! How often 95 % intervals hold the truth: a UR10e whose parameters are known, noise with and without a memory, encoders
//! of several resolutions and white noise of positions, one recording and five.
//!
//! `cargo run --release -p aurt-calibration --example coverage -- 200` prints the table of docs/estimation.md; the first number is
//! that of the seeds of each row; a second is the only number of recordings.

#![expect(clippy::unwrap_used, reason = "an example that cannot go on has nothing to say")]

#[expect(dead_code, reason = "examples share it, and each uses a part")]
mod known_robot;

use aurt_calibration::{Deviations, Estimator};
use aurt_recording::Recording;
use known_robot::{F_DYN_HZ, KnownRobot, Noise, Positions, measured};
use rayon::prelude::*;

const DURATION_S: f64 = 20.0;
const RECORDINGS: usize = 5;

/// Intervals that hold the truth, and all, of rigid bodies and friction: least squares, and the same with rows taken as white.
type Counts = Vec<[usize; 4]>;

fn main() {
    let seeds: u64 = std::env::args().nth(1).map_or(200, |text| text.parse().unwrap());
    let mut robot = KnownRobot::new(None);
    let clean: Vec<Recording> = (0..RECORDINGS).map(|kind| robot.clean(kind, DURATION_S)).collect();
    println!(
        "{seeds} seeds; UR10e, {DURATION_S} s a recording, f_dyn {F_DYN_HZ} Hz; share of 95 % intervals that hold the truth, %"
    );
    let only: Option<usize> = std::env::args().nth(2).map(|text| text.parse().unwrap());
    println!(
        "| recordings | noise of the currents | positions | all | rigid bodies | friction | all, rows taken as white |"
    );
    println!("|---|---|---|---|---|---|---|");
    let noises = [("white", Noise::White), ("Gauss–Markov, 0.1 s", Noise::GaussMarkov { time_s: 0.1 })];
    let encoders = [
        ("exact", Positions::Exact),
        ("19 bit", Positions::Bits(19)),
        ("16 bit", Positions::Bits(16)),
        ("14 bit", Positions::Bits(14)),
        ("12 bit", Positions::Bits(12)),
        ("white, 5e-6 rad", Positions::White(5e-6)),
        ("white, 5e-5 rad", Positions::White(5e-5)),
        ("white, 2e-4 rad", Positions::White(2e-4)),
        ("white, 1e-3 rad", Positions::White(1e-3)),
    ];
    let counts = only.map_or(vec![1, RECORDINGS], |only| vec![only]);
    let rows = counts.into_iter().flat_map(|count| {
        noises
            .into_iter()
            .flat_map(move |noise| encoders.into_iter().map(move |encoder| (count, noise, encoder)))
    });
    for (count, (noise_name, noise), (encoder, positions)) in rows {
        let found: Vec<Counts> = (1..=seeds)
            .into_par_iter()
            .map(|seed| covered(&robot, &clean[..count], seed, noise, positions))
            .collect();
        let sum = |k: usize, i: usize| found.iter().map(|c| c[k][i]).sum::<usize>() as f64;
        let share = |k: usize, groups: &[usize]| {
            let (held, all): (f64, f64) =
                groups.iter().fold((0.0, 0.0), |(h, a), g| (h + sum(k, 2 * g), a + sum(k, 2 * g + 1)));
            100.0 * held / all
        };
        let shares = [share(0, &[0, 1]), share(0, &[0]), share(0, &[1]), share(1, &[0, 1])];
        let shares: String = shares.iter().map(|s| format!(" {s:.1} |")).collect();
        println!("| {count} | {noise_name} | {encoder} |{shares}");
    }
}

fn covered(robot: &KnownRobot, clean: &[Recording], seed: u64, noise: Noise, positions: Positions) -> Counts {
    let recordings: Vec<_> = clean
        .iter()
        .enumerate()
        .map(|(k, c)| measured(c, &format!("{k}"), 1000 * seed + k as u64, noise, 1.0, positions))
        .collect();
    let base = robot.model.base().len();
    let of = |deviations| {
        let found = robot.calibrated(&recordings, Estimator::Wls, deviations);
        let mut counts = [0; 4];
        for (k, held) in robot.held(&found).into_iter().enumerate() {
            let group = 2 * usize::from(k >= base);
            counts[group] += usize::from(held);
            counts[group + 1] += 1;
        }
        counts
    };
    [Deviations::Memory, Deviations::White].map(of).into()
}
