use aurt_plugins::suggestion::likely;
use aurt_plugins::{Node, NodeKind};
use aurt_recording::{ColumnSelection, JoinedFile, Quantity, RecordedAs};

use super::columns::columns;
use super::recorded_as::{self, UNITS};
use super::section::Section;

const QUANTITIES: [(&str, Quantity); 3] = [
    ("measurement", Quantity::Measurement),
    ("position", Quantity::Position),
    ("velocity", Quantity::Velocity),
];

/// `take`: what is read of a file. The file with the positions has to give them.
pub(super) fn take(table: &mut Section<'_, '_>, has_positions: bool) -> Option<Vec<Quantity>> {
    let key = "take";
    let node = table.take(key)?;
    let NodeKind::Array(items) = &node.kind else {
        table.expected(key, node, "a list such as [\"position\", \"velocity\"]");
        return None;
    };
    let mut quantities = Vec::new();
    for item in items {
        let text = table.text_of(key, item)?;
        let Some((_, quantity)) = QUANTITIES.iter().find(|(name, _)| *name == text) else {
            let names = QUANTITIES.map(|(name, _)| name);
            let meant = likely(text, names.iter().copied());
            let help = meant.map(|name| format!("did you mean `{name}`?"));
            table.complain(key, item, "knows \"position\", \"velocity\" and \"measurement\"", help);
            return None;
        };
        quantities.push(*quantity);
    }
    if has_positions && !quantities.contains(&Quantity::Position) {
        let help = "name the file with the positions under `file`, the others under `joined`".to_owned();
        table.complain(key, node, "leaves out the positions, which `file` has to give", Some(help));
        return None;
    }
    Some(quantities)
}

/// `joined`: files with other quantities of the same motion, each a name or a table. What the table of the `recording` says
/// of quantities holds in them too, wherever a quantity lies.
pub(super) fn read(
    table: &mut Section<'_, '_>,
    recording: &RecordedAs,
    general: &RecordedAs,
) -> Vec<JoinedFile> {
    let Some(node) = table.take("joined") else { return Vec::new() };
    let general = &recording.of_quantities().or(general);
    let items = match &node.kind {
        NodeKind::Array(items) => items.as_slice(),
        _ => std::slice::from_ref(node),
    };
    items.iter().filter_map(|item| joined(table, item, general)).collect()
}

fn joined(section: &Section<'_, '_>, node: &Node, general: &RecordedAs) -> Option<JoinedFile> {
    match &node.kind {
        NodeKind::String(_) => Some(JoinedFile {
            file: section.recording_of("joined", node)?,
            unit: None,
            columns: ColumnSelection::default(),
            recorded: general.clone(),
            clock_offset_s: 0.0,
        }),
        NodeKind::Table(_) => {
            let mut table = Section::new(section.reader, node, "a file of `joined`")?;
            let file = table.require("file", "file = \"currents.csv\"");
            let file = file.and_then(|n| table.recording_of("file", n));
            let unit = table.choice("unit", &UNITS);
            let mut recorded = recorded_as::read(&mut table).or(general);
            recorded.take = take(&mut table, false);
            let offset = table.take("clock_offset_s");
            let offset_s = offset.and_then(|node| table.number_of("clock_offset_s", node));
            let below = table.take("columns").and_then(|n| Section::new(section.reader, n, "`columns`"));
            let columns = below.map(|below| columns(below, &[])).unwrap_or_default();
            table.finish();
            Some(JoinedFile {
                file: file?,
                unit,
                columns,
                recorded,
                clock_offset_s: offset_s.unwrap_or_default(),
            })
        }
        _ => {
            section.no_recording("joined", node);
            None
        }
    }
}
