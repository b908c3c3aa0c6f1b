//! Experiments with a `[drive]`: commands and positions instead of torques.

use std::fmt::Write;
use std::path::Path;

use crate::Experiment;
use aurt::Progress;
use aurt::data::Source;
use aurt_calibration::drives::{
    DriveRecording, DrivenArm, DrivenJoint, OutputErrorFit, Undetermined, output_error, stem,
};
use aurt_calibration::with_deviation;
use aurt_files::output::pretty;
use aurt_rbd::JointKind;
use aurt_recording::RobotJoints;
use aurt_report::rendering::table::Table;
use aurt_report::rendering::text::wrapped;
use aurt_traits::{Command, RobotNames};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::workbench::failure::Failure;

mod checking;
mod diagnosing;
mod doubts;
mod exporting;
mod fits;
mod gravity;
mod isaac;
mod rival;
mod second_opinion;
mod setting;

pub use checking::check_drives;
pub(in crate::workbench) use diagnosing::DiagnosedSetting;
pub use diagnosing::{IMPROVED_DRIVE_FILE, diagnose_drives};
pub use second_opinion::second_opinion;

use setting::{Read, Setting, of_drive, read};

pub const DRIVE_FILE: &str = "drive_calibrated.json";

/// What [`DRIVE_FILE`] holds.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CalibratedDrive {
    /// Version of the file, 1.
    pub drive_schema: u32,
    /// The joints' names, base first; empty where they have none.
    pub joint_names: Vec<String>,
    pub arm: DrivenArm,
}

impl CalibratedDrive {
    /// Reads a calibrated arm; none if the file is another kind of model.
    pub fn read(path: &Path) -> Result<Option<Self>, Failure> {
        let text = aurt_files::read_text(path, aurt_files::MOST_TEXT_BYTES).unwrap_or_default();
        let Ok(value) = serde_json::from_str::<Value>(&text) else { return Ok(None) };
        Self::from_document(path, &value)
    }

    /// The calibrated arm in what was read of a file; none if it is another kind of model. `path` is what errors call it.
    pub fn from_document(path: &Path, value: &Value) -> Result<Option<Self>, Failure> {
        let unfit = |reason: String| Failure::unfit(path, reason, format!("name {DRIVE_FILE} of `aurt run`"));
        if value.get("drive_schema").is_none() {
            return Ok(None);
        }
        let read = Self::deserialize(value).map_err(|e| unfit(e.to_string()))?;
        if read.drive_schema != 1 {
            return Err(unfit(format!("has drive_schema {}, this program reads 1", read.drive_schema)));
        }
        read.arm.validate().map_err(|e| unfit(e.to_string()))?;
        Ok(Some(read))
    }

    fn of(experiment: &Experiment, arm: DrivenArm) -> Self {
        Self { drive_schema: 1, joint_names: experiment.robot.joint_names.clone(), arm }
    }

    fn to_file(&self, experiment: &Experiment) -> Result<Vec<u8>, Failure> {
        let saved = serde_json::to_value(self);
        let saved = saved.map_err(|e| Failure::unfit(&experiment.path, e.to_string(), REMEDY))?;
        Ok(pretty(&saved).into_bytes())
    }

    pub fn names(&self) -> RobotNames<'_> {
        RobotNames::of_joints(&self.joint_names)
    }

    pub fn robot_joints(&self) -> RobotJoints {
        let joints = self.arm.chain.joints();
        RobotJoints {
            count: self.arm.joints.len(),
            names: self.joint_names.clone(),
            branches: Vec::new(),
            sliding: joints.iter().map(|joint| joint.kind == JointKind::Prismatic).collect(),
        }
    }

    /// The positions of a rollout over a recording of commands, as a table with a row for each row of it, and what to note.
    pub fn rollout_file(&self, source: Source) -> Result<(Vec<u8>, Vec<String>), Failure> {
        let read = read(source, &self.robot_joints(), &self.arm)?;
        let simulated = self
            .arm
            .rollout(&read.recording)
            .map_err(|e| Failure::unfit(&read.file, e.to_string(), REMEDY))?;
        Ok((table(&read.recording, &simulated), [read.notes, read.doubts].concat()))
    }
}

#[derive(Debug)]
pub struct DriveOutcome {
    pub text: String,
    pub json: Value,
    pub files: Vec<(String, Vec<u8>)>,
    /// Whether something is doubtful or missing.
    pub findings: bool,
}

const REMEDY: &str = "look at the recording's command and position, and at [drive]";

