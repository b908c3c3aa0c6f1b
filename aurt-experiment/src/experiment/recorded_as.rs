use aurt_plugins::{Node, NodeKind};
use aurt_recording::{AngleUnit, CurrentUnit, DroppedRows, RecordedAs, TimeUnit};
use aurt_traits::MeasurementUnit;

use super::section::Section;

pub(super) const UNITS: [(&str, MeasurementUnit); 2] =
    [("A", MeasurementUnit::Ampere), ("Nm", MeasurementUnit::NewtonMetre)];

const DROP: [(&str, DroppedRows); 1] = [("nan", DroppedRows::NotANumber)];
const CURRENT: [(&str, CurrentUnit); 2] = [("A", CurrentUnit::Ampere), ("mA", CurrentUnit::Milliampere)];

/// The keys that say how a file was recorded: in `[recordings]` for all files, in the table of a file for that one.
pub(super) fn read(section: &mut Section<'_, '_>) -> RecordedAs {
    let angle_node = section.take("angle");
    let angle = section.choice("angle", &AngleUnit::NAMES);
    let time = section.choice("time", &TimeUnit::NAMES);
    let current = section.choice("current", &CURRENT);
    let rate_hz = section.positive("rate_hz");
    let counts_per_revolution = per_joint(section, "counts_per_revolution");
    let gear_ratio = per_joint(section, "gear_ratio");
    if let Some(node) = angle_node.filter(|_| counts_per_revolution.is_some()) {
        section.complain(
            "angle",
            node,
            "and `counts_per_revolution` are two units of one thing; remove one",
            None,
        );
    }
    let topic = section.take("topic").and_then(|node| section.text_of("topic", node).map(str::to_owned));
    let drop = section.choice("drop", &DROP);
    let joint_names = section.take("joint_names").and_then(|node| joint_names(section, node));
    RecordedAs {
        angle,
        time,
        current,
        rate_hz,
        counts_per_revolution,
        gear_ratio,
        topic,
        joint_names,
        drop,
        take: None,
        joined: Vec::new(),
    }
}

fn per_joint(section: &mut Section<'_, '_>, key: &'static str) -> Option<Vec<f64>> {
    let node = section.take(key)?;
    if matches!(node.kind, NodeKind::Array(_)) {
        return section.factors(key);
    }
    let value = section.number_of(key, node)?;
    section.without_zero(key, vec![value])
}

/// `joint_names`: one for each joint, none of them empty or there twice.
pub(super) fn joint_names(section: &Section<'_, '_>, node: &Node) -> Option<Vec<String>> {
    let key = "joint_names";
    let names = names(section, key, "joints", node)?;
    section.one_per_joint(key, node, names.len());
    Some(names)
}

/// Names of joints or links, none of them empty or there twice.
pub(super) fn names(section: &Section<'_, '_>, key: &str, of: &str, node: &Node) -> Option<Vec<String>> {
    let NodeKind::Array(items) = &node.kind else {
        section.expected(key, node, "a list of names");
        return None;
    };
    let names: Vec<Option<&str>> = items.iter().map(|item| section.text_of(key, item)).collect();
    let names: Vec<String> = names.into_iter().map(|n| n.map(str::to_owned)).collect::<Option<_>>()?;
    let bad = (0..names.len()).find(|k| names[*k].trim().is_empty() || names[..*k].contains(&names[*k]));
    if let Some(bad) = bad {
        let message = format!("names two {of} \"{}\"", names[bad].escape_debug());
        let empty = "has an empty name";
        section.complain(key, node, if names[bad].trim().is_empty() { empty } else { &message }, None);
        return None;
    }
    Some(names)
}
