//! The page of a calibrated model: `aurt run`, `aurt calibrate-validate`, `aurt demo`.

use aurt::{Outcome, RecordingResult, Role};
use aurt_calibration::Comparison;
use aurt_files::output::pretty;
use serde_json::Value;

use super::figures::{
    HOW_TO_LOOK, Series, TimeFigure, file_name, measured_axis, points_per_series, residuals_over, stem,
};
use super::parts;
use crate::figure::{BarGroup, Bars, Figure, Style};
use crate::page::{Block, Page, Section, Tone, Verdict};
use crate::rendering::number::{percent, significant};
use crate::results::metrics::Results;
use crate::table::Table;

pub fn of_outcome(outcome: &Outcome) -> Page {
    let results = Results::of(outcome, &[]);
    page("calibrate", &results, None, &results.to_json())
}

/// The page; `experiment` is the file that was run, where there is one, and `metrics` what metrics.json holds.
pub fn page(command: &str, results: &Results<'_>, experiment: Option<&str>, metrics: &Value) -> Page {
    let mut sections = vec![errors(results)];
    // Recordings that were read in stretches have no rows to be shown.
    if results.recordings.iter().all(|r| !r.comparison.joints.is_empty()) {
        sections.extend([series(results), residuals(results)]);
    }
    sections.extend(results.calibration.essential.as_ref().map(super::essential::section));
    let parameters = &results.calibration.parameters;
    let parameters = parts::parameters(format!("{} coefficients", parameters.len()), parameters);
    sections.push(Section::new("Parameters", "", vec![parameters]));
    if let Some(text) = experiment {
        sections.push(parts::experiment("The experiment file", text));
    }
    Page {
        title: "Calibration of a robot model".into(),
        verdict: verdict(results),
        sections,
        provenance: provenance(command, results),
        results_json: pretty(metrics),
    }
}

fn held_out<'a>(results: &'a Results<'_>) -> Vec<&'a RecordingResult> {
    results.recordings.iter().filter(|r| r.role == Role::Validation).collect()
}

/// The held-out recordings, or all where none is held out.
fn judged<'a>(results: &'a Results<'_>) -> Vec<&'a RecordingResult> {
    let held_out = held_out(results);
    if held_out.is_empty() { results.recordings.iter().collect() } else { held_out }
}

fn verdict(results: &Results<'_>) -> Verdict {
    let held_out = held_out(results);
    let fitted = results.recordings.len() - held_out.len();
    let errors: Vec<f64> = judged(results)
        .iter()
        .flat_map(|r| &r.validation.all.nrmse)
        .copied()
        .filter(|e| e.is_finite())
        .collect();
    let [low, high] = errors
        .iter()
        .fold([f64::INFINITY, 0.0], |[low, high], e| [low.min(*e), f64::max(high, *e)])
        .map(percent);
    let plural = |n: usize, what: &str| if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") };
    let headline = if errors.is_empty() {
        "The model is calibrated; no error could be computed".to_owned()
    } else if held_out.is_empty() {
        format!(
            "Calibrated on {}; its error there is {low} % to {high} % of the signal, joint by joint. No recording was \
             held out",
            plural(fitted, "recording")
        )
    } else {
        format!(
            "Calibrated on {}; on {}, held out, its error is {low} % to {high} % of the signal, joint by joint",
            plural(fitted, "recording"),
            plural(held_out.len(), "recording")
        )
    };
    let mut sentences: Vec<String> = results.calibration.warnings.clone();
    for recording in results.recordings {
        let named = |w: &String| format!("{}: {w}", stem(&recording.label));
        sentences.extend(recording.validation.warnings.iter().map(named));
    }
    let tone = if sentences.is_empty() { Tone::Good } else { Tone::Attention };
    if sentences.is_empty() {
        sentences.push(
            "No warnings: parameters are excited, and no recording leaves what calibration covered.".into(),
        );
    }
    Verdict { tone, headline, sentences }
}

fn errors(results: &Results<'_>) -> Section {
    let unit = results.calibration.unit.symbol();
    let joints = results.model.joints();
    let pooled = |role: Role, joint: usize| {
        let of_role = || results.recordings.iter().filter(move |r| r.role == role);
        let (sum, count) = of_role().fold((0.0, 0.0), |(sum, count), r| {
            let rows = r.validation.samples as f64;
            (sum + rows * r.validation.all.mse[joint], count + rows)
        });
        (count > 0.0).then(|| (sum / count).sqrt()).filter(|v| v.is_finite())
    };
    let groups = (0..joints)
        .map(|j| BarGroup {
            label: results.names().joint(j),
            values: vec![pooled(Role::Calibration, j), pooled(Role::Validation, j)],
            level: None,
        })
        .collect();
    let bars = Figure::Bars(Bars {
        title: "root mean square error".into(),
        name: "errors".into(),
        caption: "Each joint on its own scale.".into(),
        unit: unit.into(),
        series: vec![("fitted".into(), Style::Measured), ("held out".into(), Style::After)],
        level_name: String::new(),
        one_scale: false,
        groups,
    });
    let tables = results.recordings.iter().map(|recording| Block::Table(table(recording, results)));
    Section::new(
        "Errors",
        "NMSE is the mean squared error over the mean of |measurement|, NRMS the root of squared error \
         over squared measurement. Moving rows are those at which the joint itself moves.",
        std::iter::once(Block::Figure(bars)).chain(tables).collect(),
    )
}

