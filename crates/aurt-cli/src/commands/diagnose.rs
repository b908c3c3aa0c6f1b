//! `aurt diagnose`: where a model and recordings differ, what physics is missing, and the model that has it.

use std::path::{Path, PathBuf};

use aurt_diagnosis::{
    Answer, Learnt, Method, Question, QuestionedRecording, Role, SelectionOptions, Verdict, from_folder,
    improved_experiment, improvement, investigate, series, with_file_names, write_verdict,
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
        terminal::{Report, Terminal},
        text::wrapped,
    },
    reports::{
        self, PlotOptions,
        diagnosis::{Diagnosed, words::Asked},
    },
    results::verdict::Shown,
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
    /// Take confidence from this file of `aurt prove --learn` instead of the program's own
    #[arg(long, value_name = "LEARNT.json")]
    learnt: Option<PathBuf>,
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
            learnt: None,
            compare: false,
            verdict_only: false,
            plots: PlotOptions::none(),
        }
    }

    /// Diagnoses.
    pub fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        let Session { terminal, registry } = session;
        let learnt = self.learnt.as_deref().map(Learnt::read).transpose()?;
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
        check_joints(&self.experiment, structure.joints())?;
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
        let mut verdict = write_verdict(&question, &investigation).checked()?;
        if let Some(learnt) = learnt {
            learnt.apply(&mut verdict);
        }
        let asked = Asked::of(&question);
        let held_out = with_windows(&verdict.held_out.recordings, &experiment.recordings.validation);
        let shown =
            Shown { verdict: &verdict, asked, unit: unit.symbol(), held_out: &held_out, warnings: &[] };
        let document = json!(verdict);
        let mut files = vec![("verdict.json".to_owned(), pretty(&document).into_bytes())];
        if self.compare {
            let methods: serde_json::Map<String, serde_json::Value> = Method::ALL
                .into_iter()
                .map(|method| (method.name().to_owned(), json!(method.answer(&question, &investigation))))
                .collect();
            files.push((COMPARISON.to_owned(), pretty(&json!(methods)).into_bytes()));
        }
        if self.verdict_only {
            drop(progress);
            folder.write(&files)?;
            let written: Vec<PathBuf> = files.iter().map(|(name, _)| folder.path().join(name)).collect();
            let text = shown.to_text(terminal) + &written_text(&written);
            return Ok(finished(text, document, &verdict, &[], &written));
        }
        let mut improvement = improvement(&question, &investigation);
        // A given model is improved by what is added to its own experiment's structure, fitted anew.
        improvement.calibrate_on_target |= question.recordings.iter().any(|r| r.role == Role::Target);
        improvement.libraries.retain(|library| !is_named(library, &experiment));
        let here = improved_experiment(&experiment.source_text, &improvement)?;
        let moved = Moved::new(&self.experiment, folder.path());
        let text = with_file_names(&here, &|p| moved.seen_from_results(p))?;
        progress.step("calibrating the improved model");
        drop(progress);

        // The folder of the results may not be there yet.
        let anywhere = with_file_names(&here, &|p| moved.file(p))?;
        let improved = improved_model(&anywhere, &self.experiment, registry)?;
        // Paths that changed are no addition.
        let unchanged = with_file_names(&experiment.source_text, &|p| moved.seen_from_results(p))?;
        let page = Diagnosed {
            verdict: &verdict,
            asked,
            held_out: &held_out,
            series: &series(&question, &investigation),
            unit,
            improved: (&improved.model, &improved.calibration),
            added: added_lines(&unchanged, &text).into_iter().map(str::to_owned).collect(),
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
        let warnings = &improved.calibration.warnings;
        let mut report = Shown { warnings, ..shown }.to_text(terminal);
        report.extend(improvement.notes.iter().map(|note| wrapped(&format!("note: {note}"))));
        report.push_str(&difference(&unchanged, &text));
        report.push_str(&written_text(&written));
        report.push_str(&drawn_text(&drawn, plots.as_ref()));
        written.extend(drawn);
        Ok(finished(report, document, &verdict, warnings, &written))
    }
}

/// Joints of the largest arm that is diagnosed. Effects are weighed jointly over all joints, which takes memory with the
/// square of their number and time with its cube.
const MOST_JOINTS: usize = 20;

