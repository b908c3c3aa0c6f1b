//! What was found, effect by effect.

use aurt_diagnosis::{Evidence, Finding, RegisteredFinding, effects};
use aurt_traits::RobotNames;
use serde_json::Value;

use super::Diagnosed;
use crate::page::{Block, Section};
use crate::rendering::number::significant;
use crate::rendering::text::{capital, listed};
use crate::table::Table;
use crate::words::{all_indicated, claim, groups, nothing, objection};

impl Diagnosed<'_> {
    pub(super) fn findings(&self) -> Section {
        let several = self.verdict.effects.len() > 4;
        let mut blocks = Vec::new();
        for group in groups(self.verdict, self.asked) {
            if group.findings.is_empty() {
                blocks.push(Block::Text(format!("{}: {}.", capital(group.title), nothing(self.verdict))));
            } else if !group.title.is_empty() {
                blocks.push(Block::Text(format!("{}:", capital(group.title))));
            }
            blocks.extend(group.findings.iter().map(|(number, finding)| Block::Folded {
                title: format!("{number}. {}", claim(finding, self.asked)),
                open: !several || *number < 3,
                blocks: self.finding(finding),
            }));
        }
        blocks.extend(self.verdict.registered_models.iter().map(|model| Block::Folded {
            title: capital(&model.sentence),
            open: true,
            blocks: registered_blocks(model),
        }));
        if !self.verdict.indications.is_empty() {
            blocks.push(Block::Text(
                "Indications. These describe the recordings but fail a test, and are not claimed. The improved model has only those whose \
                 one failed test is that the calibration recordings do not show them:"
                    .into(),
            ));
            let lines = all_indicated(self.verdict, self.asked);
            blocks.push(Block::List(lines.iter().map(|line| format!("{}.", capital(line))).collect()));
        }
        Section::new(
            "What was found",
            "aurt explain NAME describes an effect: what it is, how it shows, and what it is easily confused with.",
            blocks,
        )
    }

    fn finding(&self, finding: &Finding) -> Vec<Block> {
        let names = self.verdict.names();
        let mut table = Table::new("", ["<parameter", "<of", "value", "± 1 σ"]);
        for (name, parameter) in &finding.parameters {
            match (&parameter.value, &parameter.std) {
                (Value::Array(values), stds) => {
                    for (k, value) in values.iter().enumerate() {
                        let of = component(finding, name, values.len(), k, names);
                        table.row([name.clone(), of, text(value), text(stds.get(k).unwrap_or(&Value::Null))]);
                    }
                }
                (value, std) => {
                    let link = value.as_f64().filter(|_| name == "link" && !names.links.is_empty());
                    let shown = link.map_or_else(|| text(value), |link| names.link(link as usize));
                    table.row([name.clone(), String::new(), shown, text(std)]);
                }
            }
        }
        let mut facts = vec![format!(
            "{} on {}, in {} recordings; {}",
            finding.effect,
            names.joint_list(&finding.joints),
            listed(&finding.present_in),
            evidence(&finding.evidence)
        )];
        if let Some([from, to]) = finding.window_s {
            let recording = finding.recording.as_deref().unwrap_or("the recording");
            facts.push(format!("from {from:.2} s to {to:.2} s of {recording}"));
        }
        facts.extend(objection(self.verdict, finding, self.unit.symbol()));
        for other in &finding.alternatives {
            facts.push(format!("or {}; to tell them apart: {}", other.effect, other.record));
        }
        let mut blocks = vec![Block::List(facts)];
        if !finding.parameters.is_empty() {
            blocks.push(Block::Table(table));
        }
        blocks
    }
}

/// A registered model: the vocabulary has no word for what it describes.
fn registered_blocks(model: &RegisteredFinding) -> Vec<Block> {
    let mut table = Table::new("", ["<parameter", "value", "± 1 σ"]);
    for (name, parameter) in &model.parameters {
        table.row([name.clone(), text(&parameter.value), text(&parameter.std)]);
    }
    let facts = vec![
        format!("{} model {} of {}", model.slot.name(), model.model, model.origin),
        format!("in {} recordings; {}", listed(&model.present_in), evidence(&model.evidence)),
    ];
    vec![Block::List(facts), Block::Table(table)]
}

fn evidence(evidence: &Evidence) -> String {
    let Evidence { score, threshold, p, .. } = *evidence;
    match p {
        Some(p) if p < 0.001 => format!("score {score:.0}, by chance with a probability below 0.001"),
        Some(p) => format!("score {score:.0}, by chance with a probability of {p:.3}"),
        None => format!("score {score:.0}, {threshold:.0} were needed"),
    }
}

/// What an entry of a list is of: a component of a vector or tensor, or a joint.
fn component(
    finding: &Finding,
    parameter: &str,
    length: usize,
    entry: usize,
    names: RobotNames<'_>,
) -> String {
    let known = effects::find(&finding.effect).and_then(|e| e.parameter(parameter));
    match known.map(|p| p.components).filter(|c| c.len() == length) {
        Some(components) => components[entry].into(),
        None if length == finding.joints.len() => names.joint(finding.joints[entry]),
        None => (entry + 1).to_string(),
    }
}

fn text(value: &Value) -> String {
    match value {
        Value::Null => "–".into(),
        Value::Number(number) => match number.as_f64() {
            // Links, orders and joints are numbers of things.
            Some(value) if value.fract() == 0.0 && value.abs() < 1e6 => value.to_string(),
            value => significant(value.unwrap_or(f64::NAN), 4),
        },
        Value::String(text) => text.clone(),
        Value::Array(values) => values.iter().map(text).collect::<Vec<_>>().join(", "),
        other => other.to_string(),
    }
}
