use std::path::PathBuf;

use aurt_plugins::{Node, NodeKind};
use aurt_recording::RecordedAs;
use aurt_traits::MeasurementUnit;

use super::{
    columns::{RecordingColumns, columns},
    joined,
    recorded_as::{self, UNITS},
    section::{Reader, Section},
};

#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recordings {
    /// `calibration`: what the model is fitted to; at least one.
    pub calibration: Vec<RecordingSource>,
    /// `validation`: held out, for judging the model.
    pub validation: Vec<RecordingSource>,
    /// `target`: whose mismatch with the model is to be explained.
    pub target: Vec<RecordingSource>,
    pub simulated: Vec<RecordingSource>,
}

/// A recording: a file name, or a table with `file` and what has to be said about it.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingSource {
    pub file: PathBuf,
    pub written: String,
    /// `window_s`: the part to be used, in s since the recording's first stamp.
    pub window_s: Option<[f64; 2]>,
    /// `unit` of the measurement, where the file does not tell.
    pub unit: Option<MeasurementUnit>,
    /// `columns`: where to find what, for files without the usual column names.
    pub columns: Option<RecordingColumns>,
    /// What the file does not tell of itself: `angle`, `time`, `current`, `rate_hz`, `counts_per_revolution`,
    /// `gear_ratio`, `topic`, `joint_names`, `drop`, `take`, `joined`.
    pub recorded: RecordedAs,
}

impl RecordingSource {
    /// Whether two sources are the same part of the same recording, read in the same way.
    pub fn is_the_same_as(&self, other: &Self) -> bool {
        self.file == other.file && self.window_s == other.window_s && self.recorded == other.recorded
    }
}

impl Recordings {
    pub(super) fn read(mut section: Section<'_, '_>) -> Self {
        let recorded = recorded_as::read(&mut section);
        let has_clock = recorded.rate_hz.is_none();
        let unit = section.choice("unit", &UNITS);
        let columns = columns_key(&mut section, has_clock).unwrap_or_default();
        let general = General { unit, columns, recorded };
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

/// What holds for all recordings that do not say otherwise.
struct General {
    recorded: RecordedAs,
    unit: Option<MeasurementUnit>,
    columns: Option<RecordingColumns>,
}

/// The key `columns`, which may be missing; nothing if it is wrong.
fn columns_key(table: &mut Section<'_, '_>, has_clock: bool) -> Option<Option<RecordingColumns>> {
    match table.take("columns") {
        None => Some(None),
        Some(node) => columns(Section::new(table.reader, node, "`columns`")?, has_clock).map(Some),
    }
}

fn sources(section: &Section<'_, '_>, key: &str, node: &Node, general: &General) -> Vec<RecordingSource> {
    let items = match &node.kind {
        NodeKind::Array(items) => items.as_slice(),
        _ => std::slice::from_ref(node),
    };
    items.iter().filter_map(|item| source(section, key, item, general)).collect()
}

fn source(section: &Section<'_, '_>, key: &str, node: &Node, general: &General) -> Option<RecordingSource> {
    match &node.kind {
        NodeKind::String(written) => Some(RecordingSource {
            file: section.recording_of(key, node)?,
            written: written.clone(),
            window_s: None,
            unit: general.unit,
            columns: general.columns.clone(),
            recorded: general.recorded.clone(),
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

fn described(reader: &Reader, key: &str, node: &Node, general: &General) -> Option<RecordingSource> {
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
    let unit = table.choice("unit", &UNITS).or(general.unit);
    let mut recorded = recorded_as::read(&mut table).or(&general.recorded);
    recorded.take = joined::take(&mut table, true);
    recorded.joined = joined::read(&mut table, &recorded, &general.recorded);
    let columns = columns_key(&mut table, recorded.rate_hz.is_none());
    table.finish();
    let written = file_node.and_then(Node::as_str)?.to_owned();
    let columns = columns?.or_else(|| general.columns.clone());
    Some(RecordingSource { file: file?, written, window_s, unit, columns, recorded })
}
