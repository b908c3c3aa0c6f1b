//! Mistakes of users, and whether `aurt` tells them with the cure.
//!
//! A share of them is made on recordings of the demo's robot in every test run, another on those of a real UR10e where
//! AURT_DATA is set. All of them, as the table of docs/mistakes.md:
//! `AURT_MISTAKES=all cargo test --release --test mistakes -- --nocapture`; with `diagnosed` in the place of `all` also what
//! `diagnose` says, with anything else those whose description contains it.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod usual;
mod world;

use std::{
    path::{Path, PathBuf},
    process::Command,
};

use rayon::prelude::*;
use usual::{MISTAKES, Mistake};
use world::{Log, NAMES, World};

/// Of the mistakes on the real robot, every how manieth is in the share of every test run.
const SHARE: usize = 9;
/// Mistakes on the real robot that are told with their cure, at least.
const TOLD: usize = 55;

/// Mistakes that data cannot tell (docs/mistakes.md).
const NOT_TOLD: [&str; 1] = ["the name of a smaller robot of the same family"];

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
    fn told(&self, mistake: &Mistake) -> bool {
        [&self.check, &self.run].into_iter().any(|said| said.tells(mistake))
    }

    /// Whether a model came out without a word that something is wrong.
    fn is_confident(&self) -> bool {
        self.run.status == 0
    }
}

impl Said {
    fn tells(&self, mistake: &Mistake) -> bool {
        let has = |cure: &[&str]| cure.iter().all(|word| self.text.contains(word));
        self.status != 0 && mistake.cures.iter().any(|cure| has(cure))
    }

