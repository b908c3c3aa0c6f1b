//! What more cores are worth: preprocessing and calibration of one recording and of several, by turns on one thread and
//! on more.
//!
//! `cargo bench -p aurt-calibration --bench cores [-- --threads 2 --samples 29000 --rounds 15]`
//!
//! Prints the ratio of the times that went by: that of the fastest rounds on either side, and the median of the rounds
//! [smallest, largest]. Of rounds in which threads waited for processors that others had for more than 2 % of the time
//! (as the kernel counts), the first figure takes none, if there are better ones; it says how many rounds were left on
//! either side. What else the machine does can only add time: the fastest undisturbed round is what the work takes.
#![expect(clippy::unwrap_used, reason = "a benchmark may panic")]

mod workload;

use std::time::Instant;

use aurt_calibration::{CalibrationOptions, NamedRecording, TermScopes, accumulate, calibrate};
use aurt_recording::{PreprocessOptions, Recording, preprocess};
use aurt_traits::{Dispatch, LoadTorque, MeasurementUnit};
use rayon::prelude::*;
use workload::{option, summary, waited_s};

/// Share of a round that its threads may wait for processors.
const DISTURBED: f64 = 0.02;

fn prepare(recordings: &[Recording]) -> Vec<NamedRecording> {
    let options = PreprocessOptions::new(10.0);
    recordings
        .par_iter()
        .map(|r| NamedRecording { name: "recording".into(), data: preprocess(r, &options).unwrap() })
        .collect()
}

fn main() {
    let threads = option("--threads").unwrap_or(2);
    let (samples, rounds) = (option("--samples").unwrap_or(29_000), option("--rounds").unwrap_or(15));
    let model = workload::model(6);
    let pools = [1, threads].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap());
    println!("{samples} samples × 6 joints, {threads} threads against one, {}", Dispatch::active());
    for count in [1, 4] {
        let recordings = vec![workload::recording(6, samples); count];
        let prepared = prepare(&recordings);
        let options = CalibrationOptions::default();
        let works: [(&str, &(dyn Fn() + Sync)); 3] = [
            ("regressor, parallel filter, triangles", &|| {
                accumulate(&model, &prepared, &TermScopes::everywhere(), &LoadTorque::Literal, &options)
                    .unwrap();
            }),
            ("calibrate, τ_J fitted", &|| {
                calibrate(&model, &prepared, MeasurementUnit::NewtonMetre, 10.0, &options).unwrap();
            }),
            ("preprocess and calibrate", &|| {
                let prepared = prepare(&recordings);
                calibrate(&model, &prepared, MeasurementUnit::NewtonMetre, 10.0, &options).unwrap();
            }),
        ];
        for (name, work) in works {
            let mut times = [const { Vec::new() }; 2];
            let mut ratios: Vec<f64> = (0..rounds)
                .map(|_| {
                    let [one, more] = [0, 1].map(|pool: usize| {
                        let (start, waited) = (Instant::now(), waited_s());
                        pools[pool].install(work);
                        let seconds = start.elapsed().as_secs_f64();
                        times[pool].push((seconds, waited_s() - waited <= DISTURBED * seconds));
                        seconds
                    });
                    one / more
                })
                .collect();
            let quiet = times.each_ref().map(|rounds| rounds.iter().filter(|(_, quiet)| *quiet).count());
            let [one, more] = times.map(|rounds| {
                let any = rounds.iter().all(|(_, quiet)| !quiet);
                let kept = rounds.iter().filter(|(_, quiet)| any || *quiet);
                kept.fold(f64::INFINITY, |least, (seconds, _)| least.min(*seconds))
            });
            let [median, least, most] = summary(&mut ratios);
            println!(
                "{:6.2} x ({} and {} rounds undisturbed), median {median:.2} [{least:.2}, {most:.2}]  \
                 {count} recording(s), {:.1} ms on one: {name}",
                one / more,
                quiet[0],
                quiet[1],
                1e3 * one
            );
        }
    }
}