/// Estimates the drives of an experiment, and rolls out all its recordings.
pub fn fit_drives(experiment: &Experiment, progress: &Progress) -> Result<DriveOutcome, Failure> {
    let setting = Setting::read(experiment, progress)?;
    progress.step("simulating the closed loop");
    let [fitted, _] = setting.parts();
    let (options, recordings, mut notes) = (&setting.options, &setting.recordings, setting.notes.clone());
    let fit = output_error(&setting.arm, setting.selection, &fitted, options)
        .map_err(|error| setting.failed(&error))?;
    if !fit.converged {
        notes.push(format!("the search ended after {} steps without converging", fit.iterations));
    }
    let mut outcome =
        DriveOutcome { text: String::new(), json: json!({}), files: Vec::new(), findings: false };
    let mut judged = Vec::new();
    for (k, read) in recordings.iter().enumerate() {
        progress.step(format!("rolling out {}", read.label));
        let simulated =
            fit.arm.rollout(&read.recording).map_err(|e| of_drive(&e, experiment, &recordings[k..]))?;
        judged.push(Judged::of(&fit.arm, read, &simulated));
        let stem =
            Path::new(&read.label).file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
        let mut name = format!("rollout_{stem}.csv");
        if outcome.files.iter().any(|(taken, _)| *taken == name) {
            name = format!("rollout_{stem}_{k}.csv");
        }
        outcome.files.push((name, table(&read.recording, &simulated)));
    }
    let model = CalibratedDrive::of(experiment, fit.arm.clone());
    outcome.files.push((DRIVE_FILE.to_owned(), model.to_file(experiment)?));
    let mut doubts = setting.doubts();
    doubts.extend(doubts::of_rollouts(&judged, options.deviation_rad, model.names()));
    let turned = gravity::upside_down(&fit.arm, &setting.all(), options);
    doubts.extend(turned.map_err(|error| setting.failed(&error))?);
    outcome.findings = !doubts.is_empty();
    outcome.text = text(&fit, &judged, &notes, model.names()) + &warnings(&doubts);
    outcome.json = to_json(&fit, &judged, &notes);
    outcome.json["warnings"] = json!(doubts);
    outcome.files.push(("metrics.json".to_owned(), pretty(&outcome.json).into_bytes()));
    Ok(outcome)
}

fn warnings(doubts: &[String]) -> String {
    doubts.iter().map(|doubt| format!("warning: {doubt}\n")).collect()
}

fn note_lines(notes: &[String]) -> String {
    notes.iter().map(|note| format!("note: {note}\n")).collect()
}

/// Lines on numbers that recordings leave open, each with its end.
fn open_lines(undetermined: &[Undetermined], end: impl Fn(&Undetermined) -> String) -> String {
    let lines: String = undetermined.iter().map(|open| format!("  {open}{}\n", end(open))).collect();
    if lines.is_empty() { lines } else { format!("\nleft open by these recordings\n{lines}") }
}

/// From this size on a limit is none.
const UNLIMITED: f64 = 1e9;

fn number_of(joint: &DrivenJoint, key: &str) -> Option<f64> {
    joint.drive.parameters().iter().find(|p| p.parameter.name == key).map(|p| p.value)
}

/// The braking of a joint's drive: K_d, which acts within the limit of its torque, and K_e, behind it.
fn braking(joint: &DrivenJoint) -> [f64; 2] {
    let keys = match joint.drive.name() {
        "pd_law" => ["damping_nm_s_per_rad", ""],
        _ => ["firmware_damping_nm_s_per_rad", "back_emf_nm_s_per_rad"],
    };
    keys.map(|key| number_of(joint, key).unwrap_or(0.0))
}

fn values(arm: &DrivenArm) -> Vec<f64> {
    arm.numbers().iter().map(|n| n.value).collect()
}

fn table(recording: &DriveRecording, simulated: &[Vec<f64>]) -> Vec<u8> {
    let mut text = "time".to_owned();
    for name in ["q_simulated", "q", "command"] {
        (0..simulated.len()).for_each(|j| text.push_str(&format!(",{name}_{j}")));
    }
    text.push('\n');
    let first = recording.first;
    for k in first..recording.time_s.len() {
        text.push_str(&recording.time_s[k].to_string());
        for (series, k) in [(simulated, k - first), (&recording.position_rad, k), (&recording.command, k)] {
            series.iter().for_each(|s| text.push_str(&format!(",{}", s[k])));
        }
        text.push('\n');
    }
    text.into_bytes()
}

/// How well a rollout meets its recording.
struct Judged {
    label: String,
    held_out: bool,
    samples: usize,
    rms: Vec<f64>,
    /// Deviation of the positions from their mean.
    spread: Vec<f64>,
    /// Error of the command itself, where it is a position.
    command_rms: Option<f64>,
}

impl Judged {
    fn of(arm: &DrivenArm, read: &Read, simulated: &[Vec<f64>]) -> Self {
        let rms = |a: &[f64], b: &[f64]| {
            (a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len().max(1) as f64).sqrt()
        };
        let first = read.recording.first;
        let pairs = |a: &[Vec<f64>]| -> Vec<f64> {
            a.iter().zip(&read.recording.position_rad).map(|(a, b)| rms(a, &b[first..])).collect()
        };
        Self {
            label: read.label.clone(),
            held_out: read.held_out,
            samples: read.recording.time_s.len() - first,
            rms: pairs(simulated),
            spread: read.recording.position_rad.iter().map(|q| deviation(&q[first..])).collect(),
            command_rms: follows_positions(arm).then(|| {
                let sent: Vec<Vec<f64>> =
                    read.recording.command.iter().map(|c| c[first..].to_vec()).collect();
                over_joints(&pairs(&sent))
            }),
        }
    }
}