    /// For the table: what it ended with, and whether it told the cure.
    fn short(&self, mistake: &Mistake) -> &'static str {
        match (self.status, self.tells(mistake)) {
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

fn answer(world: &World, diagnose: bool) -> Answer {
    let folder = tempfile::tempdir().unwrap();
    world.write(folder.path());
    let check = aurt(folder.path(), &["check", "experiment.toml"]);
    let run = aurt(folder.path(), &["run", "experiment.toml", "--out", "out"]);
    let diagnose =
        diagnose.then(|| aurt(folder.path(), &["diagnose", "experiment.toml", "--out", "diagnosis"]));
    Answer { check, run, diagnose }
}

fn world(files: [PathBuf; 3], table: &Path, joints: usize, f_dyn_hz: f64) -> World {
    let cells = |line: &str| line.split(',').map(|c| c.trim().to_owned()).collect();
    World {
        logs: files.iter().map(|f| Log::read(f, joints)).collect(),
        table: std::fs::read_to_string(table).unwrap().lines().filter(|l| !l.is_empty()).map(cells).collect(),
        robot: vec!["gravity_m_s2 = [0.0, 0.0, -9.81]".into()],
        geometry: "mdh = \"mdh.csv\"".into(),
        recorded: Vec::new(),
        calibration: format!("[\"{}\", \"{}\"]", NAMES[0], NAMES[1]),
        validation: format!("[\"{}\"]", NAMES[2]),
        f_dyn_hz,
        rest: String::new(),
        text: None,
    }
}

/// A UR10e as it was logged.
fn real() -> Option<World> {
    let Some(data) = std::env::var_os("AURT_DATA").map(PathBuf::from).filter(|d| d.is_dir()) else {
        println!(
            "skipped: mistakes on a UR10e need real recordings in the folder AURT_DATA (docs/real-recordings.md)"
        );
        return None;
    };
    let file = |name: &str| data.join("ur10e").join(name);
    let files = ["excitation_30s.csv", "unloaded_50s.csv", "excitation_20s.csv"].map(file);
    let mut world = world(files, &file("mdh.csv"), 6, 2.5);
    world.set("torque_constants_nm_per_a", "[11.976, 11.976, 9.839, 10.763, 10.763, 10.763]");
    Some(world)
}

fn simulated(folder: &Path) -> World {
    assert_eq!(aurt(folder, &["demo", "--out", "demo"]).status, 0);
    let demo = folder.join("demo");
    let files = ["exciting_motion.csv", "other_motion.csv", "point_to_point.csv"].map(|n| demo.join(n));
    let mut world = world(files, &demo.join("mdh.csv"), 6, 5.0);
    world.set("torque_constants_nm_per_a", "[11.976, 11.976, 9.839, 10.763, 10.763, 10.763]");
    world
}

#[test]
fn without_a_mistake_nothing_is_told() {
    let folder = tempfile::tempdir().unwrap();
    for world in [Some(simulated(folder.path())), real()].into_iter().flatten() {
        let answer = answer(&world, false);
        assert_eq!(answer.run.status, 0, "{}", answer.run.text);
        assert!(answer.check.text.contains("no common mistake explains more"), "{}", answer.check.text);
    }
}

/// The largest held-out error of a joint while it moves, % of its signal, after `aurt run`.
fn held_out_error_percent(world: &World) -> f64 {
    let folder = tempfile::tempdir().unwrap();
    world.write(folder.path());
    let said = aurt(folder.path(), &["run", "experiment.toml", "--out", "out"]);
    assert_eq!(said.status, 0, "{}", said.text);
    let metrics = std::fs::read(folder.path().join("out/metrics.json")).unwrap();
    let metrics: serde_json::Value = serde_json::from_slice(&metrics).unwrap();
    let recordings = metrics["recordings"].as_array().unwrap().iter().filter(|r| r["role"] == "validation");
    let errors = recordings.flat_map(|r| r["moving"]["nrmse"].as_array().unwrap().clone());
    100.0 * errors.map(|e| e.as_f64().unwrap()).fold(0.0, f64::max)
}

#[test]
fn rows_that_are_held_or_without_measurement_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let right = simulated(folder.path());
    let error_percent = held_out_error_percent(&right);
    // 19 rows of 400 repeat the one before; a measurement of five is zero on all joints.
    let hold = |log: &mut Log| {
        for rows in log.rows.chunks_exact_mut(400) {
            for k in 301..320 {
                let (before, row) = rows.split_at_mut(k);
                row[0][1..].clone_from_slice(&before[300][1..]);
            }
        }
    };
    let silence = |log: &mut Log| {
        let first = log.measurement(0);
        log.rows.iter_mut().skip(3).step_by(5).for_each(|row| row[first..].fill(0.0));
    };
    for (spoil, kind) in [(&hold as &dyn Fn(&mut Log), "held"), (&silence, "corrupt")] {
        let mut world = right.clone();
        world.each(|log| spoil(log));
        let answer = answer(&world, false);
        for said in [kind, "no common mistake explains more"] {
            assert!(answer.check.text.contains(said), "{}", answer.check.text);
        }
        assert!(answer.run.text.contains("are left out"), "{}", answer.run.text);
        let spoilt_percent = held_out_error_percent(&world);
        assert!(
            spoilt_percent < 1.3 * error_percent,
            "{kind}: {spoilt_percent} %, {error_percent} % without"
        );
    }
}

#[test]
fn mistakes_on_simulated_recordings_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let right = simulated(folder.path());
    for mistake in MISTAKES.iter().filter(|m| m.simulated && !NOT_TOLD.contains(&m.what)) {
        let mut world = right.clone();
        (mistake.make)(&mut world);
        let answer = answer(&world, false);
        assert!(answer.told(mistake), "{}:\n{}\n{}", mistake.what, answer.check.text, answer.run.text);
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
    let answers: Vec<Answer> = chosen
        .par_iter()
        .map(|mistake| {
            let mut world = right.clone();
            (mistake.make)(&mut world);
            answer(&world, diagnose)
        })
        .collect();
    for (mistake, answer) in chosen.iter().zip(answers) {
        told += usize::from(answer.told(mistake));
        if answer.is_confident() && !answer.told(mistake) {
            confident.push(mistake.what);
        }
        let diagnose = answer.diagnose.as_ref().map_or("–", |d| d.short(mistake));
        let (check, run) = (answer.check.short(mistake), answer.run.short(mistake));
        println!("| {} | {check} | {run} | {diagnose} |", mistake.what);
        if std::env::var_os("AURT_MISTAKES_VERBOSE").is_some() && !answer.told(mistake) {
            let end =
                |t: &str| t.chars().rev().take(900).collect::<Vec<_>>().into_iter().rev().collect::<String>();
            println!("  check: {}\n  run: {}", end(&answer.check.text), end(&answer.run.text));
        }
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
