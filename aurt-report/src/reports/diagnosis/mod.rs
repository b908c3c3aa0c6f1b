//! The page of a diagnosis.

pub mod arm;
mod findings;
mod rows;

use aurt::{Asked, Explanation};
use aurt_calibration::Calibration;
use aurt_diagnosis::{Answer, QuestionedRecording, RecordingSeries, Share, Verdict as Found};
use aurt_files::output::pretty;
use aurt_traits::{MeasurementUnit, RobotModel};
use serde_json::Value;

use super::figures::file_name;
use super::parts;
use crate::figure::{BarGroup, Bars, Figure, Style};
use crate::noise_report::{NoiseReport, NoiseState};
use crate::page::{Block, Page, Section, Verdict};
use crate::rendering::number::significant;
use crate::rendering::text::capital;
use crate::table::{Cell, Table};
use crate::words::{self, Group, claim, follows, groups, nothing, objection};

pub struct Diagnosed<'a> {
    pub verdict: &'a Found,
    pub asked: Asked,
    /// What was held out, with its part of the recording.
    pub held_out: &'a [String],
    pub series: &'a [RecordingSeries],
    pub unit: MeasurementUnit,
    pub improved: (&'a RobotModel, &'a Calibration),
    /// The lines that the improved experiment has and the original has not.
    pub added: Vec<String>,
    pub notes: &'a [String],
    /// What was done to each recording, in the order of the series.
    pub recording_notes: Vec<Vec<String>>,
    pub document: &'a Value,
    /// The robot as it is drawn, where it can be.
    pub arm: Option<arm::Outline>,
}

impl<'a> Diagnosed<'a> {
    /// What a diagnosis of recordings in memory leaves; `document` is what verdict.json would hold.
    pub fn of(explanation: &'a Explanation, document: &'a Value) -> Self {
        let Explanation { diagnosis, model, recordings, .. } = explanation;
        Self {
            verdict: &diagnosis.verdict,
            asked: diagnosis.asked,
            held_out: &diagnosis.verdict.held_out.recordings,
            series: &explanation.series,
            unit: diagnosis.unit,
            improved: (&model.model, &model.calibration),
            added: explanation.added.clone(),
            notes: &explanation.notes,
            recording_notes: recordings.iter().map(notes).collect(),
            document,
            arm: arm::outline(&explanation.diagnosed, recordings),
        }
    }
}

/// What was found and done while a recording was read and preprocessed.
pub fn notes(recording: &QuestionedRecording) -> Vec<String> {
    let mut notes = recording.raw.report.notes();
    notes.extend(recording.data.data.report.notes());
    notes
}

