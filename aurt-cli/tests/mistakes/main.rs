//! Mistakes of users, and whether `aurt` tells them with the cure.
//!
//! A share of them is made on recordings of the demo's robot in every test run, another on those of a real UR10e where
//! AURT_DATA is set. All of them, as the table of docs/mistakes.md:
//! `AURT_MISTAKES=all cargo test --release --test mistakes -- --nocapture`; with `diagnosed` in the place of `all` also what
//! `diagnose` says, with anything else those whose description contains it.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod usual;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use aurt_lab::setups::mistakes::{Cures, tells};
use aurt_lab::setups::{Columns, Log, Setup, Units};
use aurt_rbd::{MdhRows, MdhTable};
use rayon::prelude::*;
use usual::{MISTAKES, Mistake};

/// Of the mistakes on the real robot, every how manieth is in the share of every test run.
const SHARE: usize = 9;
/// Mistakes on the real robot that are told with their cure, at least.
const TOLD: usize = 55;

/// Mistakes that data cannot tell (docs/mistakes.md).
const NOT_TOLD: [&str; 1] = ["the name of a smaller robot of the same family"];

/// Rows of a log that are used: 20 s and more.
const ROWS: usize = 2000;
const JOINTS: usize = 6;

struct Said {
    status: i32,
    text: String,
}

struct Answer {
    check: Said,
    run: Said,
    diagnose: Option<Said>,
}

impl Answer {
    /// Whether one of the cures was told, by `check` or by `run`, and with a status that scripts see.
    fn told(&self, cures: &[Vec<String>]) -> bool {
        [&self.check, &self.run].into_iter().any(|said| said.tells(cures))
    }

    /// Whether a model came out without a word that something is wrong.
    fn is_confident(&self) -> bool {
        self.run.status == 0
    }
}

impl Said {
    fn tells(&self, cures: &[Vec<String>]) -> bool {
        self.status != 0 && tells(&self.text, cures)
    }

    /// For the table: what it ended with, and whether it told the cure.
    fn short(&self, cures: &[Vec<String>]) -> &'static str {
        match (self.status, self.tells(cures)) {
            (0, _) => "nothing",
            (1, true) => "told",
            (1, false) => "doubts",
            (_, true) => "refused, told",
            (_, false) => "refused",
        }
    }
}

/// Runs `aurt` in a folder; what it writes is one running text.
fn aurt(folder: &Path, words: &[&str]) -> Said {
    let output = Command::new(env!("CARGO_BIN_EXE_aurt"))
        .args(words)
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .output()
        .unwrap();
    let text = [output.stdout, output.stderr].map(|b| String::from_utf8_lossy(&b).into_owned()).concat();
    assert!(!text.contains("panicked"), "{text}");
    let text = text.replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ");
    Said { status: output.status.code().unwrap(), text }
}

fn written(setup: &Setup) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    setup.files().iter().for_each(|(name, text)| fs::write(folder.path().join(name), text).unwrap());
    folder
}

fn answer(setup: &Setup, diagnose: bool) -> Answer {
    let folder = written(setup);
    let check = aurt(folder.path(), &["check", "experiment.toml"]);
    let run = aurt(folder.path(), &["run", "experiment.toml", "--out", "out"]);
    let diagnose =
        diagnose.then(|| aurt(folder.path(), &["diagnose", "experiment.toml", "--out", "diagnosis"]));
    Answer { check, run, diagnose }
}

/// Makes a mistake; returns what tells it, and the answer.
fn mistaken(right: &Setup, mistake: &Mistake, diagnose: bool) -> (Cures, Answer) {
    let mut setup = right.clone();
    let (_, cures) = (mistake.make)(&mut setup).unwrap();
    (cures, answer(&setup, diagnose))
}

/// Columns: time, positions, velocities if there are any, measurements.
fn log(path: &Path, validates: bool) -> Log {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines().filter(|l| !l.starts_with('#') && !l.trim().is_empty());
    let mut columns = vec![Vec::new(); lines.next().unwrap().split(',').count()];
    for line in lines.take(ROWS) {
        columns.iter_mut().zip(line.split(',')).for_each(|(c, cell)| c.push(cell.trim().parse().unwrap()));
    }
    let measurement = columns.split_off(columns.len() - JOINTS);
    let velocity_rad_s = columns.split_off(1 + JOINTS);
    let position_rad = columns.split_off(1);
    Log {
        time_s: columns.remove(0),
        position_rad,
        velocity_rad_s,
        measurement,
        units: Units::default(),
        validates,
    }
}

/// A UR10e with two recordings to calibrate on and one held out.
fn ur10e(files: [PathBuf; 3], table: &Path, f_dyn_hz: f64) -> Setup {
    let logs = files.iter().enumerate().map(|(k, file)| log(file, k == 2)).collect();
    let table = MdhTable::from_path(table, MdhRows::Next).unwrap();
    Setup {
        constants_nm_per_a: Some(vec![11.976, 11.976, 9.839, 10.763, 10.763, 10.763]),
        ..Setup::of_table(table.rows, logs, f_dyn_hz)
    }
}

