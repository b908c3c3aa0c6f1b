//! Motion, measurement, prediction and residual of a recording, sample by sample, for programs that plot them.

use std::path::Path;

use aurt::{
    CalibratedModel,
    data::{Loaded, Purpose},
    fitting::{Assigned, Job},
    predictions::{PredictionNames, at_stamps},
};
use aurt_calibration::predict;
use aurt_recording::{JointTopic, mcap, parquet};
use aurt_traits::MeasurementUnit;

use crate::workbench::failure::Failure;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SeriesFormat {
    /// Apache Parquet, a column for each joint and quantity: pandas, Polars, DuckDB.
    Parquet,
    /// MCAP with joint states of ROS 2, a topic for each quantity: Foxglove, rerun, PlotJuggler.
    Mcap,
}

impl SeriesFormat {
    /// The one that the ending of a file asks for.
    pub fn of_ending(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?;
        [Self::Parquet, Self::Mcap].into_iter().find(|format| format.ending().eq_ignore_ascii_case(ending))
    }

    pub const fn ending(self) -> &'static str {
        match self {
            Self::Parquet => "parquet",
            Self::Mcap => "mcap",
        }
    }
}

/// What a model says of a recording, at the recording's own stamps. Series are `[joint][sample]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    pub label: String,
    /// Stamps, s from `origin_s`.
    pub time_s: Vec<f64>,
    pub origin_s: f64,
    /// Names of the joints; empty where they have none.
    pub joint_names: Vec<String>,
    pub position_rad: Vec<Vec<f64>>,
    /// The measurement in the unit of the model, unfiltered, gains and offsets undone, if there is one.
    pub measured: Option<Vec<Vec<f64>>>,
    pub predicted: Vec<Vec<f64>>,
    pub unit: MeasurementUnit,
}

impl Series {
    /// What a model says of a recording. Rows that were dropped as corrupt are not among them.
    pub fn of(calibrated: &CalibratedModel, loaded: &Loaded) -> Result<Self, Failure> {
        let CalibratedModel { model, calibration, .. } = calibrated;
        let pipeline = calibrated.pipeline();
        let prepared = pipeline.preprocess(loaded, Purpose::Prediction)?;
        let predictions = predict(model, calibration, &prepared)?;
        let recording = &loaded.recording;
        let options = pipeline.options(recording.unit, Purpose::Prediction);
        let per_joint = |values: &Option<Vec<f64>>, joint: usize, none: f64| {
            values.as_ref().and_then(|v| v.get(joint).copied()).unwrap_or(none)
        };
        let undone = |(joint, raw): (usize, &Vec<f64>)| -> Vec<f64> {
            let offset = per_joint(&options.offsets, joint, 0.0);
            let gain = per_joint(&options.gains, joint, 1.0);
            raw.iter().map(|value| (value - offset) * gain).collect()
        };
        // A measurement of another quantity than the model's has no residual.
        let comparable = pipeline.unit(loaded) == Some(calibration.unit);
        let measurement = recording.measurement.as_ref().filter(|_| comparable);
        Ok(Self {
            label: loaded.source.label.clone(),
            time_s: recording.time_s.clone(),
            origin_s: recording.report.origin_s,
            joint_names: recording.joints.names().to_vec(),
            position_rad: recording.position_rad.clone(),
            measured: measurement.map(|m| m.iter().enumerate().map(undone).collect()),
            predicted: at_stamps(&recording.time_s, &predictions),
            unit: calibration.unit,
        })
    }

    /// Measured minus predicted.
    pub fn residual(&self) -> Option<Vec<Vec<f64>>> {
        let difference = |(measured, predicted): (&Vec<f64>, &Vec<f64>)| -> Vec<f64> {
            measured.iter().zip(predicted).map(|(m, p)| m - p).collect()
        };
        self.measured.as_ref().map(|m| m.iter().zip(&self.predicted).map(difference).collect())
    }

