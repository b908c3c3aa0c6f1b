//! `aurt check`: what a recording is good for, before anyone calibrates on it.

use std::path::PathBuf;

use aurt_calibration::{CalibrationOptions, NamedRecording, accumulate};
use aurt_diagnosis::RecordingFaults;
use aurt_plugins::{BASE_PARAMETER_SEED, Registry, RigidBodyDynamics};
use aurt_rbd::MdhTable;
use aurt_recording::{Preprocessed, Segment};
use aurt_traits::{CoulombModel, HysteresisModel, JointStack, LoadTorque, ModelError, Motion, ViscousBasis};
use clap::Args;
use serde_json::json;

use super::{
    Session,
    compile_rbd::Rows,
    compile_rd::build,
    data_options::ReadingOptions,
    run::{drawn_text, written_text},
};
use crate::{
    arguments::{Gravity, parse_gravity, parse_positive},
    data::{Instrument, Loaded, Pipeline, Preprocessing, Purpose},
    failure::Failure,
    inspection::{
        excitation::judge,
        joints::{JointReport, suitable_f_dyn_hz, tables},
        judged::Judged,
    },
    output::OutputFolder,
    rendering::{
        number::significant,
        terminal::{Emphasis, Report},
        text::wrapped,
    },
    reports::{self, PlotOptions, recording::Checked},
};

/// A condition number above this means that some combination of parameters is nearly undetermined.
const LARGE_CONDITION_NUMBER: f64 = 100.0;
/// f_dyn unless asked for otherwise, and the share of the sampling rate that it must stay below.
const DEFAULT_F_DYN_HZ: f64 = 10.0;
const F_DYN_SHARE_OF_RATE: f64 = 0.05;

/// Check a recording before calibrating on it.
///
/// Says how it was sampled, what each joint covers and how its sensors are, and, with the robot's geometry, which
/// parameters its motion can determine. Exit status 1 if something should be heeded.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt check recording.csv\n  \
    aurt check recording.csv --mdh mdh.csv --gravity 0 0 -9.81 --out check")]
pub struct Check {
    /// The recording
    #[arg(value_name = "CSV")]
    recording: PathBuf,
    /// Table of modified Denavit–Hartenberg parameters: tells which parameters the motion can determine
    #[arg(long, value_name = "CSV")]
    mdh: Option<PathBuf>,
    /// Which joint a row's alpha and a lead to
    #[arg(long, value_enum, default_value_t, requires = "mdh")]
    mdh_rows: Rows,
    /// Gravitational acceleration in the base frame, m/s²
    #[arg(
        long, value_name = "X Y Z", value_parser = parse_gravity, allow_hyphen_values = true,
        default_value = "0 0 -9.81", requires = "mdh"
    )]
    gravity: Gravity,
    /// Highest frequency of the robot's dynamics to look at; by default 10, less for slow recordings
    #[arg(long, value_name = "HZ", value_parser = parse_positive)]
    f_dyn_hz: Option<f64>,
    /// Folder for report.html, the same with pictures; created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    plots: PlotOptions,
    #[command(flatten)]
    reading: ReadingOptions,
}

impl Check {
    /// Checks.
    pub fn run(&self, session: &Session<'_>) -> Result<Report, Failure> {
        let folder = self.out.as_deref().map(|out| OutputFolder::new("--out", out)).transpose()?;
        let plots = self.plots.folder()?;
        let table = self.mdh.as_ref().map(|p| MdhTable::from_path(p, self.mdh_rows.into())).transpose()?;
        let mut preprocessing = preprocessing(self.f_dyn_hz.unwrap_or(DEFAULT_F_DYN_HZ));
        let instrument = Instrument::default();
        let joints = table.as_ref().map(|t| t.rows.len());
        let loaded = Loaded::read(self.reading.source(&self.recording), joints, Purpose::Prediction)?;
        if self.f_dyn_hz.is_none() {
            preprocessing.f_dyn_hz = DEFAULT_F_DYN_HZ.min(F_DYN_SHARE_OF_RATE * median_rate_hz(&loaded));
            preprocessing.f_dyn_hz = (preprocessing.f_dyn_hz * 1e3).round() / 1e3;
        }
        let joints = loaded.recording.joints();
        let prepared = Pipeline { joints, preprocessing: &preprocessing, instrument: &instrument }
            .preprocess(&loaded, Purpose::Validation)?
            .data;
        let reports = JointReport::of(&loaded.recording, &prepared, preprocessing.rest_velocity_rad_s);
        let judged = match &table {
            Some(table) => Some(self.excitation(session, table, &prepared, &reports)?),
            None => None,
        };
        let findings = findings(&loaded, &prepared, &reports, judged.as_ref());
        let mut report = self.report(session, &loaded, &prepared, &reports, judged.as_ref(), &findings);
        if folder.is_some() || plots.is_some() {
            let mut notes = loaded.recording.report.notes();
            notes.extend(prepared.report.notes());
            let page = Checked {
                name: &loaded.source.label,
                recording: &loaded.recording,
                prepared: &prepared,
                joints: &reports,
                excited: judged.as_ref().map(Judged::named),
                findings: &findings,
                notes: &notes,
                suitable_f_dyn_hz: suitable_f_dyn_hz(&reports, prepared.report.rate_hz),
                document: &report.json,
            }
            .page();
            let mut written = Vec::new();
            if let Some(folder) = &folder {
                folder.write(&[(reports::FILE.to_owned(), page.to_html().into_bytes())])?;
                written.push(folder.path().join(reports::FILE));
            }
            let drawn = reports::write_plots(&page, plots.as_ref())?;
            report.text.push_str(&written_text(&written));
            report.text.push_str(&drawn_text(&drawn, plots.as_ref()));
            written.extend(drawn);
            report.json["outputs"] = json!(written);
        }
        Ok(report)
    }

