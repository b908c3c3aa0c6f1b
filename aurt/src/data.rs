//! From files to what calibration and prediction take: reading, units, preprocessing.

use std::io::Read;
use std::path::{Path, PathBuf};

use aurt_calibration::NamedRecording;
use aurt_diagnosis::without_unusable_rows;
use aurt_recording::{
    ColumnSelection, PreprocessOptions, ReadOptions, ReadReport, RecordedAs, Recording, RecordingError,
    RobotJoints, RobotRecording, preprocess, read_recording,
};
use aurt_traits::MeasurementUnit;
use serde::{Deserialize, Serialize};

use crate::error::Error;

pub use aurt_recording::PreprocessOptions as Preprocessing;

/// What measuring does to the quantity that the model is about; preprocessing undoes it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Instrument {
    /// Torque per current of each joint's drive.
    pub torque_constants_nm_per_a: Option<Vec<f64>>,
    /// Measured per true value.
    pub gains: Option<Vec<f64>>,
    /// Measured value where the true one is zero.
    pub offsets: Option<Vec<f64>>,
    /// How much later than the motion the measurement is recorded, s.
    pub delay_s: Option<Vec<f64>>,
}

impl Instrument {
    /// The unit of a measurement of unit `unit` once this is undone: torque constants turn currents into torques.
    pub const fn unit(&self, unit: MeasurementUnit) -> MeasurementUnit {
        if self.torque_constants_nm_per_a.is_some() { MeasurementUnit::NewtonMetre } else { unit }
    }

    fn factors(&self, unit: MeasurementUnit) -> Option<Vec<f64>> {
        let constants = self.torque_constants_nm_per_a.as_ref().filter(|_| unit == MeasurementUnit::Ampere);
        match (constants, &self.gains) {
            (None, None) => None,
            (Some(constants), None) => Some(constants.clone()),
            (None, Some(gains)) => Some(gains.iter().map(|g| 1.0 / g).collect()),
            (Some(constants), Some(gains)) => Some(constants.iter().zip(gains).map(|(k, g)| k / g).collect()),
        }
    }
}

/// A recording as it is asked for.
#[derive(Debug, Clone)]
pub struct Source {
    /// The file.
    pub file: PathBuf,
    /// What the user calls it.
    pub label: String,
    /// The part to be used, s from the first stamp.
    pub window_s: Option<[f64; 2]>,
    /// Unit of the measurement, where the file does not tell.
    pub unit: Option<MeasurementUnit>,
    /// Where to find what, where names do not tell.
    pub columns: Option<ColumnSelection>,
    /// What the file does not tell of itself.
    pub recorded: RecordedAs,
}

impl Source {
    /// Of a recording in memory, under the name that it has.
    pub fn of(recording: &Recording) -> Self {
        let (file, label) = (recording.file.clone(), recording.file.display().to_string());
        Self { file, label, window_s: None, unit: None, columns: None, recorded: RecordedAs::default() }
    }

    /// How it is read, for the joints of a robot or, without, for as many as it has positions.
    pub fn read_options(&self, joints: Option<&RobotJoints>, purpose: Purpose) -> ReadOptions {
        ReadOptions {
            columns: self.columns.clone().unwrap_or_default(),
            unit: self.unit,
            recorded: self.recorded.clone(),
            joints: joints.cloned(),
            needs_measurement: purpose != Purpose::Prediction,
            accepts_plan: purpose == Purpose::Prediction,
            ..ReadOptions::default()
        }
    }
}

/// What recordings are read and preprocessed for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Fitting: rest at the ends may be cut.
    Calibration,
    /// Comparing a prediction with the measurement.
    Validation,
    /// Predicting; measurements are not needed.
    Prediction,
}

/// How files become what models see.
#[derive(Debug, Clone)]
pub struct Pipeline<'a> {
    /// The joints of the robot.
    pub joints: RobotJoints,
    /// How recordings are preprocessed.
    pub preprocessing: &'a Preprocessing,
    /// What is undone in their measurements.
    pub instrument: &'a Instrument,
}

