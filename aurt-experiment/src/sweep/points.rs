//! From `[sweep]` to points: one resolved experiment each.

use std::path::{Path, PathBuf};

use crate::{Complaint, Experiment, ExperimentErrors, Problem};
use aurt_plugins::{Node, Registry, Span};
use toml::Table;

use crate::sweep::SweepError;
use crate::sweep::definition::{Definition, Setting, Step, Validate};
use crate::sweep::documents::{make_absolute, path_at};
use crate::sweep::place::{brief, to_toml};

/// A sweep: an experiment and the points that its `[sweep]` makes of it.
#[derive(Debug, Clone)]
pub struct Sweep {
    pub path: PathBuf,
    pub text: String,
    pub definition: Definition,
    pub points: Vec<Point>,
    pub reference: usize,
}

#[derive(Debug, Clone)]
pub struct Point {
    pub name: String,
    /// Its experiment as TOML, without `[sweep]` and with absolute paths.
    pub text: String,
    pub experiment: Experiment,
}

/// Points beyond this number are a slip of the pen.
const MOST_POINTS: usize = 1_000_000;

impl Sweep {
    /// Reads an experiment and resolves all points of its sweep. Libraries that it names are loaded into `registry`.
    pub fn read(path: &Path, registry: &mut Registry) -> Result<Self, SweepError> {
        let base = Experiment::read(path, registry)?;
        let Some(node) = &base.sweep else { return Err(SweepError::NoSweep { path: path.to_owned() }) };
        let refuse = |complaints: Vec<Complaint>| refusal(path, &base.source_text, complaints);
        let definition = Definition::read(node).map_err(refuse)?;
        let mut document: Table = toml::from_str(&base.source_text).map_err(|error| {
            let span = error.span().unwrap_or(0..0);
            refuse(vec![Complaint::new(&span, error.message().to_owned())])
        })?;
        document.remove("sweep");
        let points = resolve(&definition, &document, path, &base.source_text, registry).map_err(refuse)?;
        if points.iter().any(|p| !held_out(&p.experiment, definition.validate)) {
            return Err(SweepError::NothingHeldOut { path: path.to_owned() });
        }
        let reference = match &definition.reference {
            None => 0,
            Some((name, span)) => points.iter().position(|p| p.name == *name).ok_or_else(|| {
                let names = points.iter().map(|p| p.name.as_str());
                let help = aurt_plugins::suggestion::help(name, "points", names);
                refuse(vec![Complaint::new(span, format!("there is no point \"{name}\"")).help(help)])
            })?,
        };
        Ok(Self { path: path.to_owned(), text: base.source_text.clone(), definition, points, reference })
    }
}

fn refusal(path: &Path, text: &str, complaints: Vec<Complaint>) -> SweepError {
    let mut problems: Vec<Problem> = complaints.into_iter().map(|c| c.located(text)).collect();
    problems.sort_by_key(|p| (p.span.start, p.span.end));
    problems.dedup();
    let errors = ExperimentErrors { path: path.to_owned(), source_text: text.to_owned(), problems };
    SweepError::Definition(Box::new(errors))
}

fn held_out(experiment: &Experiment, validate: Validate) -> bool {
    match validate {
        Validate::HeldOut => !experiment.recordings.validation.is_empty(),
        Validate::LeaveOneOut => experiment.recordings.calibration.len() >= 2,
    }
}

/// Every combination of the axes' steps, the last axis changing fastest.
fn combinations(definition: &Definition) -> Vec<Vec<&Step>> {
    let mut all: Vec<Vec<&Step>> = vec![Vec::new()];
    for axis in &definition.axes {
        all = all
            .into_iter()
            .flat_map(|chosen| {
                axis.iter().map(move |step| {
                    let mut chosen = chosen.clone();
                    chosen.push(step);
                    chosen
                })
            })
            .collect();
    }
    all
}