fn check_joints(experiment: &Path, joints: usize) -> Result<(), Failure> {
    if joints <= MOST_JOINTS {
        return Ok(());
    }
    Err(Failure::ModelFile {
        path: experiment.to_owned(),
        reason: format!("the arm has {joints} joints, a diagnosis weighs effects on up to {MOST_JOINTS}"),
        remedy: "diagnose parts of it: a geometry and recordings of the joints of each part".into(),
    })
}

fn finished(
    text: String,
    mut json: serde_json::Value,
    verdict: &Verdict,
    warnings: &[String],
    written: &[PathBuf],
) -> Report {
    json["command"] = json!("diagnose");
    json["warnings"] = json!(warnings);
    json["outputs"] = json!(written);
    Report { text, json, findings: is_found(verdict) }
}

/// Whether something has changed or is missing.
fn is_found(verdict: &Verdict) -> bool {
    [Some(verdict.verdict), verdict.structure]
        .into_iter()
        .flatten()
        .any(|answer| answer != Answer::NoMismatch)
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
            Some(source) => Some(simulated::read(&source.file, pipeline.joints, &loaded.recording.time_s)?),
            None => None,
        };
        let raw = match loaded.source.window_s.filter(|_| simulated.is_none()) {
            Some(window) => loaded.recording.window(window)?,
            None => loaded.recording.clone(),
        };
        // A target in which the arm stands has no motion to be trimmed to; it can show a contact all the same.
        let trimmed = pipeline.preprocess(&loaded, Purpose::Calibration);
        let (data, purpose) = match trimmed {
            Err(_) if role == Role::Target => {
                (pipeline.preprocess(&loaded, Purpose::Validation).or(trimmed)?, Purpose::Validation)
            }
            trimmed => (trimmed?, Purpose::Calibration),
        };
        recordings.push(QuestionedRecording {
            role,
            raw,
            data,
            options: pipeline.options(loaded.recording.unit, purpose),
            simulated,
            spoilt: None,
        });
    }
    Ok((recordings, unit))
}

/// What was held out, with its windows: two parts of one file are two recordings.
fn with_windows(held_out: &[String], validation: &[RecordingSource]) -> Vec<String> {
    let mut sources = validation.iter();
    held_out
        .iter()
        .map(|name| match sources.find(|s| s.written == *name).and_then(|s| s.window_s) {
            Some([from, to]) => format!("{name} from {from} to {to} s"),
            None => name.clone(),
        })
        .collect()
}

/// Runs the improved experiment and gives its calibrated model.
fn improved_model(text: &str, path: &Path, registry: &mut Registry) -> Result<CalibratedModel, Failure> {
    let experiment = Experiment::parse(text, path, registry).map_err(Failure::Experiment)?;
    Ok(fit_experiment(&experiment, &Terminal::new(false, true))?.calibrated)
}

/// Whether the experiment itself loads a library; if not, it came with `--plugin`.
fn is_named(library: &Path, experiment: &Experiment) -> bool {
    experiment.libraries.iter().any(|named| std::fs::canonicalize(named).is_ok_and(|file| file == library))
}

/// What was found and done while a recording was read and preprocessed.
fn notes_of(recording: &QuestionedRecording) -> Vec<String> {
    let mut notes = recording.raw.report.notes();
    notes.extend(recording.data.data.report.notes());
    notes
}

/// Where an experiment's relative file names lead from the folder of the results, and where from anywhere.
struct Moved {
    /// The folder of the experiment.
    from: PathBuf,
    /// The folder of the results.
    to: PathBuf,
}

impl Moved {
    fn new(experiment: &Path, out: &Path) -> Self {
        // The folder of a bare file name is the empty path, which has no canonical form.
        let folder = experiment.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let from = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        // A folder that is yet to be made lies in one that is there.
        let to = out.canonicalize().unwrap_or_else(|_| {
            let parent = out.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
            let parent = parent.canonicalize().unwrap_or_else(|_| parent.to_owned());
            out.file_name().map_or_else(|| parent.clone(), |name| parent.join(name))
        });
        Self { from, to }
    }

    fn file(&self, written: &Path) -> PathBuf {
        let file = self.from.join(written);
        file.canonicalize().unwrap_or(file)
    }

    /// As the results' folder writes it.
    fn seen_from_results(&self, written: &Path) -> PathBuf {
        from_folder(&self.to, &self.file(written))
    }
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