fn table(recording: &RecordingResult, results: &Results<'_>) -> Table {
    let validation = &recording.validation;
    let caption = format!(
        "{} ({}), {} rows; moving: |q̇| > {}",
        file_name(&recording.label),
        recording.role.name(),
        validation.samples,
        results.rest_velocity()
    );
    let joint = parts::joint_column(results.names());
    let mut table = Table::new(caption, results.error_headings(joint, "moving rows"));
    results.error_cells(validation).for_each(|cells| table.row(cells));
    table
}

fn series(results: &Results<'_>) -> Section {
    let unit = results.calibration.unit;
    let joints = results.model.joints();
    let names = results.names();
    let points = points_per_series(3 * joints * results.recordings.len());
    let mut order: Vec<&RecordingResult> = results.recordings.iter().collect();
    order.sort_by_key(|r| r.role == Role::Calibration);
    let mut blocks = Vec::new();
    for (k, recording) in order.into_iter().enumerate() {
        let Comparison { time_s, segment_starts, joints } = &recording.comparison;
        let origin = recording.first_stamp_s;
        let time: Vec<f64> = time_s.iter().map(|t| t - origin).collect();
        let figures = joints.iter().enumerate().map(|(j, joint)| {
            let residual: Vec<f64> =
                joint.measured.iter().zip(&joint.predicted).map(|(y, p)| y - p).collect();
            let label = |name, style, values| Series { name, style, values };
            let slides = results.model.rigid_body().slides(j);
            let figure = TimeFigure {
                title: format!("{}, {}", names.joint(j), stem(&recording.label)),
                name: format!("{}_{}_joint_{j}", stem(&recording.label), recording.role.name()),
                time_s: &time,
                segment_starts,
                panels: vec![
                    (
                        measured_axis(None, unit, slides),
                        vec![
                            label("measured", Style::Measured, &joint.measured),
                            label("predicted", Style::Predicted, &joint.predicted),
                        ],
                    ),
                    (
                        measured_axis(Some("residual"), unit, slides),
                        vec![label("residual", Style::Before, &residual)],
                    ),
                ],
                windows: &[],
                link: format!("recording {k}"),
            };
            Block::Figure(figure.figure(points))
        });
        blocks.push(Block::Folded {
            title: format!("{} ({})", file_name(&recording.label), recording.role.name()),
            open: k == 0,
            blocks: figures.collect(),
        });
    }
    Section::new(
        "Measured and predicted",
        format!("Filtered and decimated as in the fit. {HOW_TO_LOOK}"),
        blocks,
    )
}

fn residuals(results: &Results<'_>) -> Section {
    let judged = judged(results);
    let names = results.names();
    let bodies = results.model.rigid_body();
    let blocks = (0..results.model.joints())
        .map(|j| {
            let all = |of: &dyn Fn(&RecordingResult) -> Vec<f64>| -> Vec<f64> {
                judged.iter().flat_map(|r| of(r)).collect()
            };
            let joint = |r: &RecordingResult| r.comparison.joints[j].clone();
            let residual = all(&|r| {
                let joint = joint(r);
                joint.measured.iter().zip(&joint.predicted).map(|(y, p)| y - p).collect()
            });
            let coordinates = [
                all(&|r| joint(r).velocity_rad_s),
                all(&|r| joint(r).position_rad),
                all(&|r| joint(r).rigid_body),
                all(&|r| joint(r).acceleration_rad_s2),
                all(&|r| r.comparison.time_s.iter().map(|t| t - r.first_stamp_s).collect()),
            ];
            let residual = Series { name: "class means", style: Style::Before, values: &residual };
            let unit = (results.calibration.unit, bodies.slides(j));
            residuals_over((j, names.joint(j)), j == 0, coordinates, unit, &[residual])
        })
        .collect();
    let of = if judged.iter().any(|r| r.role == Role::Validation) { "held-out" } else { "fitted" };
    let introduction = format!(
        "Residuals of the {of} recordings over each coordinate, with means over classes of equal count. With a \
         complete model all means are near zero; where they deviate, physics is missing, and aurt diagnose \
         searches for it."
    );
    Section::new("What the residual follows", introduction, blocks)
}

fn provenance(command: &str, results: &Results<'_>) -> Vec<(String, String)> {
    let mut entries = parts::program(command);
    entries.extend(parts::calibration_provenance(results.model, results.calibration));
    entries.extend(results.notes.iter().map(|n| parts::entry("Robot", n.as_str())));
    if let Some(report) = &results.calibration.shape_fit {
        let shapes: Vec<String> = report
            .shapes
            .iter()
            .map(|s| format!("{} {} = {} {}", s.model, s.name, significant(s.value, 4), s.unit))
            .collect();
        entries.push(parts::entry("Shape parameters that were searched", shapes.join("; ")));
    }
    for recording in results.recordings {
        let window = recording.window_s.map_or(String::new(), |[from, to]| format!(", {from} s to {to} s"));
        entries.push(parts::entry(
            format!("{} ({}{window})", recording.label, recording.role.name()),
            recording.notes.join("; "),
        ));
    }
    entries
}