fn resolve(
    definition: &Definition,
    document: &Table,
    path: &Path,
    written: &str,
    registry: &mut Registry,
) -> Result<Vec<Point>, Vec<Complaint>> {
    let count: usize = definition.axes.iter().map(Vec::len).product();
    if count > MOST_POINTS {
        let message = format!("[sweep] makes {count} points, more than {MOST_POINTS}");
        return Err(vec![Complaint::new(0..0, message)]);
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let (mut points, mut complaints): (Vec<Point>, Vec<Complaint>) = (Vec::new(), Vec::new());
    for steps in combinations(definition) {
        let name = name_of(&steps);
        let settings: Vec<&Setting> = steps.iter().flat_map(|s| &s.settings).collect();
        let before = complaints.len();
        let mut resolved = document.clone();
        for setting in &settings {
            if let Err(reason) = setting.place.put(&mut resolved, to_toml(&setting.value)) {
                let complaint = Complaint::new(&setting.key_span, format!("`{}`: {reason}", setting.place));
                complaints.push(with_suggestion(complaint, setting, document));
            }
        }
        if complaints.len() > before {
            continue;
        }
        make_absolute(&mut resolved, folder);
        let text = resolved.to_string();
        match Experiment::parse(&text, path, registry) {
            Ok(experiment) => points.push(Point { name, text, experiment }),
            Err(errors) => complaints.extend(
                errors.problems.iter().map(|problem| blame(problem, &text, &settings, &name, document)),
            ),
        }
    }
    complaints.extend(twins(&points, definition, written));
    // A wrong value of one axis is wrong at every point that has it.
    complaints.sort_by_key(|c| c.span.start);
    complaints.dedup_by(|a, b| a.span == b.span && without_point(&a.message) == without_point(&b.message));
    if complaints.is_empty() { Ok(points) } else { Err(complaints) }
}

fn without_point(message: &str) -> &str {
    message.rsplit_once(POINT).map_or(message, |(what, _)| what)
}

/// Between what is wrong and the point at which it is.
const POINT: &str = ", at point ";

/// A problem of a resolved experiment, laid to the setting that brought it in.
fn blame(problem: &Problem, text: &str, settings: &[&Setting], name: &str, document: &Table) -> Complaint {
    let way = path_at(text, &problem.span);
    let common = |s: &Setting| s.place.parts().iter().zip(&way).take_while(|(a, b)| a == b).count();
    let guilty = settings.iter().max_by_key(|s| common(s));
    let message = format!("{}{POINT}\"{name}\"", problem.message);
    let Some(setting) = guilty else { return Complaint { span: 0..0, message, help: problem.help.clone() } };
    let depth = setting.place.parts().len();
    // Below the setting's place, the problem stands in the value as it was written; above it, the key is to blame.
    let span = if common(setting) == depth && way.len() > depth {
        written_at(&setting.value, &way[depth..])
    } else if common(setting) == depth && !problem.message.contains("has no key") {
        setting.value.span.clone()
    } else {
        setting.key_span.clone()
    };
    with_suggestion(Complaint { span, message, help: problem.help.clone() }, setting, document)
}

/// Where the value at the end of a way below `node` is written, as far as the way goes; of a key the key.
fn written_at(node: &Node, way: &[String]) -> Span {
    let Some((first, rest)) = way.split_first() else { return node.span.clone() };
    if let Some(entry) = node.entry(first) {
        return if rest.is_empty() && entry.value.span.is_empty() {
            entry.key_span.clone()
        } else if rest.is_empty() {
            entry.key_span.start..entry.value.span.end.max(entry.key_span.end)
        } else {
            written_at(&entry.value, rest)
        };
    }
    match (&node.kind, first.parse::<usize>()) {
        (aurt_plugins::NodeKind::Array(items), Ok(k)) if k < items.len() => written_at(&items[k], rest),
        _ => node.span.clone(),
    }
}

/// Adds the key of the experiment that was probably meant, where the help does not say so yet.
fn with_suggestion(complaint: Complaint, setting: &Setting, document: &Table) -> Complaint {
    if complaint.help.as_ref().is_some_and(|h| h.contains("did you mean")) {
        return complaint;
    }
    let Some((part, meant)) = setting.place.likely(document) else { return complaint };
    let suggestion = format!("did you mean `{meant}` where `{}` says `{part}`?", setting.place);
    let help = match &complaint.help {
        Some(help) => format!("{suggestion} {help}"),
        None => suggestion,
    };
    complaint.help(help)
}

fn name_of(steps: &[&Step]) -> String {
    let parts: Vec<String> = steps
        .iter()
        .flat_map(|step| match &step.name {
            Some(name) => vec![name.clone()],
            None => {
                step.settings.iter().map(|s| format!("{}={}", s.place.short(), brief(&s.value))).collect()
            }
        })
        .collect();
    parts.join(", ")
}

/// Points of one name: a value that an axis has twice.
fn twins(points: &[Point], definition: &Definition, written: &str) -> Option<Complaint> {
    let mut names: Vec<&str> = points.iter().map(|p| p.name.as_str()).collect();
    names.sort_unstable();
    let twin = names.windows(2).find(|pair| pair[0] == pair[1])?;
    let doubled = definition.axes.iter().flat_map(|axis| {
        axis.iter()
            .enumerate()
            .filter(|(k, step)| axis[..*k].iter().any(|s| name_of(&[s]) == name_of(&[*step])))
    });
    let span = doubled
        .filter_map(|(_, step)| step.settings.first())
        .map(|s| s.value.span.clone())
        .find(|s| s.end <= written.len())
        .unwrap_or(0..0);
    Some(Complaint::new(&span, format!("two points are \"{}\"; leave out what is there twice", twin[0])))
}
