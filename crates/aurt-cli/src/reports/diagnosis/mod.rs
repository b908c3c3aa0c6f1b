//! The page of a diagnosis.

mod findings;
mod rows;

use aurt_calibration::Calibration;
use aurt_diagnosis::{Answer, RecordingSeries, Role, Verdict as Found};
use aurt_report::{BarGroup, Bars, Block, Cell, Figure, Page, Section, Style, Table, Tone, Verdict};
use aurt_traits::{MeasurementUnit, RobotModel};
use serde_json::Value;

use super::{figures::file_name, parts};
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
            let lower = (0..joints).filter(|j| ratio(*j) < 1.0).count();
            sentences.push(format!(
                "On data that took no part the error falls on {lower} of {joints} joints; on joint {j}, which gains most, it \
                 goes from {} {unit} to {} {unit}, and noise alone leaves {} {unit}.",
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
