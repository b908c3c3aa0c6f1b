//! Options of the commands that take recordings without an experiment file.

use std::path::Path;

use aurt::data::{Instrument, Preprocessing, Source};
use aurt::fitting::Job;
use aurt_calibration::{CalibrationOptions, Estimator, LoadTorqueChoice, Rest, TermScopes};
use aurt_experiment::experiment::numbered_columns;
use aurt_recording::{ColumnRef, ColumnSelection, ColumnsRef, RecordedAs};
use aurt_traits::{MeasurementUnit, RobotModel};
use clap::Args;
use serde::Deserialize;

use crate::values::{Choice, Constants, choice, parse_positive, parse_torque_constants, word};

/// How to read recordings.
#[derive(Debug, Args)]
#[command(next_help_heading = "Reading recordings")]
pub struct ReadingOptions {
    /// Unit of the measurement, where column names do not tell
    #[arg(long, value_parser = choice(UNITS))]
    unit: Option<MeasurementUnit>,
    /// Where to find what, where column names do not tell; columns count from 0, [first, last] per quantity
    #[arg(
        long,
        value_name = "TABLE",
        value_parser = parse_columns,
        long_help = "Where to find what, where column names do not tell: columns by number from 0, [first, last] \
            or one number per joint for a quantity of all joints, or by name\n\
            for example '{ time = 0, position = [1, 6], measurement = [13, 18] }'"
    )]
    columns: Option<ColumnSelection>,
    #[command(flatten)]
    joints: JointOptions,
}

/// Which joints of a recording are the robot's.
#[derive(Debug, Args)]
#[command(next_help_heading = "Reading recordings")]
pub struct JointOptions {
    /// Topic of a bag, where it has several of joint states
    #[arg(long)]
    topic: Option<String>,
    /// The recording's names for the robot's joints, base first, where they are not the robot's own
    #[arg(long, value_name = "NAME,NAME,…", value_delimiter = ',')]
    joint_names: Option<Vec<String>>,
}

impl JointOptions {
    pub fn recorded(&self) -> RecordedAs {
        RecordedAs {
            topic: self.topic.clone(),
            joint_names: self.joint_names.clone(),
            ..RecordedAs::default()
        }
    }
}

const UNITS: &[Choice<MeasurementUnit>] =
    &[("A", "Motor current", MeasurementUnit::Ampere), ("Nm", "Joint torque", MeasurementUnit::NewtonMetre)];

impl ReadingOptions {
    pub fn source(&self, file: &Path) -> Source {
        Source {
            file: file.to_owned(),
            label: file.display().to_string(),
            window_s: None,
            unit: self.unit,
            columns: self.columns.clone(),
            recorded: self.joints.recorded(),
        }
    }
}

/// How to preprocess and calibrate.
#[derive(Debug, Args)]
#[command(next_help_heading = "Preprocessing and calibration")]
pub struct FittingOptions {
    /// Highest frequency of the robot's dynamics that the fit uses; cut-offs and decimation follow from it
    #[arg(long, value_name = "HZ", default_value = "10", value_parser = parse_positive)]
    f_dyn_hz: f64,
    /// Rate of the uniform grid; by default that of the recording
    #[arg(long, value_name = "HZ", value_parser = parse_positive)]
    sample_rate_hz: Option<f64>,
    /// A joint at or below this speed rests
    #[arg(long, value_name = "RAD/S", default_value = "0.03", value_parser = parse_positive)]
    rest_velocity_rad_s: f64,
    /// Torque per current of each joint's drive in Nm/A; the model is then in Nm
    #[arg(long, value_name = "K K …", value_parser = parse_torque_constants, allow_hyphen_values = true)]
    torque_constants: Option<Constants>,
    /// Least-squares weights: 1/σ² of each joint, or all alike
    #[arg(long, value_parser = word(&Estimator::NAMES), default_value = "wls")]
    estimator: Estimator,
    /// Load torque of load-dependent friction: from a first fit, or the paper's sum of the regressor row
    #[arg(long, value_parser = word(&LoadTorqueChoice::NAMES), default_value = "fitted")]
    load_torque: LoadTorqueChoice,
    /// Samples at which a joint rests
    #[arg(long, value_parser = word(&Rest::NAMES), default_value = "keep")]
    rest: Rest,
}

