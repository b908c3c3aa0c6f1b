//! What more cores are worth: preprocessing and calibration of one recording and of several, by turns on one thread and
//! on more.
//!
//! `cargo bench -p aurt-calibration --bench cores [-- --threads 2 --samples 29000 --rounds 15]`
//!
//! Prints the ratio of the times that went by, median of the rounds [smallest, largest]. Needs a machine that does
//! nothing else.
#![expect(clippy::unwrap_used, reason = "a benchmark may panic")]

mod workload;

use std::time::Instant;

use aurt_calibration::{CalibrationOptions, NamedRecording, accumulate, calibrate};
use aurt_recording::{PreprocessOptions, Recording, preprocess};
use aurt_traits::{Dispatch, LoadTorque, MeasurementUnit};
use rayon::prelude::*;
use workload::{option, summary};

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
                accumulate(&model, &prepared, &LoadTorque::Literal, &options).unwrap();
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
            let mut ratios: Vec<f64> = (0..rounds)
                .map(|_| {
                    let [one, more] = [0, 1].map(|pool: usize| {
                        let start = Instant::now();
                        pools[pool].install(work);
                        start.elapsed().as_secs_f64()
                    });
                    one / more
                })
                .collect();
            let [median, least, most] = summary(&mut ratios);
            println!("{median:6.2} x [{least:.2}, {most:.2}]  {count} recording(s): {name}");
        }
    }
}
