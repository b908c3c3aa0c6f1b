//! `aurt diagnose`: where a model and recordings differ, what physics is missing, and the model that has it.

use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
};

use aurt_diagnosis::{
    Answer, Method, Question, QuestionedRecording, Role, SelectionOptions, Verdict, improved_experiment,
    improvement, investigate, series, write_verdict,
};
use aurt_plugins::{Experiment, Registry, experiment::RecordingSource};
use clap::Args;
use serde_json::json;

use super::Session;
use crate::{
    calibrated_file::CalibratedModel,
    commands::run::{calibration_options, drawn_text, fit_experiment, written_text},
    data::{Instrument, Pipeline, Preprocessing, Purpose, Source},
    failure::Failure,
    output::OutputFolder,
    proof::COMPARISON,
    rendering::{
        json::pretty,
        terminal::{Emphasis, Report, Terminal},
    },
    reports::{self, PlotOptions, diagnosis::Diagnosed},
    simulated,
};

/// Locate the mismatch between a model and recordings, name the physics left out, and model it.
///
/// Where `[recordings] target` is given, the question is what these show beyond the model; where it is not, what
/// the model lacks in its own calibration recordings. Exit status 1 if something was found.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt diagnose experiment.toml --out diagnosis\n  \
    aurt diagnose experiment.toml --model results/rd_calibrated.json --out diagnosis")]
pub struct Diagnose {
    /// Experiment file
    #[arg(value_name = "EXPERIMENT.toml")]
    experiment: PathBuf,
    /// Folder for report.html, verdict.json, improved.toml and rd_improved.json; created if it does not exist
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Take a calibrated model as given instead of recalibrating the experiment's structure
    #[arg(long, value_name = "RD_CALIBRATED.json")]
    model: Option<PathBuf>,
    /// Do as if an effect were unknown; may be given several times
    #[arg(long, value_name = "EFFECT")]
    without: Vec<String>,
    /// Write comparison.json: what simpler methods would name (best single candidate, LASSO, STLSQ)
    #[arg(long)]
    compare: bool,
    /// Write the verdict alone: no report, no improved experiment, no improved model
    #[arg(long, conflicts_with = "plots")]
    verdict_only: bool,
    #[command(flatten)]
    plots: PlotOptions,
}

impl Diagnose {
    /// A diagnosis of an experiment with all effects, its outputs in `out`.
    pub const fn new(experiment: PathBuf, out: PathBuf) -> Self {
        Self {
            experiment,
            out,
            model: None,
            without: Vec::new(),
            compare: false,
            verdict_only: false,
            plots: PlotOptions::none(),
        }
    }

    /// Diagnoses.
    pub fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        let Session { terminal, registry } = session;
        let terminal: &Terminal = terminal;
        let folder = OutputFolder::new("--out", &self.out)?;
        let plots = self.plots.folder()?;
        let experiment = Experiment::read(&self.experiment, registry)?;
        let frozen = self.model.as_deref().map(|p| CalibratedModel::read(p, registry)).transpose()?;
        let progress = terminal.progress(24);
        let structure = match &frozen {
            Some(calibrated) => calibrated.model.clone(),
            None => experiment.robot_model()?,
        };
        let (preprocessing, instrument) = (Preprocessing::of(&experiment), Instrument::of(&experiment));
        let pipeline =
            Pipeline { joints: structure.joints(), preprocessing: &preprocessing, instrument: &instrument };
        let (recordings, unit) = read(&experiment, &pipeline, |what| progress.step(what))?;
        let question = Question {
            model: &structure,
            frozen: frozen.as_ref().map(|f| &f.calibration),
            recordings: &recordings,
            unit,
            f_dyn_hz: preprocessing.f_dyn_hz,
            calibration: calibration_options(&experiment),
            selection: SelectionOptions::default(),
            without: &self.without,
        };
        let investigation = investigate(&question, registry, |what| progress.step(what))?;
        let verdict = write_verdict(&question, &investigation);
        let document = json!(verdict);
        let mut files = vec![("verdict.json".to_owned(), pretty(&document).into_bytes())];
        if self.compare {
            let methods: serde_json::Map<String, serde_json::Value> = Method::ALL
                .into_iter()
                .map(|method| (method.name().to_owned(), json!(method.answer(&investigation))))
                .collect();
            files.push((COMPARISON.to_owned(), pretty(&json!(methods)).into_bytes()));
        }
        if self.verdict_only {
            drop(progress);
            folder.write(&files)?;
            let written: Vec<PathBuf> = files.iter().map(|(name, _)| folder.path().join(name)).collect();
            let text = summary(&verdict, unit.symbol(), terminal) + &written_text(&written);
            return Ok(finished(text, document, &verdict, &written));
        }
        let mut improvement = improvement(&question, &investigation);
        // A given model is improved by what is added to its own experiment's structure, fitted anew.
        improvement.calibrate_on_target |= question.recordings.iter().any(|r| r.role == Role::Target);
        let text = improved_experiment(&experiment.source_text, &improvement)?;
        let text = absolute_paths(&text, &experiment);
        progress.step("calibrating the improved model");
        drop(progress);