impl FittingOptions {
    pub fn job(&self, model: RobotModel) -> Job {
        let torque_constants_nm_per_a = self.torque_constants.as_ref().map(|Constants(k)| k.clone());
        Job {
            model,
            preprocessing: Preprocessing {
                sample_rate_hz: self.sample_rate_hz,
                rest_velocity_rad_s: self.rest_velocity_rad_s,
                ..Preprocessing::new(self.f_dyn_hz)
            },
            instrument: Instrument { torque_constants_nm_per_a, ..Instrument::default() },
            options: CalibrationOptions {
                estimator: self.estimator,
                load_torque: self.load_torque,
                rest: self.rest,
                rest_velocity_rad_s: self.rest_velocity_rad_s,
                ..CalibrationOptions::default()
            },
            scopes: TermScopes::default(),
        }
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ColumnsTable {
    time: toml::Value,
    position: toml::Value,
    velocity: Option<toml::Value>,
    measurement: Option<toml::Value>,
}

fn parse_columns(text: &str) -> Result<ColumnSelection, String> {
    let trimmed = text.trim();
    let braced = if trimmed.starts_with('{') { trimmed.to_owned() } else { format!("{{ {trimmed} }}") };
    #[derive(Deserialize)]
    struct Document {
        columns: ColumnsTable,
    }
    let Document { columns } =
        toml::from_str(&format!("columns = {braced}")).map_err(|e| e.message().to_owned())?;
    Ok(ColumnSelection {
        time: Some(match &columns.time {
            toml::Value::String(name) => ColumnRef::Name(name.clone()),
            other => ColumnRef::Index(index("time", other)?),
        }),
        position: Some(joint_columns("position", &columns.position)?),
        velocity: columns.velocity.map(|v| joint_columns("velocity", &v)).transpose()?,
        measurement: columns.measurement.map(|v| joint_columns("measurement", &v)).transpose()?,
    })
}

fn joint_columns(key: &str, value: &toml::Value) -> Result<ColumnsRef, String> {
    let items = value.as_array().map_or(&[][..], Vec::as_slice);
    let name = |value: &toml::Value| value.as_str().map(|name| ColumnRef::Name(name.to_owned()));
    if let Some(names) = items.iter().map(name).collect::<Option<Vec<_>>>()
        && !names.is_empty()
    {
        return Ok(ColumnsRef::List(names));
    }
    numbered_columns(key, items.iter().map(|v| index(key, v)).collect::<Result<_, _>>()?)
}

fn index(key: &str, value: &toml::Value) -> Result<usize, String> {
    value
        .as_integer()
        .and_then(|i| usize::try_from(i).ok())
        .ok_or_else(|| format!("`{key}` expects columns by number, from 0, or by name"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_written_as_in_an_experiment() {
        let parsed = parse_columns("{ time = 0, position = [1, 6], measurement = [\"a\", \"b\"] }").unwrap();
        assert_eq!(parsed.time, Some(ColumnRef::Index(0)));
        assert_eq!(parsed.position, Some(ColumnsRef::Range { first: 1, last: 6 }));
        let names = ["a", "b"].map(|name| ColumnRef::Name(name.into()));
        assert_eq!(parsed.measurement, Some(ColumnsRef::List(names.into())));
        let permuted = parse_columns("{ time = 0, position = [4, 1, 2, 3] }").unwrap().position;
        assert_eq!(permuted, Some(ColumnsRef::List([4, 1, 2, 3].map(ColumnRef::Index).into())));
        assert_eq!(
            parse_columns("time = \"t\", position = [1, 6]").unwrap().time,
            Some(ColumnRef::Name("t".into()))
        );
    }

    #[test]
    fn wrong_columns_are_refused() {
        assert!(parse_columns("{ time = 0 }").unwrap_err().contains("position"));
        assert!(parse_columns("{ time = 0, position = [6, 1] }").unwrap_err().contains("comes after"));
        assert!(
            parse_columns("{ time = 0, position = [1, 6], torque = [1, 2] }").unwrap_err().contains("torque")
        );
        assert!(parse_columns("{ time = -1, position = [1, 6] }").unwrap_err().contains("from 0"));
    }
}