/// A recording as it was read.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// Where it is from.
    pub source: Source,
    /// The whole of it, with the joints of the robot in their order.
    pub recording: RobotRecording,
}

impl Loaded {
    /// Reads a recording of a robot's joints, or, without, of as many as it has positions.
    ///
    /// # Errors
    /// What is wrong with the file, and where; joints that are not the robot's.
    pub fn read(source: Source, joints: Option<&RobotJoints>, purpose: Purpose) -> Result<Self, Error> {
        let recording = read_recording(&source.file, &source.read_options(joints, purpose))?;
        let own = || RobotJoints { names: recording.joints.names().to_vec(), ..recording.joints().into() };
        let joints = joints.cloned().unwrap_or_else(own);
        Ok(Self { source, recording: recording.of_robot(&joints)? })
    }

    /// A recording in memory of a robot's joints, under the name that it has.
    ///
    /// # Errors
    /// Joints that are not the robot's.
    pub fn of(recording: &Recording, joints: &RobotJoints) -> Result<Self, Error> {
        Ok(Self { source: Source::of(recording), recording: recording.clone().of_robot(joints)? })
    }

    /// What to heed of it, under its label: motion beside the chain.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        self.recording.report.warnings().map(|warning| format!("{}: {warning}", self.source.label))
    }

    /// The time of every row of the file, in s. Rows that were dropped as corrupt have none that can be trusted;
    /// they take the middle between their neighbours.
    ///
    /// # Errors
    /// [`Error::Recording`] if the file can no longer be read.
    pub fn stamps_s(&self) -> Result<Vec<f64>, Error> {
        let (kept, report) = (&self.recording.time_s, &self.recording.report);
        if report.absent.is_empty() {
            return Ok(kept.clone());
        }
        if report.line_is_row {
            return Ok(with_dropped((1..=report.rows).collect::<Vec<_>>().as_slice(), kept, report));
        }
        let unreadable = |source| RecordingError::Unreadable {
            path: self.source.file.clone(),
            remedy: "it cannot be read again",
            source,
        };
        let mut bytes = Vec::new();
        aurt_files::open_regular(&self.source.file)
            .and_then(|mut file| file.read_to_end(&mut bytes))
            .map_err(unreadable)?;
        // Rows are the last lines that are neither blank nor comments; what else there is, is the header.
        let lines: Vec<usize> = bytes
            .split(|b| *b == b'\n')
            .enumerate()
            .filter(|(_, line)| line.trim_ascii_start().first().is_some_and(|b| *b != b'#'))
            .map(|(k, _)| k + 1)
            .collect();
        let rows = &lines[lines.len().saturating_sub(report.rows)..];
        Ok(with_dropped(rows, kept, report))
    }
}

/// A recording without rows that are interpolated between others, where what is left still is fast enough for its f_dyn.
fn without_interpolated_rows(recording: &Recording, options: &PreprocessOptions) -> Option<Recording> {
    let coarse = recording.every(recording.interpolation_stride()?);
    let rate_hz = (coarse.samples() - 1) as f64 / coarse.duration_s();
    (10.0 * options.f_dyn_hz < rate_hz).then_some(coarse)
}

/// The stamp of every row, given the lines of all rows and the stamps of those that were kept. A row that is there more than
/// once has that of the one before.
fn with_dropped(rows: &[usize], kept: &[f64], report: &ReadReport) -> Vec<f64> {
    let mut stamps = Vec::with_capacity(rows.len());
    let mut next = 0_usize;
    for line in rows {
        let is_absent = u32::try_from(*line).is_ok_and(|line| report.absent.binary_search(&line).is_ok());
        let repeats = report.repeated_rows > 0 && report.dropped.iter().all(|d| d.line != *line);
        if is_absent && repeats && next > 0 {
            stamps.push(kept[next - 1]);
        } else if is_absent {
            let (before, after) = (kept.get(next.wrapping_sub(1)), kept.get(next));
            let middle = before.zip(after).map(|(a, b)| 0.5 * (a + b));
            stamps.push(middle.or(before.copied()).or(after.copied()).unwrap_or(f64::NAN));
        } else {
            stamps.push(kept.get(next).copied().unwrap_or(f64::NAN));
            next += 1;
        }
    }
    stamps
}

