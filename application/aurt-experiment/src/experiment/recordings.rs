use std::path::PathBuf;

use aurt_plugins::{Node, NodeKind};
use aurt_recording::{ColumnRef, ColumnSelection, ColumnsRef, RecordedAs};
use aurt_traits::MeasurementUnit;

use super::{
    errors::Complaint,
    geometry::Geometry,
    joined,
    joint_count::JointCheck,
    recorded_as,
    robot::Robot,
    section::{Reader, Section},
};

/// Units of measurements.
pub(super) const UNITS: [(&str, MeasurementUnit); 2] =
    [("A", MeasurementUnit::Ampere), ("Nm", MeasurementUnit::NewtonMetre)];

/// `[recordings]`: what was recorded, by what it is for.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recordings {
    /// `calibration`: what the model is fitted to; at least one.
    pub calibration: Vec<RecordingSource>,
    /// `validation`: held out, for judging the model.
    pub validation: Vec<RecordingSource>,
    /// `target`: whose mismatch with the model is to be explained.
    pub target: Vec<RecordingSource>,
    /// `simulated`: made by a simulation.
    pub simulated: Vec<RecordingSource>,
}

/// A recording: a file name, or a table with `file` and what has to be said about it.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingSource {
    /// `file`.
    pub file: PathBuf,
    /// The file as the experiment writes it, for reports.
    pub written: String,
    /// `window_s`: the part to be used, in s since the recording's first stamp.
    pub window_s: Option<[f64; 2]>,
    /// `unit` of the measurement, where the file does not tell.
    pub unit: Option<MeasurementUnit>,
    /// `columns`: where to find what, for files without the usual column names.
    pub columns: Option<RecordingColumns>,
    /// What the file does not tell of itself: `angle`, `time`, `current`, `rate_hz`, `counts_per_revolution`,
    /// `gear_ratio`, `topic`, `joint_names`, `take`, `joined`.
    pub recorded: RecordedAs,
}

impl RecordingSource {
    /// Whether two sources are the same part of the same recording, read in the same way.
    #[must_use]
    pub fn is_the_same_as(&self, other: &Self) -> bool {
        self.file == other.file && self.window_s == other.window_s && self.recorded == other.recorded
    }
}

/// `columns`: a mapping of a file's columns.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecordingColumns {
    /// `time`; not needed beside `rate_hz`.
    pub time: Option<ColumnName>,
    /// `position`, one per joint.
    pub position: JointColumns,
    /// `velocity`, one per joint; optional.
    pub velocity: Option<JointColumns>,
    /// `measurement`, one per joint; optional, predictions do without.
    pub measurement: Option<JointColumns>,
}

/// A column of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ColumnName {
    /// By its place, from 0.
    Index(usize),
    /// By its name in the header.
    Name(String),
}

/// The columns of a quantity that each joint has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum JointColumns {
    /// `[first, last]`: consecutive columns, both included, from 0.
    Range {
        /// Column of joint 0.
        first: usize,
        /// Column of the last joint.
        last: usize,
    },
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
            JointColumns::Names(names) => Self::List(names.iter().cloned().map(ColumnRef::Name).collect()),
        }
    }
}

impl JointColumns {
    /// Number of columns.
    #[must_use]
    pub const fn count(&self) -> usize {
        match self {
            Self::Range { first, last } => *last + 1 - *first,
            Self::Names(names) => names.len(),
        }
    }
}

impl Recordings {
    pub(super) fn read(mut section: Section<'_, '_>) -> Self {
        let general = recorded_as::read(&mut section);
        let node = section.require("calibration", "calibration = [\"recording.csv\"]");
        let calibration = node.map(|n| sources(&section, "calibration", n, &general)).unwrap_or_default();
        if let Some(node) = node
            && matches!(&node.kind, NodeKind::Array(list) if list.is_empty())
        {
            section.complain("calibration", node, "needs at least one recording", None);
        }
        let mut optional =
            |key| section.take(key).map(|node| sources(&section, key, node, &general)).unwrap_or_default();
        let (validation, target, simulated) =
            (optional("validation"), optional("target"), optional("simulated"));
        section.finish();
        Self { calibration, validation, target, simulated }
    }
}