        let improved = improved_model(&text, &self.experiment, registry)?;
        // Paths that became absolute are no addition.
        let asked = absolute_paths(&experiment.source_text, &experiment);
        let page = Diagnosed {
            verdict: &verdict,
            series: &series(&question, &investigation),
            unit,
            improved: (&improved.model, &improved.calibration),
            added: added_lines(&asked, &text).into_iter().map(str::to_owned).collect(),
            notes: &improvement.notes,
            recording_notes: recordings.iter().map(notes_of).collect(),
            document: &document,
        }
        .page();
        files.extend([
            (reports::FILE.to_owned(), page.to_html().into_bytes()),
            ("improved.toml".to_owned(), text.clone().into_bytes()),
            ("rd_improved.json".to_owned(), improved.to_file()?),
        ]);
        folder.write(&files)?;
        let drawn = reports::write_plots(&page, plots.as_ref())?;
        let mut written: Vec<PathBuf> = files.iter().map(|(name, _)| folder.path().join(name)).collect();
        let mut report = summary(&verdict, unit.symbol(), terminal);
        for note in &improvement.notes {
            let _ = writeln!(report, "note: {note}");
        }
        report.push_str(&difference(&asked, &text));
        report.push_str(&written_text(&written));
        report.push_str(&drawn_text(&drawn, plots.as_ref()));
        written.extend(drawn);
        Ok(finished(report, document, &verdict, &written))
    }
}

fn finished(text: String, mut json: serde_json::Value, verdict: &Verdict, written: &[PathBuf]) -> Report {
    json["command"] = json!("diagnose");
    json["outputs"] = json!(written);
    Report { text, json, findings: verdict.verdict != Answer::NoMismatch }
}

/// Reads and preprocesses the recordings of an experiment, each with its part.
fn read(
    experiment: &Experiment,
    pipeline: &Pipeline<'_>,
    mut progress: impl FnMut(String),
) -> Result<(Vec<QuestionedRecording>, aurt_traits::MeasurementUnit), Failure> {
    let sections = &experiment.recordings;
    let questioned = if sections.target.is_empty() { Role::Calibration } else { Role::Target };
    let listed: Vec<(&RecordingSource, Role)> = sections
        .calibration
        .iter()
        .map(|s| (s, Role::Calibration))
        .chain(sections.target.iter().map(|s| (s, Role::Target)))
        .chain(sections.validation.iter().map(|s| (s, Role::Validation)))
        // Only recordings with a prediction can be compared with a simulator.
        .filter(|(_, role)| sections.simulated.is_empty() || *role == questioned)
        .collect();
    let count = listed.iter().filter(|(_, role)| *role == questioned).count();
    let simulated = &sections.simulated;
    if !simulated.is_empty() && simulated.len() != count {
        return Err(Failure::Simulated {
            path: simulated[0].file.clone(),
            reason: format!("`simulated` lists {} files for {count} recordings", simulated.len()),
            remedy: "list one prediction for each target recording (each calibration recording where there \
                     is no target), in their order"
                .into(),
        });
    }
    let mut predictions = simulated.iter();
    let mut loaded = Vec::new();
    for (source, role) in listed {
        progress(format!("reading {}", source.written));
        loaded.push((pipeline.read(Source::from(source), Purpose::Validation)?, role));
    }
    let unit = pipeline.common_unit(loaded.iter().map(|(l, _)| l))?.unwrap_or_default();
    let mut recordings = Vec::new();
    for (loaded, role) in loaded {
        let simulated = match if role == questioned { predictions.next() } else { None } {
            Some(source) => {
                Some(simulated::read(&source.file, pipeline.joints, loaded.recording.time_s.len())?)
            }
            None => None,
        };
        let raw = match loaded.source.window_s.filter(|_| simulated.is_none()) {
            Some(window) => loaded.recording.window(window)?,
            None => loaded.recording.clone(),
        };
        recordings.push(QuestionedRecording {
            role,
            raw,
            data: pipeline.preprocess(&loaded, Purpose::Calibration)?,
            options: pipeline.options(&loaded, Purpose::Calibration),
            simulated,
            spoilt: None,
        });
    }
    Ok((recordings, unit))
}

