//! Predictions that another simulator made for a recording, at its time stamps.

use std::path::Path;

use aurt_files::clipped;

use crate::workbench::failure::Failure;
use crate::workbench::table_file::TableFile;

/// Prefixes of the columns that hold a prediction, in order of preference.
const PREFIXES: [&str; 6] =
    ["predicted_torque_", "predicted_current_", "torque_", "current_", "tau_", "effort_"];
/// Names of the column that holds the time stamps, in order of preference.
const TIME: [&str; 6] = ["timestamp", "time", "t", "timestamp_s", "time_s", "t_s"];
/// Part of a sampling interval by which a stamp may be off the recording's, for what was rounded in writing.
const STAMP_TOLERANCE: f64 = 0.5;

/// Reads a table with a header and one prediction column per joint; rows belong to those of the recording, whose time
/// stamps are `stamps_s`. Where the table has a time column, its stamps have to be those of the recording, either as
/// they are or counted from the first.
pub fn read(path: &Path, joints: usize, stamps_s: &[f64]) -> Result<Vec<Vec<f64>>, Failure> {
    let table = TableFile::read(
        path,
        "a simulator's prediction needs a header, the columns `predicted_torque_0` … or `predicted_current_0` …, \
         joints counted from 0, and one row for each stamp of its recording",
    )?;
    let of = |prefix: &&str| {
        (0..joints).map(|j| table.column(&format!("{prefix}{j}"))).collect::<Option<Vec<usize>>>()
    };
    let columns = PREFIXES.iter().find_map(of).ok_or_else(|| {
        table.refuse(Some(table.header_line), None, format!("has no prediction columns for {joints} joints"))
    })?;
    let time = TIME.iter().find_map(|name| table.column(name));
    let first_s = stamps_s.first().copied().unwrap_or(0.0);
    let last_s = stamps_s.last().copied().unwrap_or(0.0);
    let interval_s = (last_s - first_s) / stamps_s.len().saturating_sub(1).max(1) as f64;
    let mut begin_s: Option<f64> = None;
    let mut series = vec![Vec::with_capacity(stamps_s.len()); joints];
    for (row, stamp_s) in table.rows().zip(stamps_s.iter().map(Some).chain(std::iter::repeat(None))) {
        let row = row?;
        if let (Some(time), Some(stamp_s)) = (time, stamp_s) {
            let found_s = row.number(time)?;
            // Simulators often count from zero what recordings count from another time.
            let begin_s = *begin_s.get_or_insert(if found_s == 0.0 { first_s } else { 0.0 });
            let off_s = found_s + begin_s - stamp_s;
            if off_s.abs() > STAMP_TOLERANCE * interval_s {
                let reason = format!(
                    "the stamp in column `{}` is {found_s} s, that of the recording's row {stamp_s} s",
                    clipped(&table.names[time])
                );
                return Err(table.refuse(Some(row.line), Some(time), reason));
            }
        }
        for (values, column) in series.iter_mut().zip(&columns) {
            values.push(row.number(*column)?);
        }
    }
    let (found, rows) = (series.first().map_or(0, Vec::len), stamps_s.len());
    if found != rows {
        return Err(table.refuse(None, None, format!("has {found} rows, its recording {rows}")));
    }
    Ok(series)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str) -> Result<Vec<Vec<f64>>, Failure> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("simulated.csv");
        std::fs::write(&path, text).unwrap();
        read(&path, 1, &[10.0, 10.1, 10.2])
    }

    #[track_caller]
    fn refusal(text: &str) -> String {
        read_text(text).unwrap_err().to_string()
    }

    #[test]
    fn stamps_are_those_of_the_recording_or_counted_from_its_first() {
        let series = vec![vec![1.0, 2.0, 3.0]];
        for text in [
            "timestamp,torque_0\n10,1\n10.1,2\n10.2,3\n",
            "timestamp,torque_0\n0,1\n0.1,2\n0.2,3\n",
            "torque_0\n1\n2\n3\n",
            "time torque_0\n10  1\n10.1   2\n10.2 3\n",
        ] {
            assert_eq!(read_text(text).unwrap(), series, "{text}");
        }
        assert!(
            refusal("timestamp,torque_0\n12,1\n12.1,2\n12.2,3\n")
                .contains("the stamp in column `timestamp` is 12 s")
        );
        assert!(refusal("timestamp,torque_0\n10,1\nnan,2\n10.2,3\n").contains("simulated.csv:3"));
        assert!(refusal("timestamp,torque_0\n10,1\n10.1,2\n10.3,3\n").contains("10.3"));
    }

    #[test]
    fn cells_and_rows_are_as_many_as_they_have_to_be() {
        assert!(refusal("torque_0,x\n1,5,1\n2,5,1\n3,1,1\n").contains("3 cells, the header has 2"));
        assert!(refusal("torque_0\n1\n2\n").contains("2 rows, its recording 3"));
        assert!(refusal("torque_0\n1\n2\n3\n4\n").contains("4 rows, its recording 3"));
        assert!(refusal("torque_0,torque_0\n1,1\n").contains("two columns"));
        assert!(refusal("").contains("is empty"));
    }
}
