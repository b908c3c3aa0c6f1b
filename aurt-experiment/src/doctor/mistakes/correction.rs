//! An experiment's text without the mistakes that were found; comments and order stay.

use crate::Experiment;
use crate::workbench::failure::Failure;
use aurt_rbd::MdhRows;
use aurt_recording::TimeUnit;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table as TomlTable, TableLike, Value};

use super::Examination;
use super::mistake::{Columns, Mistake, Reading, Table};
use super::setup::{Subject, median_period_s};
use super::wording::undone;

/// The corrected text, and what it cannot express and remains to be done by hand.
pub fn corrected(
    experiment: &Experiment,
    subject: &Subject,
    examination: &Examination,
) -> Result<(String, Vec<String>), Failure> {
    let refuse =
        |reason: String| Failure::argument("--fixed", reason, "make the changes that are told by hand");
    let mut document: DocumentMut =
        experiment.source_text.parse().map_err(|e: toml_edit::TomlError| refuse(e.message().to_owned()))?;
    let mut left = Vec::new();
    corrected_stamps(&mut document, experiment, subject);
    for step in &examination.found.steps {
        if !correct(&mut document, subject, &step.mistake) {
            left.push(undone(&step.mistake, examination.names()));
        }
    }
    Ok((document.to_string(), left))
}

/// Writes the units in which stamps were read, where the experiment says others.
fn corrected_stamps(document: &mut DocumentMut, experiment: &Experiment, subject: &Subject) {
    let stated = experiment.recordings.fitted_and_held_out().map(|(source, _)| source.recorded.time);
    let read = subject.recordings.iter().map(|r| r.loaded.source.recorded.time);
    let differs: Vec<(usize, TimeUnit)> =
        stated.zip(read).enumerate().filter_map(|(k, (a, b))| Some((k, b.filter(|_| a != b)?))).collect();
    let is_one = differs.windows(2).all(|w| w[0].1 == w[1].1) && differs.len() == subject.recordings.len();
    match differs.first() {
        Some((_, unit)) if is_one => {
            recorded(document, subject, None, "time", |_| unit.key().into());
        }
        _ => differs.iter().for_each(|(file, unit)| {
            recorded(document, subject, Some(*file), "time", |_| unit.key().into());
        }),
    }
}

/// Undoes one mistake if a key can.
fn correct(document: &mut DocumentMut, subject: &Subject, mistake: &Mistake) -> bool {
    let joints = subject.moving_joints();
    let mut put = |section: &str, key: &str, value: Value| -> bool {
        let table = document.entry(section).or_insert_with(|| Item::Table(TomlTable::new()));
        let Some(table) = table.as_table_like_mut() else { return false };
        set(table, key, value);
        true
    };
    match mistake {
        Mistake::Gravity { to_m_s2 } => put("robot", "gravity_m_s2", numbers(&to_m_s2.map(rounded))),
        Mistake::Geometry { what, .. } => match what {
            Table::Rows(MdhRows::Next) => put("robot", "mdh_rows", "next".into()),
            Table::Rows(MdhRows::Previous) => put("robot", "mdh_rows", "previous".into()),
            Table::Known(name) => put("robot", "name", (*name).into()),
            Table::Lengths(_) | Table::Reversed | Table::Exchanged | Table::Mirrored | Table::Zero { .. } => {
                false
            }
        },
        Mistake::Reading { what, file } => match what {
            Reading::MeasurementSign(_) | Reading::AllMeasurementSigns | Reading::Gain { .. }
                if file.is_none() =>
            {
                let mut gains = vec![1.0; joints];
                match what {
                    Reading::MeasurementSign(joint) => gains[*joint] = -1.0,
                    Reading::Gain { joint, factor } => gains[*joint] = *factor,
                    _ => gains.fill(-1.0),
                }
                combined(document, "instrument", "gains", &gains, 1.0, |old, new| old * new)
            }
            Reading::Constants { joints: [a, b], factor } => {
                let mut factors = vec![1.0; joints];
                (factors[*a], factors[*b]) = (*factor, 1.0 / factor);
                combined(document, "robot", "torque_constants_nm_per_a", &factors, 1.0, |old, new| old * new)
            }
            Reading::Delay(delay) if file.is_none() => combined(
                document,
                "instrument",
                "delay_s",
                &vec![rounded(*delay); joints],
                0.0,
                |old, new| old + new,
            ),
            Reading::AxisSign(joint) if file.is_none() => {
                [Reading::PositionSign(*joint), Reading::MeasurementSign(*joint)]
                    .into_iter()
                    .all(|what| correct(document, subject, &Mistake::Reading { what, file: None }))
            }
            Reading::MeasurementSign(_)
            | Reading::AxisSign(_)
            | Reading::AllMeasurementSigns
            | Reading::Gain { .. }
            | Reading::Delay(_)
            | Reading::During { .. } => false,
            Reading::Order { of, order } => reordered(document, subject, *of, order, *file),
            Reading::Degrees => recorded(document, subject, *file, "angle", |_| "deg".into()),
            Reading::Turns => recorded(document, subject, *file, "counts_per_revolution", |_| 1.into()),
            Reading::Geared(ratio) => recorded(document, subject, *file, "gear_ratio", |old| {
                numbers(&old.map(|o| o * rounded(*ratio)).collect::<Vec<_>>())
            }),
            Reading::PositionSign(joint) => recorded(document, subject, *file, "gear_ratio", |old| {
                let turned = old.enumerate().map(|(j, o)| if j == *joint { -o } else { o });
                numbers(&turned.collect::<Vec<_>>())
            }),
            Reading::Time(factor) => {
                let at = file.unwrap_or_default();
                let Some(recording) = subject.recordings.get(at) else { return false };
                let rate_hz = 1.0 / (factor * median_period_s(&recording.loaded.recording.time_s));
                recorded(document, subject, *file, "rate_hz", |_| rounded(rate_hz).into())
            }
        },
    }
}