impl Recordings {
    /// Lets formats that name joints find those of a robot that names them, unless the experiment does.
    pub(super) fn name_joints(&mut self, robot: &Robot) {
        // Robots known by name have numbers for joints.
        let Geometry::Urdf { robot, .. } = &robot.geometry else { return };
        let all = [&mut self.calibration, &mut self.validation, &mut self.target, &mut self.simulated];
        for source in all.into_iter().flatten() {
            source.recorded.joint_names.get_or_insert_with(|| robot.joint_names.clone());
            for other in &mut source.recorded.joined {
                other.recorded.joint_names.get_or_insert_with(|| robot.joint_names.clone());
            }
        }
    }
}

/// One recording or a list of them.
fn sources(section: &Section<'_, '_>, key: &str, node: &Node, general: &RecordedAs) -> Vec<RecordingSource> {
    let items = match &node.kind {
        NodeKind::Array(items) => items.as_slice(),
        _ => std::slice::from_ref(node),
    };
    items.iter().filter_map(|item| source(section, key, item, general)).collect()
}

fn source(
    section: &Section<'_, '_>,
    key: &str,
    node: &Node,
    general: &RecordedAs,
) -> Option<RecordingSource> {
    match &node.kind {
        NodeKind::String(written) => Some(RecordingSource {
            file: section.recording_of(key, node)?,
            written: written.clone(),
            window_s: None,
            unit: None,
            columns: None,
            recorded: general.clone(),
        }),
        NodeKind::Table(_) => described(section.reader, key, node, general),
        _ => {
            let message = format!(
                "expects file names or tables such as {{ file = \"…\" }}, found {}",
                node.kind_name()
            );
            section.complain(key, node, &message, None);
            None
        }
    }
}

fn described(reader: &Reader, key: &str, node: &Node, general: &RecordedAs) -> Option<RecordingSource> {
    let mut table = Section::new(reader, node, format!("a recording of `{key}`"))?;
    let file_node = table.require("file", "file = \"recording.csv\"");
    let file = file_node.and_then(|n| table.recording_of("file", n));
    let window_s = table.take("window_s").and_then(|n| {
        let window: [f64; 2] = table.numbers_exactly("window_s", n, "begin and end in s")?;
        if window[0] >= window[1] {
            table.complain("window_s", n, "must begin before it ends", None);
            return None;
        }
        Some(window)
    });
    let unit = table.choice("unit", &UNITS);
    let mut recorded = recorded_as::read(&mut table).or(general);
    recorded.take = joined::take(&mut table, true);
    recorded.joined = joined::read(&mut table, general);
    let columns_node = table.take("columns");
    let has_clock = recorded.rate_hz.is_none();
    let columns = columns_node
        .and_then(|n| Section::new(reader, n, "`columns`"))
        .and_then(|section| columns(section, has_clock));
    table.finish();
    let written = file_node.and_then(Node::as_str)?.to_owned();
    if columns_node.is_some() && columns.is_none() {
        return None;
    }
    Some(RecordingSource { file: file?, written, window_s, unit, columns, recorded })
}

fn columns(mut table: Section<'_, '_>, has_clock: bool) -> Option<RecordingColumns> {
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
        let message = format!("expects [first, last] or one name per joint, found {}", node.kind_name());
        table.complain(key, node, &message, None);
        return None;
    };
    let columns = if !items.is_empty() && items.iter().all(|i| i.as_str().is_some()) {
        JointColumns::Names(items.iter().filter_map(Node::as_str).map(str::to_owned).collect())
    } else {
        let indices = table.indices_of(key, node, "columns")?;
        let [first, last] = indices[..] else {
            let message = format!(
                "expects the first and the last column, [first, last], found {} numbers",
                indices.len()
            );
            table.complain(key, node, &message, Some("or one name per joint".to_owned()));
            return None;
        };
        if first > last {
            table.reader.complain(Complaint::new(
                node.span.clone(),
                format!("`{key}`: the first column, {first}, comes after the last, {last}"),
            ));
            return None;
        }
        JointColumns::Range { first, last }
    };
    table.reader.check_joints(JointCheck::Length {
        key: key.to_owned(),
        found: columns.count(),
        span: node.span.clone(),
    });
    Some(columns)
}
