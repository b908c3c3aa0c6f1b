//! Recordings longer than memory, from the file to the calibrated model.
//!
//! `cargo bench -p aurt-calibration --bench long [-- --samples 1000000 --joints 6]`
//!
//! Writes a table of so many rows, then reads, prepares and calibrates it with τ_J fitted. Prints seconds by step (what
//! the process as a whole spent on processors) and the largest memory that it ever held. One size a run, because the
//! largest memory is that of the whole run; `aurt-lab/scaling.py` runs several and fits the slope.
#![expect(clippy::unwrap_used, reason = "a benchmark may panic")]

mod workload;

use aurt_calibration::{CalibrationOptions, calibrate_long};
use aurt_recording::{LongRecording, PreprocessOptions, ReadOptions};
use aurt_traits::{Dispatch, MeasurementUnit};
use workload::{largest_memory_mb, option, process_s};

fn main() {
    let (joints, samples) = (option("--joints").unwrap_or(6), option("--samples").unwrap_or(1_000_000));
    if let Some(threads) = option("--threads") {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().unwrap();
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("recording.csv");
    workload::write_csv(&file, joints, samples);
    let start = process_s();
    let read = ReadOptions { joints: Some(joints.into()), ..ReadOptions::default() };
    let long = LongRecording::read(&file, &read).unwrap();
    let parsed = process_s();
    let prepared = long.prepare(&PreprocessOptions::new(10.0)).unwrap();
    let ready = process_s();
    let model = workload::model(joints);
    let options = CalibrationOptions::default();
    let unit = MeasurementUnit::NewtonMetre;
    let calibration = calibrate_long(&model, &[prepared], unit, 10.0, &options).unwrap();
    let done = process_s();
    println!(
        "{samples} samples × {joints} joints, {}: read {:.2} s, prepare {:.2} s, calibrate {:.2} s, total {:.2} s, \
         {:.0} MB, {} rows a joint",
        Dispatch::active(),
        parsed - start,
        ready - parsed,
        done - ready,
        done - start,
        largest_memory_mb(),
        calibration.samples_per_joint[0]
    );
}
