//! `aurt simulate`: how a calibrated model moves, or what the logger of a simulated robot writes.

use std::path::{Path, PathBuf};

use aurt::CalibratedModel;
use aurt::data::Purpose;
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::OutputFile;
use aurt_recording::Segment;
use aurt_simulation::model::{ModelDrive, ModelMotion, MovingModel};
use aurt_simulation::{ScenarioFile, simulate};
use clap::Args;
use serde_json::json;

use super::Session;
use super::data_options::ReadingOptions;
use crate::rendering::terminal::Report;
use crate::values::parse_positive;

/// Simulate a calibrated model, or a robot with chosen effects.
///
/// A calibrated model follows a commanded motion, or is driven by the measured currents or torques of a recording;
/// the output holds q, q̇ and the driving currents or torques. A scenario describes a simulated robot with sensors,
/// drives and optional effects; the output is the recording of its logger.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    aurt simulate --model rd_calibrated.json --motion trajectory.csv --out moved.csv\n  \
    aurt simulate --model rd_calibrated.json --torques measured.csv --out moved.csv\n  \
    aurt simulate --scenario scenario.toml --out recording.csv")]
#[command(group(clap::ArgGroup::new("what").required(true).args(["model", "scenario"])))]
pub struct Simulate {
    /// Calibrated robot dynamics from `aurt calibrate`, `aurt run` or `aurt diagnose`
    #[arg(long, value_name = "JSON")]
    model: Option<PathBuf>,
    /// The motion that the model is to follow
    #[arg(long, value_name = "RECORDING", conflicts_with_all = ["torques", "scenario"])]
    motion: Option<PathBuf>,
    /// A recording whose measured currents or torques drive the model
    #[arg(long, value_name = "RECORDING", conflicts_with = "scenario")]
    torques: Option<PathBuf>,
    /// Bandwidth of the controller that follows a motion
    #[arg(long, value_name = "HZ", default_value = "10", value_parser = parse_positive)]
    bandwidth_hz: f64,
    /// Scenario: a simulated robot, its motion and its effects
    #[arg(long, value_name = "SCENARIO.toml")]
    scenario: Option<PathBuf>,
    /// File for the result
    #[arg(long, value_name = "CSV")]
    out: PathBuf,
    #[command(flatten)]
    reading: ReadingOptions,
}

