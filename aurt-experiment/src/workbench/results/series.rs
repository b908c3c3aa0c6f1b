//! Motion, measurement, prediction and residual of a recording, sample by sample, for programs that plot them.

use std::path::Path;

use aurt::CalibratedModel;
use aurt::data::{Loaded, Purpose};
use aurt::fitting::{Assigned, Job};
use aurt::predictions::{PredictionNames, at_stamps};
use aurt_calibration::predict;
use aurt_recording::{JointTopic, mcap, parquet};
use aurt_traits::MeasurementUnit;

use crate::workbench::experiments::undone;
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

/// The contents of a file of series, which are `[joint][sample]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    pub label: String,
    pub unit: MeasurementUnit,
    /// Stamps, s from `origin_s`, whole s.
    pub time_s: Vec<f64>,
    pub origin_s: f64,
    pub joint_names: Vec<String>,
    pub position_rad: Vec<Vec<f64>>,
    pub quantities: Vec<(&'static str, Vec<Vec<f64>>)>,
    /// 1 where something holds, else 0.
    pub flags: Vec<(&'static str, Vec<Vec<f64>>)>,
}

impl Series {
    /// Measurement and prediction of a recording at its own stamps: the measurement in the unit of the model, unfiltered, gains
    /// and offsets undone, if there is one, the prediction, and the difference. Rows that were dropped as corrupt are not among them.
    pub fn of(calibrated: &CalibratedModel, loaded: &Loaded) -> Result<Self, Failure> {
        let CalibratedModel { model, calibration, .. } = calibrated;
        let pipeline = calibrated.pipeline();
        let prepared = pipeline.preprocess(loaded, Purpose::Prediction)?;
        let predictions = predict(model, calibration, &prepared)?;
        let recording = &loaded.recording;
        let options = pipeline.options(recording.unit, Purpose::Prediction);
        // A measurement of another quantity than the model's has no residual.
        let comparable = pipeline.unit(loaded) == Some(calibration.unit);
        let measurement = recording.measurement.as_ref().filter(|_| comparable);
        let measured = measurement.map(|measured| undone(measured, &options));
        let predicted = at_stamps(&recording.time_s, &predictions);
        let residual = measured.as_ref().map(|measured| difference(measured, &predicted));
        let named = [("measured", measured), ("predicted", Some(predicted)), ("residual", residual)];
        Ok(Self {
            label: loaded.source.label.clone(),
            unit: calibration.unit,
            time_s: recording.time_s.clone(),
            origin_s: recording.report.origin_s,
            joint_names: recording.joints.names().to_vec(),
            position_rad: recording.position_rad.clone(),
            quantities: named.into_iter().filter_map(|(name, series)| Some((name, series?))).collect(),
            flags: Vec::new(),
        })
    }

    /// The contents of a file; `facts` say where the model comes from, `path` is what errors name.
    pub fn to_file(
        &self,
        format: SeriesFormat,
        path: &Path,
        facts: &[(&str, String)],
    ) -> Result<Vec<u8>, Failure> {
        let mut all = vec![
            ("recording", self.label.clone()),
            ("unit", self.unit.symbol().to_owned()),
            ("aurt_version", env!("CARGO_PKG_VERSION").to_owned()),
        ];
        all.extend_from_slice(facts);
        match format {
            SeriesFormat::Parquet => {
                let stamps: Vec<f64> = self.time_s.iter().map(|t| self.origin_s + t).collect();
                let mut columns = vec![("timestamp".to_owned(), stamps.as_slice())];
                let quantity = self.unit.quantity();
                let quantities =
                    self.quantities.iter().map(|(name, series)| (format!("{name}_{quantity}"), series));
                let series = std::iter::once(("q".to_owned(), &self.position_rad))
                    .chain(quantities)
                    .chain(self.flags.iter().map(|(name, series)| ((*name).to_owned(), series)));
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
                let named: Vec<(String, &Vec<Vec<f64>>)> = (self.quantities.iter().chain(&self.flags))
                    .map(|(name, series)| (format!("/{name}"), series))
                    .collect();
                let topics: Vec<JointTopic<'_>> = named
                    .iter()
                    .map(|(name, effort)| JointTopic {
                        name,
                        position: &self.position_rad,
                        velocity: &[],
                        effort,
                    })
                    .collect();
                Ok(mcap(path, &self.time_s, self.origin_s, &joints, &topics, &all)?)
            }
        }
    }
}

/// One family of series minus another.
pub(super) fn difference(of: &[Vec<f64>], minus: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let pairs = of.iter().zip(minus);
    pairs.map(|(of, minus)| of.iter().zip(minus).map(|(a, b)| a - b).collect()).collect()
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
