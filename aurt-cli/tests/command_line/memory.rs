//! Memory of commands on recordings of some tens of megabytes, against the rule of `docs/reliability.md`.

use std::fmt::Write as _;
use std::fs;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::programs::aurt;
use crate::support::{DEMO, Folder};

/// Bytes for each number of the recordings, and bytes that every command takes.
const ALLOWED: (u64, u64) = (250, 60 << 20);
const CALIBRATE: &str = "calibrate --model rd.json --data long.csv --f-dyn-hz 5 \
                         --torque-constants 11.976 11.976 9.839 10.763 10.763 10.763 --out-params p.csv \
                         --out-calibrated-model c.json";

/// The demo's motion again and again, `rows` long; with `decimals`, cells are rounded to as many. Returns the count of numbers.
fn long_recording(folder: &Folder, rows: usize, decimals: Option<usize>) -> u64 {
    let text = DEMO.read("demo/exciting_motion.csv");
    let (header, body) = text.split_once('\n').unwrap();
    let cells: Vec<String> = body
        .lines()
        .map(|line| {
            let rest = line.split_once(',').unwrap().1;
            let Some(decimals) = decimals else { return rest.to_owned() };
            let rounded: Vec<String> =
                rest.split(',').map(|cell| format!("{:.decimals$}", cell.parse::<f64>().unwrap())).collect();
            rounded.join(",")
        })
        .collect();
    let mut long = format!("{header}\n");
    for row in 0..rows {
        writeln!(long, "{:.3},{}", row as f64 * 0.008, cells[row % cells.len()]).unwrap();
    }
    folder.write("long.csv", &long);
    (rows * header.split(',').count()) as u64
}

/// Largest resident memory of a command with two threads, in bytes; its results may have findings, but are no refusal.
fn peak_memory(folder: &Folder, line: &str) -> u64 {
    let mut child = Command::new(aurt())
        .args(line.split_whitespace())
        .current_dir(folder.path("."))
        .env("RAYON_NUM_THREADS", "2")
        .stdout(Stdio::null())
        .stderr(fs::File::create(folder.path("stderr")).unwrap())
        .spawn()
        .unwrap();
    let mut peak = 0;
    let status = loop {
        // The high-water mark is gone with the process: the last reading is at most a few milliseconds older than its end.
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let mark = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = mark.and_then(|rest| rest.trim().split(' ').next()?.parse::<u64>().ok());
        peak = peak.max(kilobytes.unwrap_or(0) << 10);
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        std::thread::sleep(Duration::from_millis(3));
    };
    assert!(matches!(status.code(), Some(0 | 1)), "{line}: {status} {}", folder.read("stderr"));
    assert!(peak > 10 << 20, "{line}: {peak} bytes are no measurement");
    peak
}

/// An experiment with one long recording, and the count of its numbers.
fn experiment(rows: usize, decimals: Option<usize>) -> (Folder, u64) {
    let folder = Folder::new().with_demo(&["mdh.csv", "other_motion.csv", "experiment.toml"]);
    let numbers = long_recording(&folder, rows, decimals);
    folder.edit("experiment.toml", |text| {
        text.replace("calibration = [\"exciting_motion.csv\"]", "calibration = [\"long.csv\"]")
            .replace(", \"point_to_point.csv\"", "")
    });
    folder.run("compile-rbd --mdh mdh.csv --gravity 0 0 -9.81 --out rbd.json").succeeded();
    folder.run("compile-rd --model-rbd rbd.json --experiment experiment.toml --out rd.json").succeeded();
    (folder, numbers)
}

fn keeps_to_the_rule(folder: &Folder, numbers: u64, lines: &[&str]) {
    let allowed = ALLOWED.0 * numbers + ALLOWED.1;
    for line in lines {
        let peak = peak_memory(folder, line);
        println!("{} MB of {} MB: {line}", peak >> 20, allowed >> 20);
        assert!(peak <= allowed, "{line}: {} MB, {} MB allowed", peak >> 20, allowed >> 20);
    }
}

#[test]
fn commands_keep_to_their_memory() {
    let (folder, numbers) = experiment(140_000, None);
    let size = fs::metadata(folder.path("long.csv")).unwrap().len();
    // Text of full length is within the rule for reading, too.
    assert!(ALLOWED.0 * numbers + ALLOWED.1 <= 20 * size + (200 << 20));
    keeps_to_the_rule(&folder, numbers, &["run experiment.toml --out out", CALIBRATE]);
}

#[test]
fn short_cells_and_noisy_positions_keep_to_it_too() {
    let (folder, numbers) = experiment(60_000, Some(2));
    let check = "check long.csv --mdh mdh.csv --gravity 0 0 -9.81";
    keeps_to_the_rule(&folder, numbers, &["run experiment.toml --out out", CALIBRATE, check]);
}
