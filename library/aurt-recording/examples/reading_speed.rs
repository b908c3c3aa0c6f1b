//! Times reading, preprocessing and the filter bank on a synthetic recording; medians of repeated runs.
//!
//! ```text
//! cargo run --release -p aurt-recording --example reading_speed [FILE]
//! ```
//!
//! With a file, only that is read and preprocessed, once.

use std::fmt::Write as _;
use std::time::Instant;

use aurt_recording::{PreprocessOptions, ReadOptions, ZeroPhase, ZeroPhaseBank, preprocess, read_recording};

const JOINTS: usize = 6;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    if let Some(path) = std::env::args_os().nth(1) {
        let start = Instant::now();
        let recording = read_recording(path.as_ref(), &ReadOptions::default())?;
        let megabytes = std::fs::metadata(&path)?.len() as f64 / 1e6;
        let read_s = start.elapsed().as_secs_f64();
        println!("read        {megabytes:.1} MB in {:.1} ms: {:.0} MB/s", read_s * 1e3, megabytes / read_s);
        let done = preprocess(&recording, &PreprocessOptions::new(10.0))?;
        println!("preprocess  {:.1} ms", (start.elapsed().as_secs_f64() - read_s) * 1e3);
        recording.report.notes().iter().chain(&done.report.notes()).for_each(|note| println!("    {note}"));
        return Ok(());
    }
    let samples = 29_000;
    let path = std::env::temp_dir().join(format!("aurt-speed-{}.csv", std::process::id()));
    let text = recording(samples, 500.0);
    std::fs::write(&path, &text)?;
    let (read_s, recording) = median(15, || read_recording(&path, &ReadOptions::default()));
    std::fs::remove_file(&path)?;
    let recording = recording?;
    let megabytes = text.len() as f64 / 1e6;
    println!(
        "read        {samples} rows, {megabytes:.2} MB: {:7.2} ms, {:6.0} MB/s",
        read_s * 1e3,
        megabytes / read_s
    );

    let options = PreprocessOptions::new(10.0);
    let (preprocess_s, done) = median(15, || preprocess(&recording, &options));
    let done = done?;
    println!(
        "preprocess  {samples} samples, {JOINTS} joints: {:7.2} ms ({} rows a joint)",
        preprocess_s * 1e3,
        done.segments[0].rows()
    );

    let filter = &done.segments[0].parallel_filter;
    for (columns, tile, decimation) in
        [(180, 256, 10), (180, 512, 10), (180, 1024, 10), (180, 256, 4), (180, 256, 20), (180, 256, 1)]
    {
        bank(filter, columns, tile, decimation, samples);
    }
    let slow = ZeroPhase::butterworth(4, 5.0, 1000.0)?;
    bank(&slow, 180, 256, 80, samples);
    let column = vec![0.5; samples];
    let columns: Vec<&[f64]> = vec![&column; 8];
    let (whole_s, _) = median(15, || filter.filter_all(&columns));
    println!(
        "whole       8 columns x {samples}: {:7.2} ms, {:5.2} ns per value",
        whole_s * 1e3,
        whole_s * 1e9 / (8 * samples) as f64
    );
    Ok(())
}

fn bank(filter: &ZeroPhase, columns: usize, tile: usize, decimation: usize, samples: usize) {
    let stride = tile + 8;
    let data: Vec<f64> = (0..columns * stride).map(|k| (0.1 * k as f64).sin()).collect();
    let mut bank = ZeroPhaseBank::new(filter, columns, decimation);
    let (time_s, sum) = median(15, || {
        let mut sum = 0.0;
        let mut sink = |rows: aurt_recording::DecimatedTile<'_>| sum += rows.column(0)[0];
        for _ in 0..samples / tile {
            bank.push(&data, stride, tile, &mut sink);
        }
        bank.finish(&mut sink).map(|()| sum)
    });
    let values = samples / tile * tile * columns;
    println!(
        "bank        {columns} columns x {samples}, tiles of {tile}, every {decimation}: {:7.2} ms, {:5.2} ns per value{}",
        time_s * 1e3,
        time_s * 1e9 / values as f64,
        if sum.is_err() { " (failed)" } else { "" }
    );
}

/// The median duration of `runs` runs, and what the last one returned.
fn median<T>(runs: usize, mut run: impl FnMut() -> T) -> (f64, T) {
    let mut result = run();
    let mut times: Vec<f64> = (0..runs)
        .map(|_| {
            let start = Instant::now();
            result = run();
            start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    (times[runs / 2], result)
}

/// A recording as text, with as many digits as robots' recorders write.
fn recording(samples: usize, rate_hz: f64) -> String {
    let mut text = String::from("timestamp");
    for name in ["actual_q", "actual_current"] {
        for joint in 0..JOINTS {
            let _ = write!(text, ",{name}_{joint}");
        }
    }
    text.push('\n');
    for k in 0..samples {
        let t = k as f64 / rate_hz;
        let _ = write!(text, "{t:.8}");
        for joint in 0..JOINTS {
            let _ = write!(text, ",{:.8}", (t * (1.0 + 0.3 * joint as f64)).sin());
        }
        for joint in 0..JOINTS {
            let _ = write!(text, ",{:.8}", 3.0 * (t * (1.0 + 0.3 * joint as f64)).cos());
        }
        text.push('\n');
    }
    text
}
