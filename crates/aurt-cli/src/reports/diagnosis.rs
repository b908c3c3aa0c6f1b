//! The page of a diagnosis.

use aurt_calibration::Calibration;
use aurt_diagnosis::{Answer, Finding, RecordingSeries, Role, Verdict as Found};
use aurt_report::{Axis, BarGroup, Bars, Block, Cell, Figure, Page, Section, Style, Table, Tone, Verdict};
use aurt_traits::{MeasurementUnit, RobotModel};
use serde_json::Value;

use super::{
    figures::{Series, TimeFigure, file_name, points_per_series, residual_over, stem},
    parts,
};
use crate::rendering::{json::pretty, number::significant};

/// What a diagnosis leaves for its page.
pub struct Diagnosed<'a> {
    /// The verdict.
    pub verdict: &'a Found,
    /// The rows behind it.
    pub series: &'a [RecordingSeries],
    /// Unit of the measurement.
    pub unit: MeasurementUnit,
    /// The improved model, calibrated.
    pub improved: (&'a RobotModel, &'a Calibration),
    /// The lines that the improved experiment has and the original has not.
    pub added: Vec<String>,
    /// Notes about the improved model.
    pub notes: &'a [String],
    /// What was done to each recording, in the order of the series.
    pub recording_notes: Vec<Vec<String>>,
    /// What verdict.json holds.
    pub document: &'a Value,
}

/// The answer in words.
pub const fn headline(answer: Answer) -> &'static str {
    match answer {
        Answer::NoMismatch => "nothing is missing: what is left is noise",
        Answer::Named => "the missing physics has a name",
        Answer::Ambiguous => "one of a class of effects that these recordings cannot separate",
        Answer::Unexplained => "something is missing that no known effect accounts for",
    }
}