impl Simulate {
    pub fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        match (&self.model, &self.scenario) {
            (_, Some(scenario)) => self.scenario(scenario, session),
            (Some(model), None) => self.model(model, session),
            (None, None) => Err(Failure::argument(
                "--model",
                "there is nothing to simulate",
                "name a calibrated model, or a scenario with --scenario",
            )),
        }
    }

    fn scenario(&self, path: &Path, session: &Session<'_>) -> Result<Report, Failure> {
        let out = OutputFile::new("--out", &self.out, &[path])?;
        let scenario = ScenarioFile::read_scenario(path)?;
        let progress = session.terminal.progress(1);
        progress.step("simulating the robot");
        let recording = simulate(&scenario).map_err(|error| Failure::from(error).in_file(path))?;
        drop(progress);
        out.write(&recording.csv())?;
        let effects: Vec<&str> = scenario.effects.iter().map(|e| e.identifier()).collect();
        let with = if effects.is_empty() { "no effects".to_owned() } else { effects.join(", ") };
        Ok(Report {
            text: format!(
                "{} with {with}: {} rows at {} Hz, {} joints in {}\nwritten: {}\n",
                scenario.robot.name,
                recording.rows(),
                scenario.logger.rate_hz,
                recording.joints,
                recording.unit.symbol(),
                out.path().display()
            ),
            json: json!({
                "command": "simulate",
                "robot": scenario.robot.name,
                "effects": effects,
                "rows": recording.rows(),
                "unit": recording.unit.symbol(),
                "outputs": [out.path()],
            }),
            findings: false,
        })
    }

    fn model(&self, path: &Path, session: &Session<'_>) -> Result<Report, Failure> {
        let (file, measured) = match (&self.motion, &self.torques) {
            (Some(file), _) => (file, false),
            (None, Some(file)) => (file, true),
            (None, None) => {
                return Err(Failure::argument(
                    "--model",
                    "nothing is said of what moves it",
                    "name a motion with --motion, or a recording with --torques",
                ));
            }
        };
        let out = OutputFile::new("--out", &self.out, &[path, file])?;
        let calibrated = CalibratedModel::read(path, &session.registry)?;
        let purpose = if measured { Purpose::Validation } else { Purpose::Prediction };
        let pipeline = calibrated.pipeline();
        let loaded = pipeline.read(self.reading.source(file), purpose)?;
        if measured {
            calibrated.check_unit(&loaded)?;
        }
        let prepared = pipeline.preprocess(&loaded, purpose)?;
        let mut notes = loaded.recording.report.notes();
        notes.extend(prepared.data.report.notes());
        let segments = &prepared.data.segments;
        let longest = segments.iter().max_by_key(|s| s.motion.samples());
        let Some(segment) = longest else { return Err(nothing_to_move(file)) };
        if segments.len() > 1 {
            notes.push(format!("of {} stretches between gaps the longest is simulated", segments.len()));
        }
        let drive = self.drive(segment, measured).ok_or_else(|| nothing_to_move(file))?;
        let coefficients = calibrated.calibration.coefficients();
        let moving = MovingModel {
            model: &calibrated.model,
            coefficients: &coefficients,
            load: &calibrated.calibration.load,
        };
        let progress = session.terminal.progress(100);
        let mut shown = 0;
        let moved = moving.run(&drive, &mut |share| {
            while shown < (100.0 * share) as usize {
                progress.step("moving the model");
                shown += 1;
            }
        })?;
        drop(progress);
        let unit = calibrated.calibration.unit;
        out.write(&to_csv(&moved, unit.quantity()))?;
        let distance = distance_rad(&moved, segment);
        let away: Vec<String> = distance.iter().map(|d| format!("{d:.2e}")).collect();
        let mut text = format!(
            "{} joints over {:.2} s, driven by {}, in {}\nlargest distance from the motion in {}: {} rad\n",
            calibrated.model.joints(),
            moved.time_s.last().zip(moved.time_s.first()).map_or(0.0, |(end, start)| end - start),
            if measured {
                "what was measured, without controller"
            } else {
                "a controller that knows the model"
            },
            unit.symbol(),
            file.display(),
            away.join(" ")
        );
        text.extend(notes.iter().map(|n| format!("note: {n}\n")));
        text.push_str(&format!("written: {}\n", out.path().display()));
        Ok(Report {
            text,
            json: json!({
                "command": "simulate",
                "rows": moved.time_s.len(),
                "unit": unit.symbol(),
                "largest_distance_rad": distance,
                "evaluations": moved.evaluations,
                "notes": notes,
                "outputs": [out.path()],
            }),
            findings: false,
        })
    }

    fn drive(&self, segment: &Segment, measured: bool) -> Option<ModelDrive> {
        let motion = segment.motion.clone();
        if measured {
            let torque = segment.raw_measurement.clone()?;
            Some(ModelDrive::Torques { motion, torque })
        } else {
            Some(ModelDrive::Follow { motion, bandwidth_hz: self.bandwidth_hz })
        }
    }
}

fn nothing_to_move(file: &Path) -> Failure {
    Failure::unfit(
        file,
        "has no stretch without gaps that could be simulated",
        "use a recording of a second or more",
    )
}

/// Largest distance between the simulated motion and that of the recording, joint by joint.
fn distance_rad(moved: &ModelMotion, segment: &Segment) -> Vec<f64> {
    let motion = segment.motion.view();
    let far = |j: usize| {
        moved.position_rad[j]
            .iter()
            .zip(motion.position_rad(j))
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max)
    };
    (0..motion.joints()).map(far).collect()
}

/// `time, q_0, …, qd_0, …, torque_0, …` (or `current_0`).
fn to_csv(moved: &ModelMotion, quantity: &str) -> Vec<u8> {
    let joints = moved.position_rad.len();
    let mut text = String::from("time");
    for family in ["q", "qd", quantity] {
        text.extend((0..joints).map(|j| format!(",{family}_{j}")));
    }
    text.push('\n');
    for (k, time_s) in moved.time_s.iter().enumerate() {
        text.push_str(&format!("{time_s:.6}"));
        for family in [&moved.position_rad, &moved.velocity_rad_s, &moved.torque] {
            text.extend(family.iter().map(|series| format!(",{:.9}", series[k])));
        }
        text.push('\n');
    }
    text.into_bytes()
}
