//! `aurt demo`: the whole chain on recordings made for it.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use aurt_calibration::CalibratedParameter;
use aurt_experiment::Experiment;
use aurt_experiment::workbench::demo;
use aurt_experiment::workbench::experiments::fit_experiment;
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::OutputFolder;
use aurt_report::rendering::number::significant;
use aurt_report::rendering::table::Table;
use aurt_report::rendering::text::wrapped;
use clap::Args;
use serde_json::{Value, json};

use super::Session;
use super::diagnose::Diagnose;
use super::run::RunFiles;
use crate::rendering::terminal::{Emphasis, Report};

/// Calibrate, validate and diagnose a model of a simulated six-joint robot.
///
/// Writes noisy recordings of a robot with known friction and an experiment file, runs the experiment, and
/// compares estimated with true parameters. Then diagnoses recordings of the same robot with an undeclared
/// load. The files are a template for your own experiments.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt demo\n  aurt run aurt-demo/experiment.toml --out results")]
pub struct Demo {
    /// Folder for recordings and results; created if it does not exist
    #[arg(long, value_name = "DIR", default_value = "aurt-demo")]
    out: PathBuf,
}

impl Demo {
    pub fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        let folder = OutputFolder::new("--out", &self.out)?;
        let progress = session.terminal.progress(1);
        progress.step("simulating the robot");
        let inputs = demo::files()?;
        folder.write(&missing(&self.out, &inputs)?)?;
        drop(progress);

        let experiment = Experiment::read(folder.path().join("experiment.toml"), &mut session.registry)?;
        let count = experiment.recordings.calibration.len() + experiment.recordings.validation.len();
        let outcome = fit_experiment(&experiment, &session.terminal.progress(3 * count + 2))?;
        let compared = compare(&outcome.calibrated.calibration.parameters);
        let results = RunFiles::new("demo", &experiment, &outcome, session.terminal.style())?;
        let mut report = results.write(outcome, &folder, None)?;
        let title = session.terminal.emphasise(Emphasis::Title, "estimated and true");
        let table = table(&compared);
        let later = folder.path().join(demo::QUESTION_FILE);
        let diagnosis = Diagnose::new(later, folder.path().join("diagnosis")).run(session)?;
        let asked = session.terminal.emphasise(Emphasis::Title, "later, something has changed: what?");
        let made: Vec<PathBuf> = inputs.iter().map(|(name, _)| folder.path().join(name)).collect();
        let inputs: Vec<String> = made.iter().map(|f| format!("  {}\n", f.display())).collect();
        report.text = format!(
            "a simulated UR10e, 20 s of motion to calibrate on, 20 s of others to validate\n{}\n{}\n{title}\n{}\n\
             {asked}\n{}\nconcealed was {}\n",
            inputs.concat(),
            report.text,
            table.render(),
            what_was_found(&diagnosis.json).trim_end(),
            demo::CONCEALED
        );
        report.json["diagnosis"] = diagnosis.json;
        report.json["concealed"] = json!(demo::CONCEALED);
        report.json["inputs"] = json!(made);
        report.json["truth"] = compared
            .iter()
            .map(|c| json!({ "name": c.found.name, "value": c.found.value, "true": c.truth, "within_95": c.within() }))
            .collect::<Vec<Value>>()
            .into();
        Ok(report)
    }
}

/// The inputs that an earlier demo has not written yet. Files of the same names and other contents are the user's, and stay.
fn missing(folder: &Path, inputs: &[demo::File]) -> Result<Vec<demo::File>, Failure> {
    let mut missing = Vec::new();
    for (name, contents) in inputs {
        let path = folder.join(name);
        match aurt_files::read_regular(&path, aurt_files::MOST_MODEL_BYTES) {
            Ok(found) if found == *contents => {}
            Err(error) if error.kind() == ErrorKind::NotFound => {
                missing.push((name.clone(), contents.clone()))
            }
            _ => {
                return Err(Failure::output(
                    "--out",
                    &path,
                    "is not as the demo writes it: it is your own, or of another version, and would be overwritten",
                    "name another folder",
                ));
            }
        }
    }
    Ok(missing)
}

/// What a diagnosis found, and what it is worth on the recording that took no part, for a terminal.
fn what_was_found(verdict: &Value) -> String {
    let effects = verdict["effects"].as_array().map_or(&[][..], Vec::as_slice);
    let mut text = String::new();
    if effects.is_empty() {
        text.push_str("nothing was found\n");
    }
    for sentence in effects.iter().filter_map(|effect| effect["sentence"].as_str()) {
        text.push_str(&wrapped(&format!("found: {sentence}")));
    }
    let held_out = |key: &str| verdict["held_out"][key].as_array().cloned().unwrap_or_default();
    let mut table = Table::new(["joint", "error held out, Nm", "with what was found"]);
    for (joint, (before, after)) in held_out("rms_before").iter().zip(held_out("rms_after")).enumerate() {
        let number = |value: &Value| significant(value.as_f64().unwrap_or(f64::NAN), 3);
        table.row([joint.to_string(), number(before), number(&after)]);
    }
    text + "\n" + &table.render()
}

/// A parameter with its true value.
#[derive(Debug)]
struct Compared {
    found: CalibratedParameter,
    truth: f64,
}

impl Compared {
    /// Whether the 95 % interval holds the true value.
    fn within(&self) -> bool {
        self.found.interval_95.is_some_and(|[lower, upper]| (lower..=upper).contains(&self.truth))
    }
}

fn compare(parameters: &[CalibratedParameter]) -> Vec<Compared> {
    let truth = demo::truth();
    let of = |name: &str| truth.iter().find(|(n, _)| n == name).map(|(_, value)| *value);
    parameters
        .iter()
        .filter_map(|found| Some(Compared { truth: of(&found.name)?, found: found.clone() }))
        .collect()
}

fn table(compared: &[Compared]) -> Table {
    let mut table = Table::new(["parameter", "unit", "true", "found", "± 95 %", ""]).left(2);
    for parameter in compared {
        let half = parameter.found.interval_95.map_or(f64::NAN, |[lower, upper]| 0.5 * (upper - lower));
        table.row([
            parameter.found.name.clone(),
            parameter.found.unit.clone(),
            significant(parameter.truth, 4),
            significant(parameter.found.value, 4),
            significant(half, 2),
            if parameter.within() { String::new() } else { "outside".into() },
        ]);
    }
    table
}