impl Pipeline<'_> {
    /// Reads a recording.
    ///
    /// # Errors
    /// What is wrong with the file, and where.
    pub fn read(&self, source: Source, purpose: Purpose) -> Result<Loaded, Error> {
        Loaded::read(source, Some(&self.joints), purpose)
    }

    /// The unit of what a recording measured once the instrument is undone; none if it measured nothing.
    pub fn unit(&self, loaded: &Loaded) -> Option<MeasurementUnit> {
        loaded.recording.measurement.as_ref().map(|_| self.instrument.unit(loaded.recording.unit))
    }

    /// The one unit of all recordings.
    ///
    /// # Errors
    /// [`Error::MixedUnits`].
    pub fn common_unit<'l>(
        &self,
        recordings: impl IntoIterator<Item = &'l Loaded>,
    ) -> Result<Option<MeasurementUnit>, Error> {
        let mut first: Option<(MeasurementUnit, &Path)> = None;
        for loaded in recordings {
            let Some(unit) = self.unit(loaded) else { continue };
            match first {
                Some((known, file)) if known != unit => {
                    return Err(Error::MixedUnits {
                        first: file.to_owned(),
                        first_unit: known,
                        other: loaded.source.file.clone(),
                        other_unit: unit,
                    });
                }
                _ => first = first.or(Some((unit, &loaded.source.file))),
            }
        }
        Ok(first.map(|(unit, _)| unit))
    }

    /// How a recording whose measurement is in `unit` is preprocessed.
    pub fn options(&self, unit: MeasurementUnit, purpose: Purpose) -> PreprocessOptions {
        PreprocessOptions {
            trim_rest: self.preprocessing.trim_rest && purpose == Purpose::Calibration,
            whole_motion: purpose == Purpose::Prediction,
            gains: self.instrument.factors(unit),
            offsets: self.instrument.offsets.clone(),
            delay_s: self.instrument.delay_s.clone(),
            position_noise: purpose == Purpose::Calibration,
            ..self.preprocessing.clone()
        }
    }

    /// Preprocesses a recording without the rows whose values are not those of their stamp; for prediction all of it, else its
    /// window.
    ///
    /// # Errors
    /// What makes it unfit.
    pub fn preprocess(&self, loaded: &Loaded, purpose: Purpose) -> Result<NamedRecording, Error> {
        self.preprocessed(loaded, purpose, true)
    }

    /// The same with all rows as they are: a diagnosis looks for faults by itself.
    pub(crate) fn preprocess_as_read(
        &self,
        loaded: &Loaded,
        purpose: Purpose,
    ) -> Result<NamedRecording, Error> {
        self.preprocessed(loaded, purpose, false)
    }

    fn preprocessed(&self, loaded: &Loaded, purpose: Purpose, repair: bool) -> Result<NamedRecording, Error> {
        let options = self.options(loaded.recording.unit, purpose);
        let window = loaded.source.window_s.filter(|_| purpose != Purpose::Prediction);
        let part = window.map(|window| loaded.recording.window(window)).transpose()?;
        let whole: &Recording = part.as_ref().unwrap_or(&loaded.recording);
        let coarse = without_interpolated_rows(whole, &options).filter(|_| repair);
        let recording = coarse.as_ref().unwrap_or(whole);
        let repaired = repair.then(|| without_unusable_rows(recording)).flatten();
        let mut data = preprocess(repaired.as_ref().unwrap_or(recording), &options)?;
        if repair {
            data.report.unusable = Some(recording.samples() - data.report.samples);
            data.report.interpolated = coarse.as_ref().map(|coarse| whole.samples() - coarse.samples());
            data.report.samples = whole.samples();
        }
        Ok(NamedRecording { name: loaded.source.label.clone(), data })
    }
}