    /// Which parameters of rigid bodies, Coulomb and viscous friction the motion determines.
    fn excitation(
        &self,
        session: &Session<'_>,
        table: &MdhTable,
        prepared: &Preprocessed,
        reports: &[JointReport],
    ) -> Result<Judged, Failure> {
        let dynamics = RigidBodyDynamics::from_mdh(table, self.gravity.0, BASE_PARAMETER_SEED)?;
        let stacks = vec![plain_friction(&session.registry)?; reports.len()];
        let model = dynamics.with_joint_dynamics(stacks, Vec::new())?;
        let segments: Result<Vec<Segment>, ModelError> =
            prepared.segments.iter().map(|s| without_resting_joints(s, reports)).collect();
        let segments = segments.map_err(|e| Failure::Models(vec![e]))?;
        let data = Preprocessed { segments, report: prepared.report.clone() };
        let recording = NamedRecording { name: self.recording.display().to_string(), data };
        let load = LoadTorque::Fitted(vec![0.0; model.parameters().len()]);
        let system = accumulate(&model, &[recording], &load, &CalibrationOptions::default())?;
        Ok(Judged { excited: judge(&system), model })
    }

    fn report(
        &self,
        session: &Session<'_>,
        loaded: &Loaded,
        prepared: &Preprocessed,
        reports: &[JointReport],
        judged: Option<&Judged>,
        findings: &[String],
    ) -> Report {
        let unit = loaded.recording.unit;
        let title = |text: &str| session.terminal.emphasise(Emphasis::Title, text);
        let mut notes = loaded.recording.report.notes();
        notes.extend(prepared.report.notes());
        let mut text = format!(
            "{}\n  {} samples over {:.2} s, {} joints, {}\n",
            title(&self.recording.display().to_string()),
            loaded.recording.samples(),
            loaded.recording.duration_s(),
            reports.len(),
            if loaded.recording.measurement.is_some() {
                format!("{} in {}", unit.quantity(), unit.symbol())
            } else {
                "without measurement".into()
            }
        );
        text.extend(notes.iter().map(|n| wrapped(n)));
        let [motion, sensors] = tables(reports, unit);
        text.push_str(&format!("\n{}\n{}", title("motion"), motion.render()));
        text.push_str(&format!("\n{}\n{}", title("sensors: steps and white noise"), sensors.render()));
        let suitable = suitable_f_dyn_hz(reports, prepared.report.rate_hz);
        if let Some(f_dyn_hz) = suitable {
            text.push_str(&wrapped(&format!(
                "for an experiment on such motions: f_dyn_hz = {f_dyn_hz} under [preprocess]"
            )));
        }
        if let Some(judged) = judged {
            text.push_str(&format!("\n{}\n{}", title("excitation"), judged.to_text()));
        }
        if findings.is_empty() {
            text.push_str(&format!("\n{}\n  nothing stands against calibrating on it\n", title("findings")));
        } else {
            let heading = session.terminal.emphasise(Emphasis::Warning, "findings");
            text.push_str(&format!("\n{heading}\n"));
            text.extend(findings.iter().map(|f| wrapped(f)));
        }
        let json = json!({
            "command": "check",
            "file": self.recording,
            "samples": loaded.recording.samples(),
            "duration_s": loaded.recording.duration_s(),
            "unit": loaded.recording.measurement.as_ref().map(|_| unit.symbol()),
            "reading": loaded.recording.report,
            "preprocessing": prepared.report,
            "joints": reports,
            "suitable_f_dyn_hz": suitable,
            "excitation": judged.map(Judged::to_json),
            "findings": findings,
        });
        Report { text, findings: !findings.is_empty(), json }
    }
}