fn follows_positions(arm: &DrivenArm) -> bool {
    arm.joints.iter().all(|j| j.drive.command() == Command::Position)
}

fn deviation(series: &[f64]) -> f64 {
    let mean = series.iter().sum::<f64>() / series.len().max(1) as f64;
    (series.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / series.len().max(1) as f64).sqrt()
}

fn over_joints(rms: &[f64]) -> f64 {
    (rms.iter().map(|r| r * r).sum::<f64>() / rms.len().max(1) as f64).sqrt()
}

/// Over all samples of the recordings that are held out, or of the others.
fn together(judged: &[Judged], held_out: bool, of: impl Fn(&Judged) -> Option<f64>) -> Option<f64> {
    let chosen: Vec<&Judged> = judged.iter().filter(|j| j.held_out == held_out).collect();
    let samples: usize = chosen.iter().map(|j| j.samples).sum();
    let squares: Option<f64> = chosen.iter().map(|j| of(j).map(|r| r * r * j.samples as f64)).sum();
    squares.filter(|_| samples > 0).map(|s| (s / samples as f64).sqrt())
}

/// The name of a number of a drive, which ends with its joint, with the name of that: `gain_nm_per_rad of elbow`.
fn of_joint(number: &str, names: RobotNames<'_>) -> String {
    let key = stem(number);
    let joint = number[key.len()..].strip_prefix('_').and_then(|joint| joint.parse::<usize>().ok());
    match joint.filter(|joint| *joint < names.joints.len()) {
        Some(joint) => format!("{key} of {}", names.joint(joint)),
        None => number.to_owned(),
    }
}

fn text(fit: &OutputErrorFit, judged: &[Judged], notes: &[String], names: RobotNames<'_>) -> String {
    let mut text =
        String::from("estimated from commands and positions by output error, with one standard deviation\n");
    let mut table = Table::new(["number", "value", "unit", ""]).left(1).remark();
    for number in &fit.numbers {
        let bound = if number.at_bound { "at its bound" } else { "" };
        let value = with_deviation(number.value, number.deviation);
        table.row([of_joint(&number.name, names), value, number.unit.to_string(), bound.to_owned()]);
    }
    text.push_str(&table.render());
    text.push_str(&open_lines(&fit.undetermined, |_| String::new()));
    text.push_str("\nrollout from the command alone, rms of the position by joint in 1e-3 rad or mm\n");
    if !names.joints.is_empty() {
        let joints: Vec<usize> = (0..names.joints.len()).collect();
        text.push_str(&wrapped(&format!("joints in this order: {}", names.joint_list(&joints))));
    }
    for recording in judged {
        let kind = if recording.held_out { "held-out" } else { "fitted" };
        let rms: String = recording.rms.iter().map(|r| format!("{:8.2}", 1e3 * r)).collect();
        let command = recording.command_rms.map_or_else(String::new, |c| format!(", command {:.2}", 1e3 * c));
        let _ = writeln!(
            text,
            "  {kind:9}{rms}  together {:.2}{command}  {}",
            1e3 * over_joints(&recording.rms),
            recording.label
        );
    }
    for (name, held_out) in [("fitted", false), ("held-out", true)] {
        if let Some(all) = together(judged, held_out, |j| Some(over_joints(&j.rms))) {
            let command = together(judged, held_out, |j| j.command_rms);
            let command = command.map_or_else(String::new, |c| format!(", command {:.2}", 1e3 * c));
            let _ = writeln!(text, "  {name}, all samples: {:.2}{command}", 1e3 * all);
        }
    }
    text + &note_lines(notes)
}

fn to_json(fit: &OutputErrorFit, judged: &[Judged], notes: &[String]) -> Value {
    let numbers = fit.numbers.iter().map(|n| {
        json!({ "name": n.name, "value": n.value, "deviation": n.deviation, "unit": n.unit, "start": n.start,
                "start_deviation": n.start_deviation, "at_bound": n.at_bound })
    });
    let recordings = judged.iter().map(|j| {
        json!({ "recording": j.label, "held_out": j.held_out, "rms": j.rms, "rms_all_joints": over_joints(&j.rms),
                "command_rms": j.command_rms, "samples": j.samples })
    });
    json!({
        "estimator": "output_error",
        "numbers": numbers.collect::<Vec<_>>(),
        "undetermined": fit.undetermined.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "recordings": recordings.collect::<Vec<_>>(),
        "held_out_rms": together(judged, true, |j| Some(over_joints(&j.rms))),
        "fitted_rms": together(judged, false, |j| Some(over_joints(&j.rms))),
        "iterations": fit.iterations,
        "converged": fit.converged,
        "notes": notes,
    })
}
