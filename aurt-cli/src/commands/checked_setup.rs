//! The part of `aurt check` and `aurt run` that tells mistakes of a setup.

use std::path::Path;

use aurt::RecordingResult;
use aurt::fitting::Assigned;
use aurt_experiment::Experiment;
use aurt_experiment::doctor::checkup::Checkup;
use aurt_experiment::doctor::mistakes::{self, Examination, Subject};
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::OutputFile;
use aurt_plugins::Registry;
use aurt_report::rendering::text::wrapped;
use serde_json::json;

use crate::rendering::terminal::{Emphasis, Report, Terminal};

/// Where `--fixed` goes: beside the experiment, since its paths start there.
pub fn place(fixed: Option<&Path>, experiment: Option<&Experiment>) -> Result<Option<OutputFile>, Failure> {
    let Some(path) = fixed else { return Ok(None) };
    let refuse = |reason: String, remedy: &str| Failure::argument("--fixed", reason, remedy);
    let Some(experiment) = experiment else {
        return Err(refuse(
            "there is no experiment to correct".into(),
            "give one, or make it with `aurt init`",
        ));
    };
    let folder = |p: &Path| match p.parent() {
        Some(parent) if parent.as_os_str().is_empty() => Path::new(".").canonicalize(),
        Some(parent) => parent.canonicalize(),
        None => p.canonicalize(),
    };
    let same = folder(path).ok().is_some_and(|f| folder(&experiment.path).is_ok_and(|e| e == f));
    if !same {
        let reason =
            format!("{} is in another folder than the experiment, where its paths start", path.display());
        return Err(refuse(reason, "name a file beside the experiment"));
    }
    OutputFile::new("--fixed", path, &[&experiment.path]).map(Some)
}

/// Writes the corrected experiment, if mistakes of its setup were found, and says so in a report.
pub fn correct(
    checkup: &Checkup,
    experiment: &Experiment,
    fixed: &OutputFile,
    report: &mut Report,
) -> Result<(), Failure> {
    let Some((subject, examination)) = checkup.subject.as_ref().zip(checkup.examination.as_ref()) else {
        return Ok(());
    };
    if examination.found.steps.is_empty() && !checkup.has_other_stamps() {
        return Ok(());
    }
    let (text, left) = mistakes::corrected(experiment, subject, examination)?;
    fixed.write(text.as_bytes())?;
    report.text.push_str(&format!("\nwritten\n  {}\n", fixed.path().display()));
    report.text.extend(left.iter().map(|l| wrapped(&format!("to be done by hand: {l}"))));
    report.json["fixed"] = json!({ "file": fixed.path(), "by_hand": left });
    Ok(())
}

/// What makes a calibrated model doubtful.
#[derive(Debug)]
pub struct Doubts {
    loudly: Option<String>,
    oddities: Vec<String>,
    examination: Examination,
}

/// Looks at a calibrated model and what it was calibrated on.
pub fn doubts(
    experiment: &Experiment,
    results: &[RecordingResult],
    recordings: Vec<Assigned>,
    registry: &Registry,
) -> Result<Doubts, Failure> {
    let poor = mistakes::poorly_explained(results);
    let mut oddities: Vec<String> = Vec::new();
    for recording in recordings.iter().map(|r| &r.loaded) {
        let name = recording.source.file.file_name().unwrap_or_default().to_string_lossy();
        let said = mistakes::oddities(&name, &recording.recording);
        oddities.extend(said.into_iter().filter(|s| !oddities.contains(s)).collect::<Vec<_>>());
    }
    let subject = Subject::of_experiment(experiment, recordings)?;
    let examination = mistakes::examine_calibrated(&subject, &poor, registry)?;
    let loudly = mistakes::loudly(&poor, results, examination.names());
    Ok(Doubts { loudly, oddities, examination })
}

impl Doubts {
    /// Adds them to a report; with any of them the command has found something.
    pub fn add_to(&self, report: &mut Report, terminal: &Terminal) {
        let told = self.loudly.is_some() || self.examination.is_serious();
        let examination = told.then_some(&self.examination);
        if self.loudly.is_none() && self.oddities.is_empty() && examination.is_none() {
            return;
        }
        report.findings = true;
        let said: Vec<&String> = self.loudly.iter().chain(&self.oddities).collect();
        let mut text = String::new();
        for sentence in &said {
            text.push_str(&wrapped(&terminal.emphasise(Emphasis::Warning, sentence)));
        }
        if !text.is_empty() {
            text.insert(0, '\n');
        }
        if let Some(examination) = examination {
            text.push_str(&examination.to_text(terminal.style()));
        }
        report.text.push_str(&text);
        let mut findings: Vec<String> = said.into_iter().cloned().collect();
        findings.extend(examination.iter().flat_map(|e| e.sentences()));
        report.json["findings"] = json!(findings);
        report.json["setup"] = json!(examination.map(Examination::to_json));
    }
}
