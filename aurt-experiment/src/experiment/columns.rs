//! `columns`: which columns of a file hold what.

use aurt_recording::{ColumnRef, ColumnSelection, ColumnsRef};

use super::{errors::Complaint, joint_count::JointCheck, section::Section};
use aurt_plugins::{Node, NodeKind};

/// `columns`: a mapping of a file's columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordingColumns {
    /// `time`; not needed beside `rate_hz`.
    pub time: Option<ColumnName>,
    pub position: JointColumns,
    /// `velocity`, one per joint; optional.
    pub velocity: Option<JointColumns>,
    /// `measurement`, one per joint; optional, predictions do without.
    pub measurement: Option<JointColumns>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ColumnName {
    /// By its place, from 0.
    Index(usize),
    Name(String),
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub enum JointColumns {
    /// `[first, last]`: consecutive columns, both included, from 0.
    Range { first: usize, last: usize },
    /// Columns from 0, joint after joint.
    Numbers(Vec<usize>),
    /// Names in the header, joint after joint.
    Names(Vec<String>),
}

impl From<&RecordingColumns> for ColumnSelection {
    fn from(columns: &RecordingColumns) -> Self {
        Self {
            time: columns.time.as_ref().map(Into::into),
            position: Some((&columns.position).into()),
            velocity: columns.velocity.as_ref().map(Into::into),
            measurement: columns.measurement.as_ref().map(Into::into),
        }
    }
}

impl From<&ColumnName> for ColumnRef {
    fn from(column: &ColumnName) -> Self {
        match column {
            ColumnName::Index(index) => Self::Index(*index),
            ColumnName::Name(name) => Self::Name(name.clone()),
        }
    }
}

impl From<&JointColumns> for ColumnsRef {
    fn from(columns: &JointColumns) -> Self {
        match columns {
            JointColumns::Range { first, last } => Self::Range { first: *first, last: *last },
            JointColumns::Numbers(numbers) => {
                Self::List(numbers.iter().copied().map(ColumnRef::Index).collect())
            }
            JointColumns::Names(names) => Self::List(names.iter().cloned().map(ColumnRef::Name).collect()),
        }
    }
}

impl JointColumns {
    /// Columns by number: two are the first and the last, others one for each joint.
    pub fn numbered(key: &str, numbers: Vec<usize>) -> Result<Self, String> {
        match numbers[..] {
            [] => {
                Err(format!("`{key}` expects [first, last], or one column per joint, by number or by name"))
            }
            [first, last] if first > last => Err(format!(
                "`{key}`: the first column, {first}, comes after the last, {last}; for two joints the other way round name their \
                 columns"
            )),
            [first, last] => Ok(Self::Range { first, last }),
            _ => Ok(Self::Numbers(numbers)),
        }
    }

    pub const fn count(&self) -> usize {
        match self {
            Self::Range { first, last } => *last + 1 - *first,
            Self::Numbers(numbers) => numbers.len(),
            Self::Names(names) => names.len(),
        }
    }
}

pub(super) fn columns(mut table: Section<'_, '_>, has_clock: bool) -> Option<RecordingColumns> {
    let time = if has_clock { table.require("time", "time = 0") } else { table.take("time") };
    let time = time.map(|n| column(&table, "time", n));

    let position =
        table.require("position", "position = [1, 6]").and_then(|n| joint_columns(&table, "position", n));
    let velocity = table.take("velocity").and_then(|n| joint_columns(&table, "velocity", n));
    let measurement = table.take("measurement").and_then(|n| joint_columns(&table, "measurement", n));
    table.finish();
    let time = match time {
        Some(column) => Some(column?),
        None if has_clock => return None,
        None => None,
    };
    Some(RecordingColumns { time, position: position?, velocity, measurement })
}

pub(super) fn column(table: &Section<'_, '_>, key: &str, node: &Node) -> Option<ColumnName> {
    match node.as_str() {
        Some(name) => Some(ColumnName::Name(name.to_owned())),
        None => table.index_of(key, node, "columns").map(ColumnName::Index),
    }
}

pub(super) fn joint_columns(table: &Section<'_, '_>, key: &str, node: &Node) -> Option<JointColumns> {
    let NodeKind::Array(items) = &node.kind else {
        let message = format!("expects [first, last] or one column per joint, found {}", node.kind_name());
        table.complain(key, node, &message, None);
        return None;
    };
    let columns = if !items.is_empty() && items.iter().all(|i| i.as_str().is_some()) {
        JointColumns::Names(items.iter().filter_map(Node::as_str).map(str::to_owned).collect())
    } else {
        match JointColumns::numbered(key, table.indices_of(key, node, "columns")?) {
            Ok(columns) => columns,
            Err(message) => {
                table.reader.complain(Complaint::new(node.span.clone(), message));
                return None;
            }
        }
    };
    table.reader.check_joints(JointCheck::Length {
        key: key.to_owned(),
        found: columns.count(),
        span: node.span.clone(),
    });
    Some(columns)
}