/// A value in the place of another keeps what stands around that.
fn set(table: &mut dyn TableLike, key: &str, mut value: Value) {
    match table.get_mut(key).and_then(Item::as_value_mut) {
        Some(old) => {
            *value.decor_mut() = old.decor().clone();
            *old = value;
        }
        None => drop(table.insert(key, Item::Value(value))),
    }
}

fn numbers(values: &[f64]) -> Value {
    Value::Array(values.iter().copied().collect::<Array>())
}

fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

/// A list of one number a joint, combined with what was there.
fn combined(
    document: &mut DocumentMut,
    section: &str,
    key: &str,
    new: &[f64],
    otherwise: f64,
    how: impl Fn(f64, f64) -> f64,
) -> bool {
    let table = document.entry(section).or_insert_with(|| Item::Table(TomlTable::new()));
    let Some(table) = table.as_table_like_mut() else { return false };
    let old = list(table.get(key), new.len(), otherwise);
    let both: Vec<f64> = old.iter().zip(new).map(|(o, n)| how(*o, *n)).collect();
    set(table, key, numbers(&both));
    true
}

fn list(item: Option<&Item>, length: usize, otherwise: f64) -> Vec<f64> {
    let number = |v: &Value| v.as_float().or_else(|| v.as_integer().map(|i| i as f64));
    match item.and_then(Item::as_value) {
        Some(Value::Array(array)) => array.iter().map(|v| number(v).unwrap_or(otherwise)).collect(),
        Some(one) => vec![number(one).unwrap_or(otherwise); length],
        None => vec![otherwise; length],
    }
}

/// Sets a key that says how recordings were made, of all or of one; `value` is given the numbers that are there.
fn recorded(
    document: &mut DocumentMut,
    subject: &Subject,
    file: Option<usize>,
    key: &str,
    value: impl Fn(&mut dyn Iterator<Item = f64>) -> Value,
) -> bool {
    let joints = subject.moving_joints();
    let Some(recordings) = document.get_mut("recordings").and_then(Item::as_table_like_mut) else {
        return false;
    };
    let of = |item: Option<&Item>| value(&mut list(item, joints, 1.0).into_iter());
    match file {
        None => {
            let new = of(recordings.get(key));
            set(recordings, key, new);
            true
        }
        Some(file) => entry(recordings, file).is_some_and(|table| {
            let new = of(table.get(key).map(|v| Item::Value(v.clone())).as_ref());
            drop(table.insert(key, new));
            true
        }),
    }
}

/// The table of a recording, counted through calibration and validation; a bare name becomes one.
fn entry(recordings: &mut dyn TableLike, file: usize) -> Option<&mut InlineTable> {
    let count = |r: &dyn TableLike, key: &str| r.get(key).map_or(0, |i| i.as_array().map_or(1, Array::len));
    let calibration = count(recordings, "calibration");
    let (key, at) =
        if file < calibration { ("calibration", file) } else { ("validation", file - calibration) };
    let value = match recordings.get_mut(key)?.as_value_mut()? {
        Value::Array(array) => array.get_mut(at)?,
        one => one,
    };
    if let Some(name) = value.as_str() {
        let mut table = InlineTable::new();
        table.insert("file", name.into());
        let decor = value.decor().clone();
        *value = Value::InlineTable(table);
        *value.decor_mut() = decor;
    }
    value.as_inline_table_mut()
}

/// Lists columns by their names, joint after joint, where names are numbered.
fn reordered(
    document: &mut DocumentMut,
    subject: &Subject,
    of: Columns,
    order: &[usize],
    file: Option<usize>,
) -> bool {
    let Some(recordings) = document.get_mut("recordings").and_then(Item::as_table_like_mut) else {
        return false;
    };
    (0..subject.recordings.len()).filter(|k| file.is_none_or(|f| f == *k)).all(|k| {
        let columns = &subject.recordings[k].loaded.recording.report.columns;
        let named = |what: &[&str]| {
            columns.iter().find_map(|c| {
                let (quantity, span) = c.split_once(": ")?;
                what.contains(&quantity).then(|| numbered(span, order.len()))?
            })
        };
        let time = columns.iter().find_map(|c| c.strip_prefix("time: "));
        let (Some(time), Some(position), Some(measurement)) =
            (time, named(&["position"]), named(&["motor current", "joint torque", "current", "torque"]))
        else {
            return false;
        };
        let Some(table) = entry(recordings, k).filter(|t| !t.contains_key("columns")) else { return false };
        let listed = |names: &[String], changes: bool| -> Value {
            let name = |j: usize| names[if changes { order[j] } else { j }].as_str();
            Value::Array((0..order.len()).map(name).collect::<Array>())
        };
        let mut columns = InlineTable::new();
        columns.insert("time", time.into());
        columns.insert("position", listed(&position, of.positions()));
        columns.insert("measurement", listed(&measurement, of.measurements()));
        drop(table.insert("columns", Value::InlineTable(columns)));
        true
    })
}

/// `q_0 … q_5` as all names.
fn numbered(span: &str, count: usize) -> Option<Vec<String>> {
    let (first, _) = span.split_once(" … ")?;
    let start = first
        .rfind(|c: char| !c.is_ascii_digit())
        .map_or(0, |at| at + first[at..].chars().next().map_or(1, char::len_utf8));
    let (stem, number) = first.split_at(start);
    let from: usize = number.parse().ok()?;
    let names: Vec<String> = (from..from + count).map(|k| format!("{stem}{k}")).collect();
    span.ends_with(names.last()?.as_str()).then_some(names)
}