    /// The contents of a file; `facts` say where the model comes from, `path` is what errors name.
    pub fn to_file(
        &self,
        format: SeriesFormat,
        path: &Path,
        facts: &[(&str, String)],
    ) -> Result<Vec<u8>, Failure> {
        let residual = self.residual();
        let named = [
            ("measured", self.measured.as_ref()),
            ("predicted", Some(&self.predicted)),
            ("residual", residual.as_ref()),
        ];
        let quantities = named.into_iter().filter_map(|(name, series)| Some((name, series?.as_slice())));
        Written {
            label: &self.label,
            unit: self.unit,
            time_s: &self.time_s,
            origin_s: self.origin_s,
            joint_names: &self.joint_names,
            position_rad: &self.position_rad,
            quantities: quantities.collect(),
            flags: Vec::new(),
        }
        .to_file(format, path, facts)
    }
}

/// What a file of series holds, quantities `[joint][sample]`.
#[derive(Debug, Clone)]
pub(crate) struct Written<'a> {
    pub label: &'a str,
    pub unit: MeasurementUnit,
    /// Stamps, s from `origin_s`, whole s.
    pub time_s: &'a [f64],
    pub origin_s: f64,
    /// Empty where the joints have none.
    pub joint_names: &'a [String],
    pub position_rad: &'a [Vec<f64>],
    pub quantities: Vec<(&'static str, &'a [Vec<f64>])>,
    /// 1 where something holds, else 0.
    pub flags: Vec<(&'static str, &'a [Vec<f64>])>,
}

impl Written<'_> {
    /// The contents of a file, as [`Series::to_file`].
    pub fn to_file(
        &self,
        format: SeriesFormat,
        path: &Path,
        facts: &[(&str, String)],
    ) -> Result<Vec<u8>, Failure> {
        let mut all = vec![
            ("recording", self.label.to_owned()),
            ("unit", self.unit.symbol().to_owned()),
            ("aurt_version", env!("CARGO_PKG_VERSION").to_owned()),
        ];
        all.extend_from_slice(facts);
        match format {
            SeriesFormat::Parquet => {
                let stamps: Vec<f64> = self.time_s.iter().map(|t| self.origin_s + t).collect();
                let mut columns = vec![("timestamp".to_owned(), stamps.as_slice())];
                let quantity = self.unit.quantity();
                let series = std::iter::once(("q".to_owned(), self.position_rad))
                    .chain(
                        self.quantities.iter().map(|(name, series)| (format!("{name}_{quantity}"), *series)),
                    )
                    .chain(self.flags.iter().map(|(name, series)| ((*name).to_owned(), *series)));
                for (name, series) in series {
                    let of_joints = series.iter().enumerate();
                    columns.extend(
                        of_joints.map(|(joint, values)| (format!("{name}_{joint}"), values.as_slice())),
                    );
                }
                Ok(parquet(path, &columns, &all)?)
            }
            SeriesFormat::Mcap => {
                let numbered = |j: usize| format!("joint_{j}");
                let name = |j: usize| self.joint_names.get(j).cloned().unwrap_or_else(|| numbered(j));
                let joints: Vec<String> = (0..self.position_rad.len()).map(name).collect();
                let named: Vec<(String, &[Vec<f64>])> = (self.quantities.iter().chain(&self.flags))
                    .map(|(name, series)| (format!("/{name}"), *series))
                    .collect();
                let topics: Vec<JointTopic<'_>> = named
                    .iter()
                    .map(|(name, effort)| JointTopic {
                        name,
                        position: self.position_rad,
                        velocity: &[],
                        effort,
                    })
                    .collect();
                Ok(mcap(path, self.time_s, self.origin_s, &joints, &topics, &all)?)
            }
        }
    }
}

/// The series of recordings, each as the name and the contents of a file. A file that occurs twice has one.
pub fn files(
    job: &Job,
    calibrated: &CalibratedModel,
    recordings: &[Assigned],
    format: SeriesFormat,
) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let mut names = PredictionNames::default();
    let mut files = Vec::new();
    for Assigned { loaded, .. } in recordings {
        let (predicted, is_new) = names.name(&loaded.source.file);
        if !is_new {
            continue;
        }
        let stem = predicted.trim_start_matches("predicted_").trim_end_matches(".csv");
        let name = format!("series_{stem}.{}", format.ending());
        let calibration = job.acting(&calibrated.calibration, &loaded.source.label);
        let here = CalibratedModel { calibration, ..calibrated.clone() };
        let contents = Series::of(&here, loaded)?.to_file(format, &loaded.source.file, &[])?;
        files.push((name, contents));
    }
    Ok(files)
}
