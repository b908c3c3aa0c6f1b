//! Diagnosing: where a model and recordings differ, what physics is missing, and the model that has it.

use std::path::{Path, PathBuf};

use crate::{Complaint, Experiment, ExperimentErrors};
use aurt::data::{Loaded, Purpose, Source};
use aurt::{Asked, CalibratedModel, Diagnoser, Part, Progress, Settings};
use aurt_diagnosis::{
    Improvement, Investigation, Learnt, Question, QuestionedRecording, RecordingSeries, Role,
    SelectionOptions, Verdict, from_folder, improved_experiment, improvement, series, with_file_names,
};
use aurt_plugins::{Entry, Node, NodeKind, Registry};
use aurt_recording::{RobotJoints, Stretches};
use aurt_report::Page;
use aurt_report::rendering::joints::with_names;
use aurt_report::rendering::style::Style;
use aurt_report::reports::diagnosis::{Diagnosed, arm, notes};
use aurt_report::results::verdict::Shown;
use aurt_traits::{ColumnGroup, MeasurementUnit};
use serde_json::{Value, json};

use crate::workbench::experiments::{fit_experiment, with_window};
use crate::workbench::failure::Failure;
use crate::workbench::results::diagnosed_series::DiagnosedSeries;
use crate::workbench::simulated;

#[derive(Debug, Clone, Default)]
pub struct DiagnosisOptions {
    /// A calibrated model to be taken as given, instead of fitting the experiment's structure anew.
    pub frozen: Option<CalibratedModel>,
    /// Effects that are treated as unknown.
    pub without: Vec<String>,
    /// Where confidence comes from, if not from the program's own proof.
    pub learnt: Option<Learnt>,
    /// The folder that the improved experiment is for (its file names lead from there); none for the verdict alone.
    pub improve_for: Option<PathBuf>,
    /// Whether [`Diagnosis::series`] is wanted.
    pub series: bool,
    /// Rows of all recordings together that are looked at; none for [`MOST_ROWS`].
    pub most_rows: Option<usize>,
}

/// Rows of all recordings together that a diagnosis looks at; of longer recordings it takes stretches.
pub const MOST_ROWS: usize = 400_000;

#[derive(Debug, Clone)]
pub struct Diagnosis {
    pub verdict: Verdict,
    pub document: Value,
    pub asked: Asked,
    pub unit: MeasurementUnit,
    /// What was held out, with its part of the recording.
    pub held_out: Vec<String>,
    pub improved: Option<Improved>,
    /// The recordings row by row, if asked for.
    pub series: Vec<DiagnosedSeries>,
}

#[derive(Debug, Clone)]
pub struct Improved {
    pub experiment_toml: String,
    pub added: Vec<String>,
    pub model: CalibratedModel,
    pub notes: Vec<String>,
    pub report: Page,
}

impl Diagnosis {
    /// Whether something has changed or is missing.
    pub fn is_found(&self) -> bool {
        aurt::is_found(&self.verdict)
    }

    pub fn to_text(&self, style: Style) -> String {
        let about_physics = self.improved.as_ref().map_or(&[][..], |i| &i.model.calibration.about_physics);
        let Self { verdict, asked, held_out, .. } = self;
        let all_in = if self.improved.is_some() { "report.html" } else { "verdict.json" };
        let unit = self.unit.symbol();
        Shown { verdict, asked: *asked, unit, held_out, about_physics, all_in }.to_text(style)
    }
}

pub fn diagnose_experiment(
    experiment: &Experiment,
    registry: &mut Registry,
    options: &DiagnosisOptions,
    progress: &Progress,
) -> Result<Diagnosis, Failure> {
    diagnoser(experiment, registry, options, progress)?.ask(progress, |question, investigation, _| {
        let found = Found { experiment, options, question, investigation };
        found.diagnosis(registry, progress)
    })
}

pub(super) fn diagnoser(
    experiment: &Experiment,
    registry: &Registry,
    options: &DiagnosisOptions,
    progress: &Progress,
) -> Result<Diagnoser, Failure> {
    let diagnoser = match &options.frozen {
        Some(calibrated) => Diagnoser::of_given(calibrated.clone()),
        None => Diagnoser::new(experiment.robot_model()?),
    };
    let settings = Settings {
        preprocessing: experiment.preprocess.clone(),
        instrument: experiment.instrument.clone(),
        calibration: experiment.calibration,
    };
    let parts =
        read(experiment, &experiment.robot.robot_joints(), options.most_rows.unwrap_or(MOST_ROWS), |what| {
            progress.step(what)
        })?;
    let named = diagnoser
        .settings(settings)
        .selection(selection(experiment)?)
        .without(&options.without)
        .registry(registry.clone())
        .named(&experiment.path);
    Ok(parts.into_iter().fold(named, Diagnoser::part))
}

