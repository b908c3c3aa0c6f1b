//! Predictions that another simulator made for a recording, at its time stamps.

use std::path::Path;

use crate::failure::Failure;

/// Prefixes of the columns that hold a prediction, in order of preference.
const PREFIXES: [&str; 6] =
    ["predicted_torque_", "predicted_current_", "torque_", "current_", "tau_", "effort_"];

/// Reads a table with a header and one prediction column per joint; rows belong to those of the recording.
///
/// # Errors
/// [`Failure::Simulated`] if columns are missing, a value is no number, or the number of rows differs.
pub fn read(path: &Path, joints: usize, rows: usize) -> Result<Vec<Vec<f64>>, Failure> {
    let refuse = |reason: String, remedy: &str| Failure::Simulated {
        path: path.to_owned(),
        reason,
        remedy: remedy.to_owned(),
    };
    let text = std::fs::read_to_string(path)
        .map_err(|e| refuse(format!("cannot be read: {e}"), "check the path in `[recordings] simulated`"))?;
    let mut lines = text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty() && !l.starts_with('#'));
    let (_, header) = lines.next().ok_or_else(|| refuse("is empty".into(), "write one row per stamp"))?;
    let cells = |line: &str| -> Vec<String> {
        line.split([',', ';', '\t', ' ']).filter(|c| !c.is_empty()).map(|c| c.trim().to_owned()).collect()
    };
    let names = cells(header);
    let columns: Vec<usize> = PREFIXES
        .iter()
        .find_map(|prefix| {
            let place = |j: usize| names.iter().position(|n| *n == format!("{prefix}{j}"));
            (0..joints).map(place).collect::<Option<Vec<usize>>>()
        })
        .ok_or_else(|| {
            refuse(
                format!("has no prediction columns for {joints} joints"),
                "name them `predicted_torque_0` … or `predicted_current_0` …, joints counted from 0",
            )
        })?;
    let mut series = vec![Vec::with_capacity(rows); joints];
    for (line, text) in lines {
        let values = cells(text);
        for (joint, column) in columns.iter().enumerate() {
            let value = values.get(*column).and_then(|v| v.parse::<f64>().ok()).filter(|v| v.is_finite());
            let value = value.ok_or_else(|| {
                refuse(
                    format!("line {}, column `{}`: no finite number", line + 1, names[*column]),
                    "write a number for every stamp and joint",
                )
            })?;
            series[joint].push(value);
        }
    }
    let found = series.first().map_or(0, Vec::len);
    if found != rows {
        return Err(refuse(
            format!("has {found} rows, its recording {rows}"),
            "a simulator's prediction needs one row for each stamp of its recording",
        ));
    }
    Ok(series)
}
