//! The state of recordings and robots between two processes: series as arrays, the rest as JSON.

use std::sync::Arc;

use aurt::traits::{MeasurementUnit, RigidBodyRegressor};
use aurt_rbd::robots::DescribedRobot;
use aurt_recording::{DroppedRow, ReadReport, RecordedJoints, Recording};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::{Value, json};

/// The exception of a state that is none.
pub fn broken(what: &str) -> impl Fn(serde_json::Error) -> PyErr {
    move |error| PyValueError::new_err(format!("this is no pickled {what}: {error}"))
}

/// All of a recording but its series.
pub fn recording_state(recording: &Recording) -> Value {
    let report = &recording.report;
    let dropped: Vec<_> = report.dropped.iter().map(|row| (row.line, &row.reason)).collect();
    let stated = matches!(recording.joints, RecordedJoints::Stated(_));
    json!({
        "file": recording.file,
        "unit": recording.unit,
        "joint_names": recording.joints.names(),
        "stated": stated,
        "format": report.format,
        "rows": report.rows,
        "columns": report.columns,
        "dropped": dropped,
        "dropped_rows": report.dropped_rows,
        "rows_without_numbers": report.rows_without_numbers,
        "repeated_rows": report.repeated_rows,
        "absent": report.absent,
        "remarks": report.remarks,
        "irregularities": report.irregularities,
        "branches": report.branches,
        "line_is_row": report.line_is_row,
        "left_out_s": report.left_out_s,
        "set_back_s": report.set_back_s,
        "origin_s": report.origin_s,
    })
}

/// The recording of series, with the rest of its state.
///
/// # Errors
/// A state that is none.
pub fn recording(
    time_s: Vec<f64>,
    [position_rad, velocity_rad_s, measurement]: [Option<Vec<Vec<f64>>>; 3],
    mut state: Value,
) -> Result<Recording, serde_json::Error> {
    let names: Vec<String> = part(&mut state, "joint_names")?;
    let unit: MeasurementUnit = part(&mut state, "unit")?;
    let joints = match (names.is_empty(), part(&mut state, "stated")?) {
        (true, _) => RecordedJoints::Unnamed,
        (false, true) => RecordedJoints::Stated(names),
        (false, false) => RecordedJoints::Named(names),
    };
    let dropped: Vec<(usize, String)> = part(&mut state, "dropped")?;
    Ok(Recording {
        file: part(&mut state, "file")?,
        time_s,
        position_rad: position_rad.unwrap_or_default(),
        velocity_rad_s,
        measurement,
        unit,
        joints,
        report: ReadReport {
            format: part(&mut state, "format")?,
            rows: part(&mut state, "rows")?,
            columns: part(&mut state, "columns")?,
            dropped: dropped.into_iter().map(|(line, reason)| DroppedRow { line, reason }).collect(),
            dropped_rows: part(&mut state, "dropped_rows")?,
            rows_without_numbers: part(&mut state, "rows_without_numbers")?,
            repeated_rows: part(&mut state, "repeated_rows")?,
            absent: part(&mut state, "absent")?,
            remarks: part(&mut state, "remarks")?,
            irregularities: part(&mut state, "irregularities")?,
            branches: part(&mut state, "branches")?,
            line_is_row: part(&mut state, "line_is_row")?,
            left_out_s: part(&mut state, "left_out_s")?,
            set_back_s: part(&mut state, "set_back_s")?,
            origin_s: part(&mut state, "origin_s")?,
        },
    })
}

fn part<T: serde::de::DeserializeOwned>(state: &mut Value, key: &str) -> Result<T, serde_json::Error> {
    serde_json::from_value(state[key].take())
}

/// A robot without what follows from the rest.
pub fn robot_state(robot: &aurt::Robot) -> Value {
    json!({
        "described": robot.described(),
        "rigid_body": robot.rigid_body(),
        "notes": robot.notes(),
    })
}

/// The robot of a state.
///
/// # Errors
/// A state that is none.
pub fn robot(mut state: Value) -> PyResult<aurt::Robot> {
    let wrong = broken("robot");
    let described: Option<DescribedRobot> = part(&mut state, "described").map_err(&wrong)?;
    let body: Box<dyn RigidBodyRegressor> = part(&mut state, "rigid_body").map_err(&wrong)?;
    let notes: Vec<String> = part(&mut state, "notes").map_err(&wrong)?;
    let robot = match described {
        Some(described) => aurt::Robot::of_description(described, body.gravity_m_s2()),
        None => aurt::Robot::of_bodies(Arc::from(body)),
    };
    Ok(robot.map_err(crate::error::raised)?.with_notes(notes))
}