/// What should be heeded, in sentences.
fn findings(
    loaded: &Loaded,
    prepared: &Preprocessed,
    reports: &[JointReport],
    judged: Option<&Judged>,
) -> Vec<String> {
    let mut findings: Vec<String> = Vec::new();
    let name = loaded.source.file.file_name().unwrap_or_default().to_string_lossy();
    let faults = RecordingFaults::find(&name, &loaded.recording);
    findings.extend(faults.faults.into_iter().map(|f| f.sentence));
    let report = &loaded.recording.report;
    if !report.dropped.is_empty() {
        findings.push(format!("{} corrupt rows were left out", report.dropped.len()));
    }
    findings.extend(report.remarks.iter().cloned());
    let gaps = prepared.report.clock.gaps_s.len();
    if gaps > 0 {
        findings.push(format!("{gaps} gaps split the recording"));
    }
    for (joint, scale) in prepared.report.velocity_scale.iter().enumerate() {
        if let Some(scale) = scale.filter(|s| (s - 1.0).abs() > 0.05) {
            findings.push(format!(
                "the logged velocity of joint {joint} is {scale:.2} times the derivative of its position"
            ));
        }
    }
    let resting: Vec<String> =
        (0..reports.len()).filter(|j| !reports[*j].moves()).map(|j| j.to_string()).collect();
    let moving: Vec<String> =
        (0..reports.len()).filter(|j| reports[*j].moves()).map(|j| j.to_string()).collect();
    if moving.is_empty() {
        findings.push("no joint moves: nothing can be calibrated on it".into());
    } else if !resting.is_empty() {
        let verb = if moving.len() == 1 { "moves" } else { "move" };
        findings.push(format!(
            "only {} {verb}; the friction of {} is out of reach, and so are inertial parameters that need {} motion",
            numbered(&moving),
            numbered(&resting),
            if resting.len() == 1 { "its" } else { "their" }
        ));
    }
    if let Some(judged) = judged {
        let (silent, combined) = (judged.silent(), judged.combined());
        if !silent.is_empty() || !combined.is_empty() {
            findings.push(format!(
                "{} of {} parameters are out of reach and {} are determined in combinations only",
                silent.len(),
                judged.model.parameters().len(),
                combined.len()
            ));
        }
        if judged.excited.condition_number > LARGE_CONDITION_NUMBER {
            findings.push(format!(
                "the condition number is {}: some combination of parameters is hardly excited",
                significant(judged.excited.condition_number, 3)
            ));
        }
    }
    findings
}

/// `joint 1`, `joints 0, 2`.
fn numbered(joints: &[String]) -> String {
    format!("{} {}", if joints.len() == 1 { "joint" } else { "joints" }, joints.join(", "))
}

/// A joint that rests is exactly at rest: the noise of its sensor excites nothing.
fn without_resting_joints(segment: &Segment, reports: &[JointReport]) -> Result<Segment, ModelError> {
    let view = segment.motion.view();
    let samples = view.samples();
    let mut series = [Vec::new(), Vec::new(), Vec::new()];
    for (joint, report) in reports.iter().enumerate() {
        let all = [view.position_rad(joint), view.velocity_rad_s(joint), view.acceleration_rad_s2(joint)];
        if report.moves() {
            series.iter_mut().zip(all).for_each(|(s, a)| s.extend_from_slice(a));
        } else {
            let middle = all[0].iter().sum::<f64>() / samples.max(1) as f64;
            series.iter_mut().zip([middle, 0.0, 0.0]).for_each(|(s, v)| s.resize(s.len() + samples, v));
        }
    }
    let [position, velocity, acceleration] = series;
    let motion = Motion::new(reports.len(), view.time_s().to_vec(), position, velocity, acceleration)?;
    // What was measured does not matter for what a motion excites, only that there is something.
    let measurement = Some(vec![vec![0.0; segment.rows()]; reports.len()]);
    Ok(Segment { motion, measurement, ..segment.clone() })
}

/// Coulomb and linear viscous friction: the least that a joint has.
fn plain_friction(registry: &Registry) -> Result<JointStack, Failure> {
    JointStack::new(
        build::<dyn CoulombModel>(registry, json!({ "model": "none" }))?,
        build::<dyn HysteresisModel>(registry, json!({ "model": "sign" }))?,
        build::<dyn ViscousBasis>(registry, json!({ "model": "polynomial", "powers": [1] }))?,
    )
    .map_err(Failure::Models)
}

const fn preprocessing(f_dyn_hz: f64) -> Preprocessing {
    Preprocessing {
        f_dyn_hz,
        sample_rate_hz: None,
        position_cutoff_hz: None,
        parallel_cutoff_hz: None,
        rest_velocity_rad_s: 0.03,
        trim_rest: false,
        max_gap_s: None,
    }
}

/// One over the median distance of stamps.
fn median_rate_hz(loaded: &Loaded) -> f64 {
    let mut distances: Vec<f64> = loaded.recording.time_s.windows(2).map(|w| w[1] - w[0]).collect();
    distances.retain(|d| *d > 0.0);
    let middle = distances.len() / 2;
    if distances.is_empty() {
        return f64::INFINITY;
    }
    1.0 / *distances.select_nth_unstable_by(middle, f64::total_cmp).1
}