impl Diagnosed<'_> {
    /// The page.
    pub fn page(&self) -> Page {
        let mut sections = vec![self.improvement()];
        if !self.verdict.effects.is_empty() {
            sections.push(self.findings());
        }
        sections.push(self.over_time());
        sections.push(self.over_coordinates());
        sections.push(self.model());
        sections.push(self.limits());
        let (model, calibration) = self.improved;
        let mut provenance = parts::program("diagnose");
        provenance.push(parts::entry(
            "Method",
            "candidates of all known effects, selected by cross-validation over six blocks of time; held-out rows took \
             no part in selection or fitting",
        ));
        for (series, notes) in self.series.iter().zip(&self.recording_notes) {
            provenance
                .push(parts::entry(format!("{} ({})", series.name, role(series.role)), notes.join("; ")));
        }
        provenance.extend(
            parts::calibration_provenance(model, calibration)
                .into_iter()
                .map(|(name, value)| (format!("Improved model: {name}"), value)),
        );
        Page {
            title: "Diagnosis of a robot model".into(),
            verdict: self.answer(),
            sections,
            provenance,
            results_json: pretty(self.document),
        }
    }

    fn answer(&self) -> Verdict {
        let words = headline(self.verdict.verdict);
        let mut headline: String = words.chars().take(1).flat_map(char::to_uppercase).collect();
        headline.extend(words.chars().skip(1));
        let mut sentences: Vec<String> =
            self.verdict.effects.iter().map(|f| format!("{}.", capital(&f.sentence))).collect();
        let held = &self.verdict.held_out;
        let ratio = |j: usize| held.rms_after[j] / held.rms_before[j];
        let joints = held.rms_before.len().min(held.rms_after.len());
        let most =
            (0..joints).filter(|j| ratio(*j).is_finite()).min_by(|a, b| ratio(*a).total_cmp(&ratio(*b)));
        if let Some(j) = most.filter(|_| !self.verdict.effects.is_empty()) {
            sentences.push(format!(
                "On data that took no part the error of joint {j} falls from {} {unit} to {} {unit}; noise alone leaves \
                 {} {unit}.",
                significant(held.rms_before[j], 3),
                significant(held.rms_after[j], 3),
                significant(held.rms_floor.get(j).copied().unwrap_or(f64::NAN), 3),
                unit = self.unit.symbol()
            ));
        }
        let left: Vec<String> =
            self.verdict.residual.iter().filter(|r| r.structure_left).map(|r| r.joint.to_string()).collect();
        if !left.is_empty() {
            sentences.push(format!(
                "More than noise is left on joint{} {}.",
                if left.len() == 1 { "" } else { "s" },
                parts::listed(&left)
            ));
        }
        let tone = match self.verdict.verdict {
            Answer::NoMismatch => Tone::Good,
            Answer::Named | Answer::Ambiguous => Tone::Found,
            Answer::Unexplained => Tone::Attention,
        };
        Verdict { tone, headline, sentences }
    }

    fn improvement(&self) -> Section {
        let unit = self.unit.symbol();
        let held = &self.verdict.held_out;
        let value = |list: &[f64], j: usize| list.get(j).copied().filter(|v| v.is_finite());
        let groups = (0..held.rms_before.len())
            .map(|j| BarGroup {
                label: format!("joint {j}"),
                values: vec![value(&held.rms_before, j), value(&held.rms_after, j)],
                level: value(&held.rms_floor, j),
            })
            .collect();
        let bars = Bars {
            title: "held-out error, root mean square".into(),
            name: "held_out".into(),
            caption: format!("Each joint on its own scale. Held out: {}.", names(&held.recordings)),
            unit: unit.into(),
            series: vec![("before".into(), Style::Before), ("after".into(), Style::After)],
            level_name: "noise alone".into(),
            one_scale: false,
            groups,
        };
        let mut table = Table::new(
            format!("residual, root mean square in {unit}"),
            [
                "joint",
                "before",
                "after",
                "noise",
                "held out: before",
                "after",
                "noise",
                "<what is left follows",
            ],
        );
        for r in &self.verdict.residual {
            let of = |list: &[f64]| value(list, r.joint).map_or_else(|| "–".into(), |v| significant(v, 4));
            let follows = match (&r.follows, r.structure_left) {
                (Some(what), _) => format!("{what} ({:.0} % of it)", 100.0 * r.follows_share),
                (None, true) => "nothing known".into(),
                (None, false) => "nothing: noise".into(),
            };
            table.row([
                Cell::from(r.joint.to_string()),
                Cell::from(significant(r.baseline_rms, 4)),
                Cell { text: significant(r.unexplained_rms, 4), strong: r.structure_left },
                Cell::from(significant(r.floor_rms, 4)),
                Cell::from(of(&held.rms_before)),
                Cell::from(of(&held.rms_after)),
                Cell::from(of(&held.rms_floor)),
                Cell::from(follows),
            ]);
        }
        Section {
            title: "Before and after".into(),
            introduction: "Before: the model in question. After: with what was found. The left columns are of the rows \
                           that were fitted, where both models were fitted to all of them; held-out rows took no part, \
                           and there the model in question is as it was calibrated."
                .into(),
            blocks: vec![Block::Figure(Figure::Bars(bars)), Block::Table(table)],
        }
    }

    fn findings(&self) -> Section {
        let several = self.verdict.effects.len() > 4;
        let blocks = self
            .verdict
            .effects
            .iter()
            .enumerate()
            .map(|(k, finding)| Block::Folded {
                title: format!("{}. {}", k + 1, finding.sentence),
                open: !several || k < 2,
                blocks: finding_blocks(finding),
            })
            .collect();
        Section {
            title: "What was found".into(),
            introduction:
                "aurt explain NAME says of each effect what it is, how it shows, and what it is easily \
                           confused with."
                    .into(),
            blocks,
        }
    }

    /// Windows that are set off in one joint's figure: those of findings, and those in which the rest stands out.
    fn windows(&self, series: &RecordingSeries, joint: usize) -> Vec<([f64; 2], &'static str)> {
        let located = self.verdict.effects.iter().filter(|f| {
            f.recording.as_deref() == Some(series.name.as_str())
                && (f.joints.is_empty() || f.joints.contains(&joint))
        });
        let left = series.joints[joint].windows_s.iter().map(|w| (*w, "what is left stands out"));
        located.filter_map(|f| Some((f.window_s?, "located"))).chain(left).collect()
    }

    fn over_time(&self) -> Section {
        let (quantity, unit) = (self.unit.quantity(), self.unit.symbol());
        let count: usize = self.series.iter().map(|s| s.joints.len()).sum();
        let points = points_per_series(5 * count);
        let mut order: Vec<&RecordingSeries> = self.series.iter().collect();
        // What took no part convinces most, then what was asked about.
        order.sort_by_key(|s| match s.role {
            Role::Validation => 0,
            Role::Target => 1,
            Role::Calibration => 2,
        });
        let mut blocks = Vec::new();
        for (k, series) in order.into_iter().enumerate() {
            let figures = series.joints.iter().enumerate().map(|(j, joint)| {
                let mut panels = Vec::new();
                let predictions = joint.measured.as_ref().map(|measured| {
                    let less = |residual: &[f64]| -> Vec<f64> {
                        measured.iter().zip(residual).map(|(y, r)| y - r).collect()
                    };
                    (measured, less(&joint.before), less(&joint.after))
                });
                let line = |name, style, values| Series { name, style, values };
                if let Some((measured, before, after)) = &predictions {
                    panels.push((
                        Axis::new(quantity, unit),
                        vec![
                            line("measured", Style::Measured, measured.as_slice()),
                            line("before", Style::Before, before.as_slice()),
                            line("after", Style::After, after.as_slice()),
                        ],
                    ));
                }
                panels.push((
                    Axis::new("residual", unit),
                    vec![
                        line("before", Style::Before, joint.before.as_slice()),
                        line("after", Style::After, joint.after.as_slice()),
                    ],
                ));
                let figure = TimeFigure {
                    title: format!("joint {j}, {}", stem(&series.name)),
                    name: format!("{}_{}_joint_{j}", stem(&series.name), role(series.role)),
                    caption: String::new(),
                    time_s: &series.time_s,
                    segment_starts: &series.segment_starts,
                    panels,
                    windows: &self.windows(series, j),
                    link: format!("recording {k}"),
                };
                Block::Figure(figure.figure(points))
            });
            let part = match (series.role, series.held_out_from < series.time_s.len()) {
                (Role::Validation, _) => "held out".to_owned(),
                (of, true) => format!(
                    "{}, held out from {:.1} s",
                    role(of),
                    series.time_s.get(series.held_out_from).copied().unwrap_or(0.0)
                ),
                (of, false) => role(of).to_owned(),
            };
            blocks.push(Block::Folded {
                title: format!("{} ({part})", file_name(&series.name)),
                open: k == 0,
                blocks: figures.collect(),
            });
        }
        Section {
            title: "Measured and predicted".into(),
            introduction: "Filtered and decimated as in the fit. Interrupted lines: rows that do not count, because the \
                           joint stands or the recording is faulty. Drag over a stretch to look closer, drag with Shift \
                           to move, double-click for all; + − ← → 0 do the same once a plot has the focus."
                .into(),
            blocks,
        }
    }

    fn over_coordinates(&self) -> Section {
        let unit = self.unit.symbol();
        let judged: Vec<(&RecordingSeries, usize)> = self
            .series
            .iter()
            .map(|s| (s, s.held_out_from))
            .filter(|(s, from)| *from < s.time_s.len())
            .collect();
        let joints = self.series.first().map_or(0, |s| s.joints.len());
        let worst = self
            .verdict
            .residual
            .iter()
            .max_by(|a, b| (a.baseline_rms / a.floor_rms).total_cmp(&(b.baseline_rms / b.floor_rms)));
        let blocks = (0..joints)
            .map(|j| {
                type Pick = fn(&RecordingSeries, usize) -> &[f64];
                let all = |of: Pick| -> Vec<f64> {
                    judged.iter().flat_map(|(s, from)| of(s, j)[*from..].iter().copied()).collect()
                };
                let before = all(|s, j| &s.joints[j].before);
                let after = all(|s, j| &s.joints[j].after);
                let coordinates: [(&str, &str, Pick); 5] = [
                    ("velocity", "rad/s", |s, j| &s.joints[j].velocity_rad_s),
                    ("position", "rad", |s, j| &s.joints[j].position_rad),
                    ("load torque", unit, |s, j| &s.joints[j].load_torque),
                    ("acceleration", "rad/s²", |s, j| &s.joints[j].acceleration_rad_s2),
                    ("time", "s", |s, _| &s.time_s),
                ];
                let figures = coordinates.map(|(name, x_unit, of)| {
                    residual_over(
                        format!("joint {j} over {name}"),
                        format!("residual_joint_{j}_over_{}", name.replace(' ', "_")),
                        Axis::new(name, x_unit),
                        &all(of),
                        unit,
                        &[
                            Series { name: "before", style: Style::Before, values: &before },
                            Series { name: "after", style: Style::After, values: &after },
                        ],
                    )
                });
                Block::Folded {
                    title: format!("joint {j}"),
                    open: worst.is_some_and(|w| w.joint == j),
                    blocks: vec![Block::Figures(figures.into())],
                }
            })
            .collect();
        Section {
            title: "What the residual follows".into(),
            introduction: "Residuals of the held-out rows over each coordinate, with means over classes of equal count. \
                           What bends before and is flat after has been explained; what bends after is still missing."
                .into(),
            blocks,
        }
    }

    fn model(&self) -> Section {
        let (_, calibration) = self.improved;
        let mut blocks = Vec::new();
        if !self.added.is_empty() {
            blocks.push(Block::Text("Added to the experiment:".into()));
            blocks.push(Block::Code(self.added.join("\n")));
        }
        blocks.push(Block::List(self.notes.to_vec()));
        blocks.push(parts::parameters(
            &format!("{} coefficients of the improved model", calibration.parameters.len()),
            &calibration.parameters,
            false,
        ));
        Section {
            title: "The improved model".into(),
            introduction:
                "improved.toml is the experiment with what was found, rd_improved.json the model calibrated \
                           from it; run, predict and diagnose accept them."
                    .into(),
            blocks,
        }
    }

    fn limits(&self) -> Section {
        let mut blocks = Vec::new();
        if !self.verdict.not_decidable.is_empty() {
            let mut table = Table::new(
                "what these recordings can neither show nor exclude",
                ["<effect", "<joints", "absorbed by the model %", "<what would decide it"],
            );
            for n in &self.verdict.not_decidable {
                let joints: Vec<String> = n.joints.iter().map(ToString::to_string).collect();
                table.row([
                    n.effect.clone(),
                    joints.join(", "),
                    format!("{:.1}", 100.0 * n.absorbed),
                    n.record.clone(),
                ]);
            }
            blocks.push(Block::Table(table));
        }
        if !self.verdict.shifts.is_empty() {
            let mut table = Table::new(
                "parameters of the rest of the model that moved most when the effects were added",
                ["<parameter", "before", "after", "standard deviations"],
            );
            for s in &self.verdict.shifts {
                table.row([
                    s.parameter.clone(),
                    significant(s.before, 4),
                    significant(s.after, 4),
                    significant(s.in_std, 3),
                ]);
            }
            blocks.push(Block::Table(table));
        }
        blocks.push(Block::List(self.verdict.notes.iter().map(|n| format!("{}.", capital(n))).collect()));
        Section { title: "Limits".into(), introduction: String::new(), blocks }
    }
}

