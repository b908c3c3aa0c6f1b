//! End to end: reading, preprocessing, regressor, parallel filter, weighted least squares, by stage.
//!
//! `cargo bench -p aurt-calibration --bench identification [-- --samples 29000 --joints 6 --rounds 15 --tsv]`
//!
//! One thread works, and its processor time is counted: median of the rounds [smallest, largest] in ms. By default
//! 29 000 samples of six joints, 58 s at 500 Hz, with the paper's friction. The variants are those of
//! `examples/ur10e_hundred_variants.toml`, fitted one after the other to shared rows: what all but the first take,
//! over their number; also as a share of a whole identification from arrays.
#![expect(clippy::unwrap_used, reason = "a benchmark may panic")]

mod workload;

use aurt_calibration::{
    CalibrationOptions, Estimator, FitRows, LoadTorqueChoice, NamedRecording, RigidRows, ShapeOptions,
    TermScopes, accumulate, calibrate, calibrate_shapes_rows, estimate,
};
use aurt_recording::{PreprocessOptions, ReadOptions, preprocess, read_recording};
use aurt_traits::{Dispatch, LoadTorque, MeasurementUnit, RobotModel};
use workload::{option, processor_s, summary};

const STAGES: [&str; 8] = [
    "read the table",
    "preprocess",
    "regressor, parallel filter, triangles",
    "WLS from the triangles",
    "from parsed arrays, τ_J literal",
    "from parsed arrays, τ_J fitted",
    "from the file, τ_J fitted",
    "one more of 105 linear variants of joint dynamics, τ_J fitted",
];

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global().unwrap();
    let (joints, samples) = (option("--joints").unwrap_or(6), option("--samples").unwrap_or(29_000));
    let rounds = option("--rounds").unwrap_or(15);
    let model = workload::model(joints);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("recording.csv");
    workload::write_csv(&file, joints, samples);
    let read = ReadOptions { joints: Some(joints.into()), ..ReadOptions::default() };
    let options = |load_torque| CalibrationOptions { load_torque, ..CalibrationOptions::default() };
    let preprocessing = PreprocessOptions::new(10.0);

    let variants = workload::variants(&workload::bodies(joints));
    let mut times = vec![Vec::new(); STAGES.len()];
    let mut shares = Vec::new();
    for _ in 0..rounds {
        let start = processor_s();
        let recording = read_recording(&file, &read).unwrap();
        let parsed = processor_s();
        let data = preprocess(&recording, &preprocessing).unwrap();
        let prepared = [NamedRecording { name: "recording".into(), data }];
        let preprocessed = processor_s();
        let literal = options(LoadTorqueChoice::Literal);
        let system =
            accumulate(&model, &prepared, &TermScopes::everywhere(), &LoadTorque::Literal, &literal).unwrap();
        let accumulated = processor_s();
        std::hint::black_box(estimate(&system, Estimator::Wls).unwrap());
        let estimated = processor_s();
        let fitted = options(LoadTorqueChoice::Fitted);
        calibrate(&model, &prepared, MeasurementUnit::NewtonMetre, 10.0, &fitted).unwrap();
        let calibrated = processor_s();
        let rigid = RigidRows::new(&model, &prepared).unwrap();
        let rows = FitRows::new(&rigid, &[0], &fitted).unwrap();
        let fixed = CalibrationOptions { fit_shapes: false, ..fitted };
        let fit = |model: &RobotModel| {
            let (scopes, search) = (TermScopes::everywhere(), ShapeOptions::default());
            let unit = MeasurementUnit::NewtonMetre;
            calibrate_shapes_rows(model, &rows, &scopes, unit, 10.0, &fixed, &search).unwrap();
        };
        fit(&variants[0]);
        let shared = processor_s();
        variants[1..].iter().for_each(fit);
        let further = (processor_s() - shared) / (variants.len() - 1) as f64;
        let preprocessing = preprocessed - parsed;
        shares.push(100.0 * further / (preprocessing + calibrated - estimated));
        for (times, seconds) in times.iter_mut().zip([
            parsed - start,
            preprocessing,
            accumulated - preprocessed,
            estimated - accumulated,
            estimated - parsed,
            preprocessing + (calibrated - estimated),
            parsed - start + preprocessing + (calibrated - estimated),
            further,
        ]) {
            times.push(1e3 * seconds);
        }
    }
    let tsv = std::env::args().any(|a| a == "--tsv");
    if !tsv {
        println!("{joints} joints, {samples} samples, one thread, {}", Dispatch::active());
    }
    for (stage, times) in STAGES.iter().zip(&mut times) {
        let [median, least, most] = summary(times);
        if tsv {
            println!("{stage}\t{median:.3}\t{least:.3}\t{most:.3}");
        } else {
            println!("{median:9.2} ms [{least:.2}, {most:.2}]  {stage}");
        }
    }
    if !tsv {
        let [median, least, most] = summary(&mut shares);
        println!(
            "{median:9.2} %  [{least:.2}, {most:.2}]  the variant's share of an identification from arrays"
        );
    }
}