impl Diagnosed<'_> {
    pub fn page(&self) -> Page {
        let mut sections = vec![self.improvement()];
        if self.found() {
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
            "candidates of all known effects, selected by cross-validation over six blocks of time; held-out rows are used \
             neither for selection nor for fitting",
        ));
        for (series, notes) in self.series.iter().zip(&self.recording_notes) {
            provenance
                .push(parts::entry(format!("{} ({})", series.name, series.role.name()), notes.join("; ")));
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

    const fn found(&self) -> bool {
        !self.verdict.effects.is_empty()
            || !self.verdict.registered_models.is_empty()
            || !self.verdict.indications.is_empty()
    }

    fn answer(&self) -> Verdict {
        let headline = capital(&words::headline(self.verdict, self.asked));
        let mut sentences: Vec<String> =
            groups(self.verdict, self.asked).iter().flat_map(|g| self.sentences(g)).collect();
        sentences.extend(self.verdict.registered_models.iter().map(|m| format!("{}.", capital(&m.sentence))));
        sentences.extend(self.verdict.warnings.iter().map(|w| format!("{}.", capital(w))));
        sentences.extend(
            self.improved.1.about_physics.iter().map(|w| format!("Warning about the improved model: {w}.")),
        );
        let held = &self.verdict.held_out;
        let ratio = |j: usize| held.rms_after[j] / held.rms_before[j];
        let joints = held.rms_before.len().min(held.rms_after.len());
        let (names, errors) = (self.verdict.names(), NoiseReport::of(self.verdict));
        let most =
            (0..joints).filter(|j| ratio(*j).is_finite()).min_by(|a, b| ratio(*a).total_cmp(&ratio(*b)));
        if let Some(j) = most.filter(|_| self.found()) {
            let lower = (0..joints).filter(|j| ratio(*j) < 1.0).count();
            sentences.push(format!(
                "On held-out data the error falls on {lower} of {joints} joints; on {}, which gains most, it \
                 goes from {} {unit} to {} {unit}, and the noise floor is {} {unit}.",
                names.joint(j),
                significant(held.rms_before[j], 3),
                significant(held.rms_after[j], 3),
                significant(held.rms_floor.get(j).copied().unwrap_or(f64::NAN), 3),
                unit = self.unit.symbol()
            ));
        }
        let structured = errors.in_state(NoiseState::Structured);
        if !structured.is_empty() {
            sentences.push(format!("More than noise is left on {}.", names.joint_list(&structured)));
        }
        let above = errors.in_state(NoiseState::AboveNoise);
        if !above.is_empty() {
            let said = names.joint_list_with(&above, |j| times(errors.joints[j].after.unwrap_or(f64::NAN)));
            sentences.push(format!("Above the noise floor, with no claim: {said}."));
        }
        sentences.extend(words::explained(self.verdict).map(|said| format!("{}.", capital(&said))));
        if self.verdict.verdict == Answer::NoMismatch {
            sentences.push(words::HOW_LARGE.to_owned());
        }
        Verdict { tone: errors.tone(self.verdict, self.asked), headline, sentences }
    }

    /// A group of findings in a sentence, or, where nothing is to be told apart, one for each; then what held-out data
    /// say against them.
    fn sentences(&self, group: &Group<'_>) -> Vec<String> {
        let claims = group.findings.iter().map(|(_, f)| claim(f, self.asked));
        let mut said: Vec<String> = if group.findings.is_empty() {
            vec![format!("{}: {}.", capital(group.title), nothing(self.verdict))]
        } else if group.title.is_empty() {
            claims.map(|c| format!("{}.", capital(&c))).collect()
        } else {
            vec![format!("{}: {}.", capital(group.title), claims.collect::<Vec<_>>().join("; "))]
        };
        said.extend(group.findings.iter().filter_map(|(number, finding)| {
            let objection = objection(self.verdict, finding, self.unit.symbol())?;
            Some(format!("Finding {number} ({}) {objection}.", finding.effect))
        }));
        said
    }

    fn improvement(&self) -> Section {
        let unit = self.unit.symbol();
        let held = &self.verdict.held_out;
        let (names, errors) = (self.verdict.names(), NoiseReport::of(self.verdict));
        let value = |list: &[f64], j: usize| list.get(j).copied().filter(|v| v.is_finite());
        let groups = (0..held.rms_before.len())
            .map(|j| BarGroup {
                label: names.joint(j),
                values: vec![value(&held.rms_before, j), value(&held.rms_after, j)],
                level: value(&held.rms_floor, j),
            })
            .collect();
        let bars = Bars {
            title: "held-out error, root mean square".into(),
            name: "held_out".into(),
            caption: format!(
                "Each joint on its own scale. Held out: {}{}.",
                file_names(self.held_out),
                words::band(self.verdict).map(|band| format!("; {band}")).unwrap_or_default()
            ),
            unit: unit.into(),
            series: vec![("before".into(), Style::Before), ("after".into(), Style::After)],
            level_name: "noise alone".into(),
            one_scale: false,
            groups,
        };
        let mut table = Table::new(
            format!("residual, root mean square in {unit}"),
            [
                parts::joint_column(names),
                "before",
                "after",
                "noise",
                "held out: before",
                "after",
                "noise",
                "<residual follows",
                "explained",
            ],
        );
        let beyond = errors.beyond_noise();
        let is_beyond = |joint: usize| beyond.contains(&joint);
        let share = |share: Option<Share>| {
            share.map_or_else(|| "–".into(), |s| format!("{:.0} ± {:.0} %", 100.0 * s.value, 100.0 * s.std))
        };
        for r in &self.verdict.residual {
            let explained = self.verdict.remainder.get(r.joint).and_then(|of| of.explained);
            let of = |list: &[f64]| value(list, r.joint).map_or_else(|| "–".into(), |v| significant(v, 4));
            table.row([
                Cell::from(names.joint_cell(r.joint)),
                Cell::from(significant(r.baseline_rms, 4)),
                Cell { text: significant(r.unexplained_rms, 4), strong: is_beyond(r.joint) },
                Cell::from(significant(r.floor_rms, 4)),
                Cell::from(of(&held.rms_before)),
                Cell { text: of(&held.rms_after), strong: is_beyond(r.joint) },
                Cell::from(of(&held.rms_floor)),
                Cell::from(follows(r, errors.joints.get(r.joint))),
                Cell::from(share(explained)),
            ]);
        }
        Section::new(
            "Before and after",
            "Before: the model in question. After: with what was found. The left columns are of the rows \
             that were fitted, where both models were fitted to all of them; on held-out rows the model \
             in question is as it was calibrated. Bold: more than noise.",
            vec![self.where_it_is(Figure::Bars(bars), &errors), Block::Table(table)],
        )
    }

    /// The bars, beside the arm if it can be drawn.
    fn where_it_is(&self, bars: Figure, errors: &NoiseReport) -> Block {
        match &self.arm {
            Some(outline) => {
                Block::Figures(vec![Figure::Arm(arm::figure(self.verdict.names(), errors, outline)), bars])
            }
            None => Block::Figure(bars),
        }
    }

    fn model(&self) -> Section {
        let (_, calibration) = self.improved;
        let mut blocks = Vec::new();
        if !self.added.is_empty() {
            blocks.push(Block::Text("Added to the experiment:".into()));
            blocks.push(Block::Code(self.added.join("\n")));
        }
        let notes: Vec<String> =
            self.notes.iter().chain(&calibration.warnings).map(|n| format!("{}.", capital(n))).collect();
        if !notes.is_empty() {
            blocks.push(Block::List(notes));
        }
        blocks.push(parts::parameters(
            format!("{} coefficients of the improved model", calibration.parameters.len()),
            &calibration.parameters,
        ));
        Section::new(
            "The improved model",
            "improved.toml is the experiment with what was found, rd_improved.json the model calibrated \
             from it; run, predict and diagnose accept them.",
            blocks,
        )
    }

    /// The gears that would have shown, joint by joint.
    fn visible_gears(&self) -> Option<Block> {
        let (gears, names) = (&self.verdict.gears_visible, self.verdict.names());
        let columns = [parts::joint_column(names), "stiffness below, Nm/rad", "play beyond ±, rad"];
        let mut table = Table::new("gears that these recordings would show; –: none", columns);
        let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |v| significant(v, 2));
        for gear in gears {
            table.row([names.joint_cell(gear.joint), number(gear.below_nm_rad), number(gear.beyond_rad)]);
        }
        (!gears.is_empty()).then_some(Block::Table(table))
    }

    fn limits(&self) -> Section {
        let mut blocks = Vec::new();
        if !self.verdict.not_decidable.is_empty() {
            let mut table = Table::new(
                "not decidable with these recordings",
                ["<effect", "<joints", "absorbed by the model %", "<what would decide it"],
            );
            for n in &self.verdict.not_decidable {
                table.row([
                    n.effect.clone(),
                    self.verdict.names().joint_list(&n.joints),
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
        blocks.extend(self.visible_gears());
        if !self.verdict.not_examined.is_empty() {
            blocks.push(Block::Text("Not examined:".into()));
            let reasons = self.verdict.not_examined.iter().map(|n| format!("{}.", capital(&n.reason)));
            blocks.push(Block::List(reasons.collect()));
        }
        let notes = self.verdict.notes.iter();
        let notes: Vec<String> = notes.map(|n| format!("{}.", capital(n))).collect();
        if !notes.is_empty() {
            blocks.push(Block::List(notes));
        }
        if blocks.is_empty() {
            blocks.push(Block::Text(
                "Every known effect would be visible in these recordings if it were present.".into(),
            ));
        }
        Section::new(
            "Limits",
            "What this diagnosis could not see, and what it moved. An effect that the rest of the model \
             absorbs leaves no error behind: these recordings can neither show nor exclude it.",
            blocks,
        )
    }
}

fn times(multiple: f64) -> String {
    format!(" ({multiple:.2} × noise)")
}

fn file_names(recordings: &[String]) -> String {
    recordings.iter().map(|r| file_name(r)).collect::<Vec<_>>().join(", ")
}
