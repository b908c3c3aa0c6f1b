//! Reads a recording of any format and length and tells the rate of its payload, and the memory that it took.
//!
//! ```text
//! cargo run --release -p aurt-recording --example throughput FILE [whole]
//! ```
//!
//! The file is read piece by piece into a [`LongRecording`]; with `whole` it is held in memory. The payload are the numbers
//! that were read, 8 bytes each.

use std::time::Instant;

use aurt_recording::{LongRecording, ReadOptions, read_recording};
use aurt_traits::MeasurementUnit;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let path = arguments.next().ok_or("which file?")?;
    let options = ReadOptions { unit: Some(MeasurementUnit::Ampere), ..ReadOptions::default() };
    let start = Instant::now();
    let (rows, joints) = if arguments.next().is_some() {
        let recording = read_recording(path.as_ref(), &options)?;
        (recording.samples(), recording.joints())
    } else {
        let recording = LongRecording::read(path.as_ref(), &options)?;
        (recording.samples(), recording.joints())
    };
    let seconds = start.elapsed().as_secs_f64();
    let payload = rows as f64 * (1 + 2 * joints) as f64 * 8.0 / 1e6;
    let file = std::fs::metadata(&path)?.len() as f64 / 1e6;
    println!(
        "{rows} rows of {joints} joints, {file:.0} MB: {seconds:.2} s, {:.0} MB/s of payload",
        payload / seconds
    );
    if let Some(busy_s) = processor_s() {
        println!("processor time {busy_s:.2} s, {:.0} MB/s of payload", payload / busy_s);
    }
    println!("memory at most {:.0} MB", peak_mb().unwrap_or(f64::NAN));
    Ok(())
}

/// The most memory that this process has held, in MB, where the system tells.
fn peak_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()? / 1e3)
}

/// Processor time that this process has taken, in s, where the system tells; what counts on a machine that does other work.
fn processor_s() -> Option<f64> {
    const TICKS_PER_S: f64 = 100.0;
    let status = std::fs::read_to_string("/proc/self/stat").ok()?;
    let mut fields = status.rsplit_once(") ")?.1.split(' ').skip(11);
    let (user, system): (f64, f64) = (fields.next()?.parse().ok()?, fields.next()?.parse().ok()?);
    Some((user + system) / TICKS_PER_S)
}
