//! The part of `aurt check` and `aurt run` that tells mistakes of a setup.

use std::path::Path;

use aurt::{RecordingResult, fitting::Assigned};
use aurt_doctor::doctor::{self, Examination, Subject};
use aurt_experiment::Experiment;
use aurt_plugins::Registry;
use aurt_report::rendering::text::wrapped;
use aurt_workbench::{failure::Failure, output::OutputFile};
use serde_json::{Value, json};

use crate::rendering::terminal::{Emphasis, Report, Terminal};

/// Where `--fixed` goes: beside the experiment, since its paths start there.
///
/// # Errors
/// If there is no experiment, or the file would lie elsewhere.
pub fn place(fixed: Option<&Path>, experiment: Option<&Experiment>) -> Result<Option<OutputFile>, Failure> {
    let Some(path) = fixed else { return Ok(None) };
    let refuse = |reason: String, remedy: &str| Failure::Argument {
        option: "--fixed",
        reason,
        remedy: remedy.to_owned(),
    };
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

/// Examines a setup, adds what is found to a report, and writes the corrected experiment where that is asked for.
///
/// # Errors
/// If the setup cannot be examined or the file not be written.
pub fn checked(
    subject: &Subject,
    experiment: Option<&Experiment>,
    fixed: Option<&OutputFile>,
    registry: &Registry,
    terminal: &Terminal,
    report: &mut Report,
) -> Result<(), Failure> {
    if !subject.recordings.iter().any(|r| r.loaded.recording.measurement.is_some()) {
        return Ok(());
    }
    let examination = doctor::examine(subject, registry)?;
    report.text.push_str(&text_of(&examination, terminal));
    report.json["setup"] = examination.to_json();
    add_findings(&mut report.json, &examination.sentences());
    report.findings |= examination.is_serious() || examination.hardly().is_some();
    if let Some((fixed, experiment)) = fixed.zip(experiment)
        && !examination.steps.is_empty()
    {
        let (text, left) = doctor::corrected(experiment, subject, &examination)?;
        fixed.write(text.as_bytes())?;
        report.text.push_str(&format!("\nwritten\n  {}\n", fixed.path().display()));
        report.text.extend(left.iter().map(|l| wrapped(&format!("to be done by hand: {l}"))));
        report.json["fixed"] = json!({ "file": fixed.path(), "by_hand": left });
    }
    Ok(())
}

/// What an examination came to, for people.
pub fn text_of(examination: &Examination, terminal: &Terminal) -> String {
    let sentences = examination.sentences();
    let found = examination.is_serious();
    let emphasis = if found { Emphasis::Warning } else { Emphasis::Title };
    let mut text = format!("\n{}\n", terminal.emphasise(emphasis, "robot and recordings together"));
    text.push_str(&wrapped(&examination.summary()));
    text.extend(sentences.iter().map(|s| wrapped(s)));
    if sentences.is_empty() {
        let said = examination.hardly().unwrap_or_else(|| examination.nothing().into());
        text.push_str(&wrapped(&said));
    }
    text
}

/// What makes a calibrated model doubtful.
#[derive(Debug)]
pub struct Doubts {
    loudly: Option<String>,
    oddities: Vec<String>,
    examination: Examination,
}

/// Looks at a calibrated model and what it was calibrated on.
///
/// # Errors
/// If the setup cannot be examined.
pub fn doubts(
    experiment: &Experiment,
    results: &[RecordingResult],
    recordings: Vec<Assigned>,
    registry: &Registry,
) -> Result<Doubts, Failure> {
    let poor = doctor::poorly_explained(results);
    let mut oddities: Vec<String> = Vec::new();
    for recording in recordings.iter().map(|r| &r.loaded) {
        let name = recording.source.file.file_name().unwrap_or_default().to_string_lossy();
        let said = doctor::oddities(&name, &recording.recording);
        oddities.extend(said.into_iter().filter(|s| !oddities.contains(s)).collect::<Vec<_>>());
    }
    let subject = Subject::of_experiment(experiment, recordings)?;
    let examination = doctor::examine_calibrated(&subject, !poor.is_empty(), registry)?;
    Ok(Doubts { loudly: doctor::loudly(&poor), oddities, examination })
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
            text.push_str(&text_of(examination, terminal));
        }
        report.text.push_str(&text);
        let mut findings: Vec<String> = said.into_iter().cloned().collect();
        findings.extend(examination.iter().flat_map(|e| e.sentences()));
        report.json["findings"] = json!(findings);
        report.json["setup"] = json!(examination.map(Examination::to_json));
    }
}

fn add_findings(json: &mut Value, sentences: &[String]) {
    if let Some(list) = json["findings"].as_array_mut() {
        list.extend(sentences.iter().map(|s| json!(s)));
    }
}