fn real() -> Option<Setup> {
    let Some(data) = std::env::var_os("AURT_DATA").map(PathBuf::from).filter(|d| d.is_dir()) else {
        println!(
            "skipped: mistakes on a UR10e need real recordings in the folder AURT_DATA (docs/real-recordings.md)"
        );
        return None;
    };
    let file = |name: &str| data.join("ur10e").join(name);
    let files = ["excitation_30s.csv", "unloaded_50s.csv", "excitation_20s.csv"].map(file);
    Some(ur10e(files, &file("mdh.csv"), 2.5))
}

fn simulated() -> Setup {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(aurt(folder.path(), &["demo", "--out", "demo"]).status, 0);
    let demo = folder.path().join("demo");
    let files = ["exciting_motion.csv", "other_motion.csv", "point_to_point.csv"].map(|n| demo.join(n));
    ur10e(files, &demo.join("mdh.csv"), 5.0)
}

#[test]
fn without_a_mistake_nothing_is_told() {
    for setup in [Some(simulated()), real()].into_iter().flatten() {
        let answer = answer(&setup, false);
        assert_eq!(answer.run.status, 0, "{}", answer.run.text);
        assert!(answer.check.text.contains("no common mistake explains more"), "{}", answer.check.text);
    }
}

/// The largest held-out error of a joint while it moves, % of its signal, after `aurt run`.
fn held_out_error_percent(setup: &Setup) -> f64 {
    let folder = written(setup);
    let said = aurt(folder.path(), &["run", "experiment.toml", "--out", "out"]);
    assert_eq!(said.status, 0, "{}", said.text);
    let metrics = fs::read(folder.path().join("out/metrics.json")).unwrap();
    let metrics: serde_json::Value = serde_json::from_slice(&metrics).unwrap();
    let recordings = metrics["recordings"].as_array().unwrap().iter().filter(|r| r["role"] == "validation");
    let errors = recordings.flat_map(|r| r["moving"]["nrmse"].as_array().unwrap().clone());
    100.0 * errors.map(|e| e.as_f64().unwrap()).fold(0.0, f64::max)
}

#[test]
fn rows_that_are_held_or_without_measurement_are_left_out() {
    let right = simulated();
    let error_percent = held_out_error_percent(&right);
    // 19 rows of 400 repeat the one before; a measurement of five is zero on all joints.
    let hold = |log: &mut Log| {
        for series in log.families(Columns::Both).flatten() {
            series.chunks_exact_mut(400).for_each(|rows| (301..320).for_each(|k| rows[k] = rows[300]));
        }
    };
    let silence = |log: &mut Log| {
        let zero = |series: &mut Vec<f64>| series.iter_mut().skip(3).step_by(5).for_each(|v| *v = 0.0);
        log.measurement.iter_mut().for_each(zero);
    };
    for (spoil, kind) in [(&hold as &dyn Fn(&mut Log), "held"), (&silence, "corrupt")] {
        let mut setup = right.clone();
        setup.each(spoil);
        let answer = answer(&setup, false);
        for said in [kind, "no common mistake explains more"] {
            assert!(answer.check.text.contains(said), "{}", answer.check.text);
        }
        assert!(answer.run.text.contains("are left out"), "{}", answer.run.text);
        let spoilt_percent = held_out_error_percent(&setup);
        assert!(
            spoilt_percent < 1.3 * error_percent,
            "{kind}: {spoilt_percent} %, {error_percent} % without"
        );
    }
}

#[test]
fn mistakes_on_simulated_recordings_are_told() {
    let right = simulated();
    for mistake in MISTAKES.iter().filter(|m| m.simulated && !NOT_TOLD.contains(&m.what)) {
        let (cures, answer) = mistaken(&right, mistake, false);
        assert!(answer.told(&cures), "{}:\n{}\n{}", mistake.what, answer.check.text, answer.run.text);
    }
}

#[test]
fn mistakes_on_a_real_robot_are_told() {
    let Some(right) = real() else { return };
    let asked = std::env::var("AURT_MISTAKES").unwrap_or_default();
    let (all, diagnose) = (matches!(&*asked, "all" | "diagnosed"), asked == "diagnosed");
    let some = !asked.is_empty() && !all;
    let of_share = MISTAKES.iter().step_by(if all { 1 } else { SHARE });
    let chosen: Vec<&Mistake> = if some {
        MISTAKES.iter().filter(|m| m.what.contains(&*asked)).collect()
    } else {
        of_share.collect()
    };
    let (mut told, mut confident) = (0, Vec::new());
    println!("| mistake | check | run | diagnose |\n|---|---|---|---|");
    let answers: Vec<_> = chosen.par_iter().map(|mistake| mistaken(&right, mistake, diagnose)).collect();
    for (mistake, (cures, answer)) in chosen.iter().zip(&answers) {
        told += usize::from(answer.told(cures));
        if answer.is_confident() && !answer.told(cures) {
            confident.push(mistake.what);
        }
        let diagnose = answer.diagnose.as_ref().map_or("–", |d| d.short(cures));
        let (check, run) = (answer.check.short(cures), answer.run.short(cures));
        println!("| {} | {check} | {run} | {diagnose} |", mistake.what);
    }
    println!(
        "{told} of {} told with the cure; {} answered with a model without a word: {confident:?}",
        chosen.len(),
        confident.len()
    );
    confident.retain(|what| !NOT_TOLD.contains(what));
    assert_eq!(confident, Vec::<&str>::new());
    let least = if all { TOLD } else { chosen.len() * TOLD / MISTAKES.len() };
    assert!(told >= least, "{told} of {}", chosen.len());
}