fn names(recordings: &[String]) -> String {
    recordings.iter().map(|r| file_name(r)).collect::<Vec<_>>().join(", ")
}

fn capital(sentence: &str) -> String {
    let mut rest = sentence.chars();
    rest.next().map_or_else(String::new, |first| first.to_uppercase().chain(rest).collect())
}

const fn role(role: Role) -> &'static str {
    match role {
        Role::Calibration => "calibration",
        Role::Target => "target",
        Role::Validation => "validation",
    }
}

fn finding_blocks(finding: &Finding) -> Vec<Block> {
    let mut table = Table::new("", ["<parameter", "<of", "value", "± 1 σ"]);
    for (name, parameter) in &finding.parameters {
        match (&parameter.value, &parameter.std) {
            (Value::Array(values), stds) => {
                for (k, value) in values.iter().enumerate() {
                    let of = component(finding, name, values.len(), k);
                    table.row([name.clone(), of, text(value), text(stds.get(k).unwrap_or(&Value::Null))]);
                }
            }
            (value, std) => table.row([name.clone(), String::new(), text(value), text(std)]),
        }
    }
    let joints: Vec<String> = finding.joints.iter().map(ToString::to_string).collect();
    let mut facts = vec![format!(
        "{} on joints {}, in {} recordings; score {:.0}, {:.0} were needed",
        finding.effect,
        parts::listed(&joints),
        parts::listed(&finding.present_in),
        finding.evidence.score,
        finding.evidence.threshold
    )];
    if let Some([from, to]) = finding.window_s {
        let recording = finding.recording.as_deref().unwrap_or("the recording");
        facts.push(format!("from {from:.2} s to {to:.2} s of {recording}"));
    }
    for other in &finding.alternatives {
        facts.push(format!("or {}; to tell them apart: {}", other.effect, other.record));
    }
    let mut blocks = vec![Block::List(facts)];
    if !finding.parameters.is_empty() {
        blocks.push(Block::Table(table));
    }
    blocks
}

/// What an entry of a list is of: a component of a vector or tensor, or a joint.
fn component(finding: &Finding, parameter: &str, length: usize, entry: usize) -> String {
    const VECTOR: [&str; 3] = ["x", "y", "z"];
    const TENSOR: [&str; 6] = ["xx", "xy", "xz", "yy", "yz", "zz"];
    match (parameter, length) {
        (_, 3) if parameter.starts_with("com_") || finding.effect == "base_tilt" => VECTOR[entry].into(),
        (_, 6) if parameter.starts_with("inertia_") && finding.effect == "payload" => TENSOR[entry].into(),
        _ if length == finding.joints.len() => format!("joint {}", finding.joints[entry]),
        _ => (entry + 1).to_string(),
    }
}

/// A parameter's value, whatever it is made of.
fn text(value: &Value) -> String {
    match value {
        Value::Null => "–".into(),
        Value::Number(number) if number.is_f64() => significant(number.as_f64().unwrap_or(f64::NAN), 4),
        Value::String(text) => text.clone(),
        Value::Array(values) => values.iter().map(text).collect::<Vec<_>>().join(", "),
        other => other.to_string(),
    }
}