/// What an effect must bring: `[diagnosis]` of an experiment, each key one of [`SelectionOptions`].
pub(crate) fn selection(experiment: &Experiment) -> Result<SelectionOptions, Failure> {
    let mut selection = SelectionOptions::default();
    let mut problems = Vec::new();
    let mut complain = |at: &Node, message: String, help: Option<String>| {
        problems.push(Complaint { span: at.span.clone(), message, help }.located(&experiment.source_text));
    };
    for table in experiment.diagnosis.iter().filter(|table| !matches!(table.kind, NodeKind::Table(_))) {
        complain(table, "`diagnosis` expects a table, write [diagnosis]".into(), None);
    }
    for Entry { key, value, .. } in experiment.diagnosis.iter().flat_map(Node::entries) {
        match value.as_number().map(|number| selection.with(key, number)) {
            Some(Ok(with)) => selection = with,
            Some(Err(help)) => complain(value, format!("`{key}` of [diagnosis] cannot be this"), Some(help)),
            None => complain(value, format!("`{key}` expects a number, found {}", value.kind_name()), None),
        }
    }
    if problems.is_empty() {
        return Ok(selection);
    }
    let (path, source_text) = (experiment.path.clone(), experiment.source_text.clone());
    Err(Failure::Experiment(Box::new(ExperimentErrors { path, source_text, problems })))
}

/// What was asked and found, for whatever is to be made of it.
struct Found<'a> {
    experiment: &'a Experiment,
    options: &'a DiagnosisOptions,
    question: &'a Question<'a>,
    investigation: &'a Investigation,
}

impl Found<'_> {
    fn diagnosis(&self, registry: &mut Registry, progress: &Progress) -> Result<Diagnosis, Failure> {
        let Self { experiment, options, question, investigation } = self;
        let aurt::Diagnosis { mut verdict, asked, unit, .. } = aurt::Diagnosis::of(question, investigation)?;
        if let Some(learnt) = &options.learnt {
            learnt.apply(&mut verdict);
        }
        let held_out = with_windows(&verdict.held_out.recordings, &experiment.recordings.validation);
        let document = with_names(json!(verdict), question.model.rigid_body().joint_names());
        let series_of = || series(question, investigation);
        let mut diagnosis =
            Diagnosis { verdict, document, asked, unit, held_out, improved: None, series: Vec::new() };
        if let Some(folder) = &options.improve_for {
            progress.step("calibrating the improved model");
            diagnosis.improved = Some(self.improved(folder, &diagnosis, &series_of(), registry)?);
        }
        if options.series {
            let of_rows = |(rows, recording): (RecordingSeries, &QuestionedRecording)| DiagnosedSeries {
                rows,
                first_s: recording.raw.time_s.first().copied().unwrap_or(0.0),
                origin_s: recording.raw.report.origin_s,
                joint_names: recording.raw.joints.names().to_vec(),
                unit,
            };
            diagnosis.series = series_of().into_iter().zip(question.recordings).map(of_rows).collect();
        }
        Ok(diagnosis)
    }

    /// The experiment with what was found, its calibrated model and its report, for a folder.
    fn improved(
        &self,
        folder: &Path,
        Diagnosis { verdict, document, asked, unit, held_out, .. }: &Diagnosis,
        series: &[RecordingSeries],
        registry: &mut Registry,
    ) -> Result<Improved, Failure> {
        let Self { experiment, options, question, investigation } = self;
        let mut improvement = improvement(question, investigation);
        improvement.libraries.retain(|library| !is_named(library, experiment));
        let moved = Moved::new(&experiment.path, folder);
        let mut here = improved_experiment(&experiment.source_text, &improvement)?;
        // The folder of the results may not be there yet.
        let mut anywhere = with_file_names(&here, &|p| moved.file(p))?;
        let mut model = improved_model(&anywhere, &experiment.path, registry)?;
        if options.frozen.is_some() && leave_out_repeated(&mut improvement, &model) {
            here = improved_experiment(&experiment.source_text, &improvement)?;
            anywhere = with_file_names(&here, &|p| moved.file(p))?;
            model = improved_model(&anywhere, &experiment.path, registry)?;
        }
        let experiment_toml = with_file_names(&here, &|p| moved.seen_from_results(p))?;
        // Paths that changed are no addition.
        let unchanged = with_file_names(&experiment.source_text, &|p| moved.seen_from_results(p))?;
        let added: Vec<String> =
            added_lines(&unchanged, &experiment_toml).into_iter().map(str::to_owned).collect();
        let report = Diagnosed {
            verdict,
            asked: *asked,
            held_out,
            series,
            unit: *unit,
            improved: (&model.model, &model.calibration),
            added: added.clone(),
            notes: &improvement.notes,
            recording_notes: question.recordings.iter().map(notes).collect(),
            document,
            arm: arm::outline(question.model, question.recordings),
        }
        .page();
        Ok(Improved { experiment_toml, added, model, notes: improvement.notes, report })
    }
}

