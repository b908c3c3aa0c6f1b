use std::path::PathBuf;

use aurt::Role;
use aurt::data::Source;
use aurt_plugins::{Node, NodeKind};
use aurt_recording::ColumnSelection;

use super::columns::columns;
use super::joined;
use super::recorded_as::{self, UNITS};
use super::section::{Reader, Section};

/// `[recordings]`: files by what they are for. A recording is a file name, or a table with `file` and what has to be said about it.
#[derive(Debug, Clone, Default)]
pub struct Recordings {
    /// `calibration`: what the model is fitted to; at least one.
    pub calibration: Vec<Source>,
    /// `validation`: held out, for judging the model.
    pub validation: Vec<Source>,
    /// `target`: whose mismatch with the model is to be explained.
    pub target: Vec<Source>,
    pub simulated: Vec<Source>,
}

impl Recordings {
    /// The recordings of calibration, then those of validation, each with its role.
    pub fn fitted_and_held_out(&self) -> impl Iterator<Item = (&Source, Role)> {
        let calibration = self.calibration.iter().map(|source| (source, Role::Calibration));
        calibration.chain(self.validation.iter().map(|source| (source, Role::Validation)))
    }

    /// The recordings of calibration, target and validation in this order, each once.
    pub fn each_once(&self) -> Vec<&Source> {
        let mut known: Vec<&Source> = Vec::new();
        for source in self.calibration.iter().chain(&self.target).chain(&self.validation) {
            if place_among(&known, source).is_none() {
                known.push(source);
            }
        }
        known
    }

    pub(super) fn read(mut section: Section<'_, '_>) -> Self {
        let recorded = recorded_as::read(&mut section);
        let unit = section.choice("unit", &UNITS);
        let columns = columns_key(&mut section, recorded.rate_hz.is_none());
        // What holds for all recordings that do not say otherwise.
        let (file, label) = (PathBuf::new(), String::new());
        let general = Source { file, label, window_s: None, unit, columns, recorded };
        let node = section.require("calibration", "calibration = [\"recording.csv\"]");
        let calibration = node.map(|n| sources(&section, "calibration", n, &general)).unwrap_or_default();
        if let Some(node) = node
            && matches!(&node.kind, NodeKind::Array(list) if list.is_empty())
        {
            section.complain("calibration", node, "needs at least one recording", None);
        }
        let [validation, target, simulated] = ["validation", "target", "simulated"].map(|key| {
            section.take(key).map(|node| sources(&section, key, node, &general)).unwrap_or_default()
        });
        section.finish();
        Self { calibration, validation, target, simulated }
    }
}

/// The place among others of the same part of the same recording, read in the same way.
pub fn place_among(known: &[&Source], source: &Source) -> Option<usize> {
    let same = |other: &&Source| {
        other.file == source.file && other.window_s == source.window_s && other.recorded == source.recorded
    };
    known.iter().position(same)
}

fn columns_key(table: &mut Section<'_, '_>, has_clock: bool) -> Option<ColumnSelection> {
    let section = Section::new(table.reader, table.take("columns")?, "`columns`")?;
    let needed = [("position", "position = [1, 6]"), ("time", "time = 0")];
    Some(columns(section, if has_clock { &needed } else { &needed[..1] }))
}

fn sources(section: &Section<'_, '_>, key: &str, node: &Node, general: &Source) -> Vec<Source> {
    let items = match &node.kind {
        NodeKind::Array(items) => items.as_slice(),
        _ => std::slice::from_ref(node),
    };
    items.iter().filter_map(|item| source(section, key, item, general)).collect()
}

fn source(section: &Section<'_, '_>, key: &str, node: &Node, general: &Source) -> Option<Source> {
    match &node.kind {
        NodeKind::String(written) => {
            Some(Source { file: section.recording_of(key, node)?, label: written.clone(), ..general.clone() })
        }
        NodeKind::Table(_) => described(section.reader, key, node, general),
        _ => {
            section.no_recording(key, node);
            None
        }
    }
}

fn described(reader: &Reader, key: &str, node: &Node, general: &Source) -> Option<Source> {
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
    let columns = columns_key(&mut table, recorded.rate_hz.is_none()).or_else(|| general.columns.clone());
    table.finish();
    let label = file_node.and_then(Node::as_str)?.to_owned();
    Some(Source { file: file?, label, window_s, unit, columns, recorded })
}
