//! Bytes of any kind, given to everything that reads files: refused with a sentence, or read into something finite.
//!
//! Each function panics where a reader does, and where what is read is not finite. The fuzzer (`fuzz/`) finds the bytes;
//! the test `corpus` gives those that were found to them again.

#![expect(clippy::expect_used, reason = "what has no folder to work in can only give up")]

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use aurt::prelude::*;
use aurt::simulate;
use aurt::simulation::{Motion, Scenario, ScenarioFile, robots};
use aurt_experiment::Experiment;
use aurt_experiment::workbench::experiments::fit_experiment;
use aurt_lab::case::Plan;
use aurt_plugins::Registry;
use aurt_recording::preprocess;
use tempfile::TempDir;

/// What is given bytes, and its name: that of its folder in `fuzz/corpus`.
pub type Target = (&'static str, fn(&[u8]));

/// All of them.
pub const TARGETS: [Target; 5] = [
    ("recording", recording),
    ("robot", robot),
    ("experiment", experiment),
    ("scenario", scenario),
    ("saved_model", saved_model),
];

const GRAVITY_M_S2: [f64; 3] = [0.0, 0.0, -9.81];
/// Inputs that are longer take time and show nothing else.
const MOST_BYTES: usize = 1 << 16;
/// Recordings beyond are read and not preprocessed.
const MOST_SAMPLES: usize = 5000;
const MOST_JOINTS: usize = 20;
const MDH: &str = "alpha,a,d\n0,0.5,0\n0,0.4,0\n";

/// A table in any format: read, and preprocessed if it is short.
pub fn recording(data: &[u8]) {
    if data.len() > MOST_BYTES {
        return;
    }
    let recording = match Recording::read(file("recording", data)) {
        Ok(recording) => recording,
        Err(error) => return said(&error),
    };
    assert!(recording.duration_s().is_finite());
    if recording.samples() > MOST_SAMPLES || recording.joints() > MOST_JOINTS {
        return;
    }
    match preprocess(&recording, &PreprocessOptions::new(2.0)) {
        Ok(prepared) => {
            for segment in &prepared.segments {
                let motion = segment.motion.view();
                assert!(
                    (0..recording.joints()).all(|j| motion.position_rad(j).iter().all(|q| q.is_finite()))
                );
            }
        }
        Err(error) => said(&error),
    }
}

/// A description of an arm: URDF, MJCF, or a table of Denavit and Hartenberg.
pub fn robot(data: &[u8]) {
    let Some(text) = text(data) else { return };
    let found = if text.trim_start().starts_with('<') {
        Robot::from_urdf(text, None, None, GRAVITY_M_S2)
    } else {
        Robot::from_mdh(text, GRAVITY_M_S2)
    };
    match found {
        Ok(robot) => match robot.model().build() {
            Ok(model) => assert!(model.parameters().len() >= robot.base_parameters().len()),
            Err(error) => said(&error),
        },
        Err(error) => said(&error),
    }
}

/// An experiment beside a table and two recordings of 9 s: read, assembled and calibrated.
pub fn experiment(data: &[u8]) {
    let Some(text) = text(data) else { return };
    let mut registry = Registry::linked().expect("linked models register");
    match Experiment::parse(text, &folder().join("e.toml"), &mut registry) {
        Ok(experiment) => match fit_experiment(&experiment, &Progress::silent()) {
            Ok(outcome) => {
                let parameters = &outcome.calibrated.calibration.parameters;
                assert!(parameters.iter().all(|p| p.value.is_finite()), "{text}");
            }
            Err(error) => said(&error),
        },
        Err(errors) => said(&errors),
    }
}

/// A scenario, and a plan of concealed cases.
pub fn scenario(data: &[u8]) {
    let Some(text) = text(data) else { return };
    match ScenarioFile::parse(text, "scenario.toml").and_then(|file| file.scenario()) {
        Ok(scenario) => assert!(scenario.trajectory.duration_s().is_finite()),
        Err(error) => said(&error),
    }
    match Plan::parse(text, "plan.toml") {
        Ok(plan) => match plan.requests(1) {
            Ok(requests) => assert!(requests.len() <= 1_000_000),
            Err(error) => said(&error),
        },
        Err(error) => said(&error),
    }
}

/// A calibrated model: read, and used for a recording.
pub fn saved_model(data: &[u8]) {
    if data.len() > MOST_BYTES {
        return;
    }
    let predicted = CalibratedModel::load(file("model.json", data)).and_then(|model| {
        let recording = Recording::read(folder().join("b.csv"))?;
        model.predict_at_stamps(&recording)
    });
    match predicted {
        // Rows without a prediction are NaN.
        Ok(torques) => assert!(!torques.iter().flatten().any(|t| t.is_infinite())),
        Err(error) => said(&error),
    }
}

fn said(error: &dyn std::fmt::Display) {
    assert!(!error.to_string().is_empty());
}

fn text(data: &[u8]) -> Option<&str> {
    std::str::from_utf8(data).ok().filter(|text| text.len() <= MOST_BYTES)
}

fn file(name: &str, data: &[u8]) -> PathBuf {
    let path = folder().join(name);
    fs::write(&path, data).expect("the folder of inputs can be written");
    path
}

/// The folder of this process, with the files that experiments name.
fn folder() -> &'static Path {
    static FOLDER: OnceLock<TempDir> = OnceLock::new();
    let made = || {
        let folder = TempDir::new().expect("there is a folder for temporary files");
        fs::write(folder.path().join("mdh.csv"), MDH).expect("the folder can be written");
        for (name, seed) in [("a.csv", 1), ("b.csv", 2)] {
            fs::write(folder.path().join(name), recorded(seed)).expect("the folder can be written");
        }
        folder
    };
    FOLDER.get_or_init(made).path()
}

/// 9 s of a simulated arm of two links, as text.
fn recorded(seed: u64) -> String {
    let arm = robots::two_link();
    let motion = Motion::MultiSine { duration_s: 9.0, harmonics: 4, top_hz: 1.0, share: 0.6 };
    let trajectory = motion.plan(&arm, seed).expect("the motion is possible");
    let mut scenario = Scenario::new(arm, trajectory, seed);
    scenario.logger.rate_hz = 60.0;
    let recording = simulate(&scenario).expect("the arm moves");
    let measured = recording.measurement.as_ref().expect("the arm measures");
    let mut table = String::from("timestamp q_0 q_1 torque_0 torque_1\n");
    for (k, t) in recording.time_s.iter().enumerate() {
        let series = recording.position_rad.iter().chain(measured);
        let cells: Vec<String> = series.map(|s| format!("{:.6}", s[k])).collect();
        table += &format!("{t:.6} {}\n", cells.join(" "));
    }
    table
}