/// Reads the recordings of an experiment, each with its part.
fn read(
    experiment: &Experiment,
    joints: &RobotJoints,
    most_rows: usize,
    mut progress: impl FnMut(String),
) -> Result<Vec<Part>, Failure> {
    let sections = &experiment.recordings;
    let questioned = if sections.target.is_empty() { Role::Calibration } else { Role::Target };
    let listed: Vec<(&Source, Role)> = sections
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
    let (mut read, mut rows): (Vec<(Source, Stretches, Role)>, Vec<usize>) = Default::default();
    for (source, role) in listed {
        progress(format!("reading {}", source.label));
        // A prediction has a value for each row, and a part that the experiment chose is wanted as it is.
        let stretches = if simulated.is_empty() && source.window_s.is_none() {
            let options = source.read_options(Some(joints), Purpose::Validation);
            Stretches::read(&source.file, &options, most_rows)?
        } else {
            Stretches::whole(
                Loaded::read(source.clone(), Some(joints), Purpose::Validation)?.recording.into(),
            )
        };
        rows.push(stretches.rows());
        read.push((source.clone(), stretches, role));
        // The more recordings there are, the less of each is held.
        let most_each = fair_share(rows.clone(), most_rows);
        let thinned = read.into_iter().map(|(source, kept, role)| (source, kept.at_most(most_each), role));
        read = thinned.collect();
    }
    let mut predictions = simulated.iter();
    let part = |(source, kept, role): (Source, Stretches, Role)| {
        let recording = kept.into_recording();
        let prediction = if role == questioned { predictions.next() } else { None };
        let simulated = prediction
            .map(|prediction| simulated::read(&prediction.file, joints.count, &recording.time_s))
            .transpose()?;
        Ok(Part { source, recording, role, simulated })
    };
    read.into_iter().map(part).collect()
}

/// The most rows that each recording may have so that all together have no more than `most`: short ones leave to long ones
/// what they do not need.
fn fair_share(mut rows: Vec<usize>, most: usize) -> usize {
    rows.sort_unstable();
    let (count, mut left) = (rows.len(), most);
    for (k, rows) in rows.into_iter().enumerate() {
        if rows > left / (count - k) {
            return left / (count - k);
        }
        left -= rows;
    }
    usize::MAX
}

/// What was held out, with its windows: two parts of one file are two recordings.
fn with_windows(held_out: &[String], validation: &[Source]) -> Vec<String> {
    let mut sources = validation.iter();
    held_out
        .iter()
        .map(|name| with_window(name, sources.find(|s| s.label == *name).and_then(|s| s.window_s)))
        .collect()
}

/// Leaves out what a given model lacks and the experiment's own structure, fitted anew, has: a load in all recordings, for
/// instance, is mass of the links. Whether anything was.
fn leave_out_repeated(improvement: &mut Improvement, fitted: &CalibratedModel) -> bool {
    let (terms, notes) = (&mut improvement.terms, &mut improvement.notes);
    let (own, before) = (fitted.model.arm_terms().len().saturating_sub(terms.len()), terms.len());
    let mut index = own;
    terms.retain(|(term, _)| {
        let columns = fitted.model.group(ColumnGroup::ArmTerm(index));
        index += 1;
        let adds = fitted.calibration.parameters[columns].iter().any(|p| p.excited);
        if !adds {
            let name = term["model"].as_str().unwrap_or_default();
            notes.push(format!(
                "the experiment's own structure has the columns of `{name}`, which is not added to it"
            ));
        }
        adds
    });
    terms.len() < before
}

fn improved_model(text: &str, path: &Path, registry: &mut Registry) -> Result<CalibratedModel, Failure> {
    let experiment = Experiment::parse(text, path, registry).map_err(Failure::Experiment)?;
    Ok(fit_experiment(&experiment, &Progress::silent())?.calibrated)
}

/// Whether the experiment itself loads a library; if not, it came with `--plugin`.
fn is_named(library: &Path, experiment: &Experiment) -> bool {
    experiment.libraries.iter().any(|named| std::fs::canonicalize(named).is_ok_and(|file| file == library))
}

/// Where an experiment's relative file names lead from the folder of the results, and where from anywhere.
struct Moved {
    from: PathBuf,
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

    fn seen_from_results(&self, written: &Path) -> PathBuf {
        from_folder(&self.to, &self.file(written))
    }
}

/// The lines that one text has and another has not.
fn added_lines<'a>(before: &str, after: &'a str) -> Vec<&'a str> {
    let old: Vec<&str> = before.lines().collect();
    after.lines().filter(|l| !l.trim().is_empty() && !old.contains(l)).collect()
}

#[cfg(test)]
mod tests {
    use super::fair_share;

    #[test]
    fn short_recordings_leave_rows_to_long_ones() {
        assert_eq!(fair_share(vec![300, 10, 10, 10], 400), usize::MAX);
        assert_eq!(fair_share(vec![1000, 10, 30], 400), 360);
        assert_eq!(fair_share(vec![1000, 500, 30], 400), 185);
        assert_eq!(fair_share(Vec::new(), 400), usize::MAX);
    }
}
