//! `columns`: which columns of a file hold what.

use aurt_recording::{ColumnRef, ColumnSelection, ColumnsRef};

use super::errors::Complaint;
use super::section::Section;
use aurt_plugins::{Node, NodeKind};

/// Columns by number: two are the first and the last, others one for each joint.
pub fn numbered_columns(key: &str, numbers: Vec<usize>) -> Result<ColumnsRef, String> {
    match numbers[..] {
        [] => Err(format!("`{key}` expects [first, last], or one column per joint, by number or by name")),
        [first, last] if first > last => Err(format!(
            "`{key}`: the first column, {first}, comes after the last, {last}; for two joints the other way round name their \
             columns"
        )),
        [first, last] => Ok(ColumnsRef::Range { first, last }),
        _ => Ok(ColumnsRef::List(numbers.into_iter().map(ColumnRef::Index).collect())),
    }
}

/// The columns that a table names; of those `needed` each stands with an example. What is wrong is reported.
pub(super) fn columns(mut table: Section<'_, '_>, needed: &[(&'static str, &str)]) -> ColumnSelection {
    let [time, position, velocity, measurement] =
        ["time", "position", "velocity", "measurement"].map(|key| {
            match needed.iter().find(|(name, _)| *name == key) {
                Some((_, example)) => table.require(key, example),
                None => table.take(key),
            }
        });
    let family = |key: &str, node: Option<&Node>| node.and_then(|node| joint_columns(&table, key, node));
    let selection = ColumnSelection {
        time: time.and_then(|node| match node.as_str() {
            Some(name) => Some(ColumnRef::Name(name.to_owned())),
            None => table.index_of("time", node, "columns").map(ColumnRef::Index),
        }),
        position: family("position", position),
        velocity: family("velocity", velocity),
        measurement: family("measurement", measurement),
    };
    table.finish();
    selection
}

fn joint_columns(table: &Section<'_, '_>, key: &str, node: &Node) -> Option<ColumnsRef> {
    let NodeKind::Array(items) = &node.kind else {
        table.expected(key, node, "[first, last] or one column per joint");
        return None;
    };
    let names: Option<Vec<&str>> = items.iter().map(Node::as_str).collect();
    let columns = match names.filter(|names| !names.is_empty()) {
        Some(names) => {
            Ok(ColumnsRef::List(names.into_iter().map(|n| ColumnRef::Name(n.to_owned())).collect()))
        }
        None => numbered_columns(key, table.indices_of(key, node, "columns")?),
    };
    let columns =
        columns.map_err(|message| table.reader.complain(Complaint::new(node.span.clone(), message))).ok()?;
    let found = match &columns {
        ColumnsRef::Range { first, last } => *last + 1 - *first,
        ColumnsRef::List(columns) => columns.len(),
        ColumnsRef::Prefix(_) => return Some(columns),
    };
    table.one_per_joint(key, node, found);
    Some(columns)
}