/// Runs the improved experiment and gives its calibrated model.
fn improved_model(text: &str, path: &Path, registry: &mut Registry) -> Result<CalibratedModel, Failure> {
    let experiment = Experiment::parse(text, path, registry).map_err(Failure::Experiment)?;
    Ok(fit_experiment(&experiment, &Terminal::new(false, true))?.calibrated)
}

/// What was found and done while a recording was read and preprocessed.
fn notes_of(recording: &QuestionedRecording) -> Vec<String> {
    let mut notes = recording.raw.report.notes();
    notes.extend(recording.data.data.report.notes());
    notes
}

/// The improved experiment stands in another folder than its source: relative paths become absolute.
fn absolute_paths(text: &str, experiment: &Experiment) -> String {
    let recordings = &experiment.recordings;
    let all = recordings.calibration.iter().chain(&recordings.validation).chain(&recordings.target);
    let mut text = text.to_owned();
    let mut done: Vec<&str> = Vec::new();
    let replace = |text: &mut String, written: &str, file: &Path| {
        if let Ok(absolute) = std::fs::canonicalize(file) {
            *text = text.replace(&format!("\"{written}\""), &format!("\"{}\"", absolute.display()));
        }
    };
    for source in all {
        if !done.contains(&source.written.as_str()) && !source.written.contains('$') {
            done.push(&source.written);
            replace(&mut text, &source.written, &source.file);
        }
    }
    let mdh = &experiment.robot.mdh;
    for form in [mdh.file_name().map(|n| n.to_string_lossy().into_owned()), Some(mdh.display().to_string())] {
        if let Some(written) = form.filter(|w| Path::new(w).is_relative() && !done.contains(&w.as_str())) {
            replace(&mut text, &written, mdh);
        }
    }
    text
}

/// The verdict in a dozen lines.
fn summary(verdict: &Verdict, unit: &str, terminal: &Terminal) -> String {
    let mut text = String::new();
    let headline = reports::diagnosis::headline(verdict.verdict);
    let _ = writeln!(text, "{}", terminal.emphasise(Emphasis::Title, headline));
    for (k, finding) in verdict.effects.iter().enumerate() {
        let _ = writeln!(text, "  {}. {} (score {:.0})", k + 1, finding.sentence, finding.evidence.score);
        for other in &finding.alternatives {
            let _ = writeln!(text, "     or {}; to tell: {}", other.effect, other.record);
        }
    }
    let _ = writeln!(text, "\n  joint   residual rms [{unit}]            held out [{unit}]");
    let _ = writeln!(text, "          before    after    noise    before    after  follows");
    for residual in &verdict.residual {
        let j = residual.joint;
        let held = |list: &[f64]| list.get(j).map_or_else(|| "-".to_owned(), |v| format!("{v:.4}"));
        let _ = writeln!(
            text,
            "  {j:>5} {:>9.4}{:>9.4}{:>9.4}{:>10}{:>9}  {}",
            residual.baseline_rms,
            residual.unexplained_rms,
            residual.floor_rms,
            held(&verdict.held_out.rms_before),
            held(&verdict.held_out.rms_after),
            match (&residual.follows, residual.structure_left) {
                (Some(what), _) => what.as_str(),
                (None, true) => "(nothing known)",
                (None, false) => "",
            }
        );
    }
    let _ = writeln!(text, "  held out: {}", verdict.held_out.recordings.join(", "));
    if !verdict.not_decidable.is_empty() {
        let names: Vec<&str> = verdict.not_decidable.iter().map(|n| n.effect.as_str()).collect();
        let _ = writeln!(text, "  not decidable here: {}", names.join(", "));
    }
    for note in &verdict.notes {
        let _ = writeln!(text, "  note: {note}");
    }
    text
}

/// The lines that one text has and another has not.
fn added_lines<'a>(before: &str, after: &'a str) -> Vec<&'a str> {
    let old: Vec<&str> = before.lines().collect();
    after.lines().filter(|l| !l.trim().is_empty() && !old.contains(l)).collect()
}

/// The lines that the improved experiment has and the original has not.
fn difference(before: &str, after: &str) -> String {
    let new = added_lines(before, after);
    if new.is_empty() {
        return String::new();
    }
    format!("\nadded to the experiment\n{}", new.iter().map(|l| format!("  + {l}\n")).collect::<String>())
}
