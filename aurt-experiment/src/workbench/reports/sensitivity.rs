//! The page of a sensitivity: from which size on effects would have been found.

use aurt_diagnosis::Answer;
use aurt_files::output::pretty;
use aurt_report::rendering::number::significant;
use aurt_report::reports::parts;
use aurt_report::{BarGroup, Bars, Block, Cell, Figure, Page, Section, Style, Table, Tone, Verdict};
use aurt_simulation::inject::Presence;
use aurt_traits::RobotNames;
use serde_json::Value;

use crate::workbench::sensitivity::{Check, DRAWS, Limit, NAMED_IN, Row, Status, Subject};

#[derive(Debug)]
pub struct Answered<'a> {
    pub rows: &'a [Row],
    /// Whole diagnoses at twice and at half of some limits.
    pub checks: &'a [Check],
    pub subject: &'a Subject,
    pub said: Answer,
    pub seed: u64,
    pub document: &'a Value,
}

impl Answered<'_> {
    pub fn page(&self) -> Page {
        let mut provenance = parts::program("sensitivity");
        let real = self.subject.injection.real();
        provenance.push(parts::entry("Seed of the shapes", self.seed.to_string()));
        provenance.push(parts::entry("Draws of each effect", DRAWS.to_string()));
        provenance.push(parts::entry("f_dyn", format!("{} Hz", real.options.f_dyn_hz)));
        let left = self.subject.injection.model().left_rms();
        let left: Vec<String> = left.iter().map(|l| significant(*l, 3)).collect();
        provenance.push(parts::entry(
            "What the model leaves, joint by joint",
            format!("{} {}", left.join(", "), real.unit.symbol()),
        ));
        let sizes = Section::new(
            "Sizes",
            "A smaller effect may be present and undetected; a larger one would have been detected.",
            vec![Block::Table(self.sizes())],
        );
        let mut sections = vec![sizes, self.pictures()];
        if !self.checks.is_empty() {
            sections.push(Section::new(
                "Checked with whole diagnoses",
                "Trials take over from the recordings as they are what an effect changes little; whole diagnoses do \
                 not.",
                vec![Block::Table(self.checked())],
            ));
        }
        Page {
            title: "From which size on effects would have been found".into(),
            verdict: self.verdict(),
            sections,
            provenance,
            results_json: pretty(self.document),
        }
    }

    fn verdict(&self) -> Verdict {
        let asked = self.rows.iter().filter(|r| r.status != Status::NotPossible).count();
        let named = self.rows.iter().filter(|r| r.named_from.is_some()).count();
        let place = match self.subject.split.presence {
            Presence::Changed => "the targets and what is held out",
            Presence::All => "all recordings",
        };
        Verdict {
            tone: if named == asked { Tone::Good } else { Tone::Attention },
            headline: format!(
                "{named} of {asked} effects on their joints would have been named from some size on"
            ),
            sentences: self.sentences(place),
        }
    }

    fn sentences(&self, place: &str) -> Vec<String> {
        let mut sentences = vec![
            format!(
                "Each effect was added to {place}, on one joint at a time, in {DRAWS} draws of shape and noise; {NAMED_IN} of them \
                 have to name it."
            ),
            "A limit is known to a factor of 1.2 either way: strengths were tried in steps of √2.".into(),
        ];
        if self.said == Answer::Unexplained {
            sentences.push(
                "The recordings as they are leave an unexplained residual: an added effect is named only once it exceeds that residual."
                    .into(),
            );
        }
        sentences
    }

    fn sizes(&self) -> Table {
        let mut table = Table::new(
            "Named from: the diagnosis names the effect on the joint in four of five draws. Noticed from: it claims something new \
             there, or says that something has no name.",
            ["<effect", "joint", "<size", "named from", "noticed from", "<unit", "<remark"],
        );
        for row in self.rows {
            let size =
                |limit: Option<Limit>| limit.map_or_else(|| "–".to_owned(), |l| significant(l.size, 2));
            table.row([
                Cell::from(row.effect.as_str()),
                Cell::from(place(row.joint, self.subject.names())),
                Cell::from(row.quantity.as_str()),
                Cell { text: size(row.named_from), strong: row.named_from.is_some() },
                Cell::from(size(row.noticed_from)),
                Cell::from(row.unit.as_str()),
                Cell::from(remark(row.status)),
            ]);
        }
        table
    }

    /// One figure for each joint and one for the arm, in units of what the model leaves.
    fn pictures(&self) -> Section {
        let mut places: Vec<Option<usize>> = self.rows.iter().map(|r| r.joint).collect();
        places.sort_unstable();
        places.dedup();
        let names = self.subject.names();
        let figures = places
            .into_iter()
            .map(|joint| {
                let strength = |limit: Option<Limit>| limit.map(|l| l.strength);
                let label = joint.map_or_else(|| "whole arm".to_owned(), |j| names.joint(j));
                let stem = joint.map_or_else(|| "whole_arm".to_owned(), |j| format!("joint_{j}"));
                Figure::Bars(Bars {
                    name: format!("sensitivity_{stem}"),
                    title: label,
                    caption: String::new(),
                    unit: "×".into(),
                    series: vec![("noticed from".into(), Style::Before), ("named from".into(), Style::After)],
                    level_name: "what the model leaves".into(),
                    one_scale: true,
                    groups: self
                        .rows
                        .iter()
                        .filter(|r| r.joint == joint && r.status == Status::Named)
                        .map(|r| BarGroup {
                            label: r.effect.clone(),
                            values: vec![strength(r.noticed_from), strength(r.named_from)],
                            level: Some(1.0),
                        })
                        .collect(),
                })
            })
            .collect();
        Section::new(
            "The same beside what the model leaves",
            "Root mean square of an effect's torque over that of what the model leaves of the recordings as they \
                           are; shorter is better.",
            vec![Block::Figures(figures)],
        )
    }

    fn checked(&self) -> Table {
        let mut table = Table::new(
            "The shape of the first draw in the recordings' own noise, at twice and at half of the size from which on the trials \
             name it.",
            ["<effect", "joint", "named from", "<unit", "<twice", "<half"],
        );
        for check in self.checks {
            table.row([
                Cell::from(check.effect.as_str()),
                Cell::from(place(check.joint, self.subject.names())),
                Cell::from(significant(check.named_from, 2)),
                Cell::from(check.unit.as_str()),
                Cell::from(word(check.named_at_double)),
                Cell::from(word(check.named_at_half)),
            ]);
        }
        table
    }

    pub fn text(&self) -> String {
        let mut text = format!("{}\n\n{}", self.verdict().headline, self.sizes().to_text());
        if !self.checks.is_empty() {
            text += &format!("\nchecked with whole diagnoses\n{}", self.checked().to_text());
        }
        text
    }
}

fn place(joint: Option<usize>, names: RobotNames<'_>) -> String {
    joint.map_or_else(|| "arm".to_owned(), |j| names.joint_cell(j))
}

const fn word(named: bool) -> &'static str {
    if named { "named" } else { "not named" }
}

const fn remark(status: Status) -> &'static str {
    match status {
        Status::Named => "",
        Status::NotNamed => {
            "not named in four of five draws at 8 times what the model leaves, or at the most that the joint can have"
        }
        Status::AlreadyClaimed => "claimed of the recordings as they are",
        Status::Absorbed => "the experiment's own parameters absorb it, or no real machine has that much",
        Status::NotPossible => "these recordings cannot have it, or cannot show it at their rate",
    }
}
