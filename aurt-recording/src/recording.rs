use std::ops::Range;
use std::path::PathBuf;

use aurt_traits::MeasurementUnit;
use serde::Serialize;

use crate::branches::BranchMotion;
use crate::error::RecordingError;

/// What a robot's joints did and what was measured meanwhile, as it was recorded: stamps may jitter, repeat or
/// leave gaps, but they never go backwards.
///
/// Every series is `[joint][sample]`, all of one length.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Where it came from; error messages name it.
    pub file: PathBuf,
    /// Time stamps in s.
    pub time_s: Vec<f64>,
    /// Joint angles q in rad.
    pub position_rad: Vec<Vec<f64>>,
    /// Joint velocities q̇ in rad/s, if the file has them.
    pub velocity_rad_s: Option<Vec<Vec<f64>>>,
    /// Joint torques in Nm or motor currents in A, if the file has them.
    pub measurement: Option<Vec<Vec<f64>>>,
    /// Unit of the measurement.
    pub unit: MeasurementUnit,
    /// Which joints these are.
    pub joints: RecordedJoints,
    /// What was found and done while reading.
    pub report: ReadReport,
}

/// What a recording says of the joints that its series belong to.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum RecordedJoints {
    /// Nothing: they are in the order of the robot's.
    #[default]
    Unnamed,
    /// Their names, by which they are matched.
    Named(Vec<String>),
    /// The names that the user stated for the robot's joints, in the robot's order: matched by name where the robot has the
    /// same, else in this order.
    Stated(Vec<String>),
}

impl RecordedJoints {
    /// The names, series after series; empty where there are none.
    pub fn names(&self) -> &[String] {
        match self {
            Self::Unnamed => &[],
            Self::Named(names) | Self::Stated(names) => names,
        }
    }
}

/// What was found and done while a recording was read.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct ReadReport {
    /// How the file is written: delimiter, decimal sign, header.
    pub format: String,
    /// Rows of data in the file.
    pub rows: usize,
    /// Where each quantity was taken from, e.g. `position: actual_q_0 … actual_q_5`.
    pub columns: Vec<String>,
    /// Rows that were left out, with the reason; of very many the first ten thousand.
    pub dropped: Vec<DroppedRow>,
    /// Number of rows that were left out.
    pub dropped_rows: usize,
    /// Rows that were left out since they lack a number, as was asked for.
    #[serde(skip_serializing_if = "is_zero")]
    pub rows_without_numbers: usize,
    /// Rows that the file has more than once, stamp and numbers alike; each counts once.
    #[serde(skip_serializing_if = "is_zero")]
    pub repeated_rows: usize,
    /// Lines of all rows of the file that are not in the recording, in their order.
    #[serde(skip)]
    pub absent: Vec<u32>,
    /// Choices made, as sentences.
    pub remarks: Vec<String>,
    /// Irregularities found, as sentences.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub irregularities: Vec<String>,
    /// Joints beside the robot's chain that move, as far as the file names them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub branches: Vec<BranchMotion>,
    /// Whether [`DroppedRow::line`] counts rows: files that are no text have no lines.
    #[serde(skip)]
    pub line_is_row: bool,
    /// Stamps before and after each stretch that was left out on purpose, because the recording is long, s.
    #[serde(skip)]
    pub left_out_s: Vec<[f64; 2]>,
    /// First stamps since the clock was set back, where the recording is split.
    #[serde(skip)]
    pub set_back_s: Vec<f64>,
    /// Seconds that the reader took off all stamps, so that they keep their nanoseconds.
    #[serde(skip)]
    pub origin_s: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
const fn is_zero(rows: &usize) -> bool {
    *rows == 0
}

/// A row that was left out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct DroppedRow {
    /// Line in the file, from 1.
    pub line: usize,
    /// Why it was dropped.
    pub reason: String,
}

impl ReadReport {
    /// What a model of the chain cannot predict of the recording, as sentences.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        BranchMotion::sentences(&self.branches).into_iter()
    }

    /// The report in sentences.
    pub fn notes(&self) -> Vec<String> {
        const SHOWN: usize = 8;
        let mut notes = vec![format!("{} rows, {}", self.rows, self.format)];
        if !self.columns.is_empty() {
            notes.push(self.columns.join("; "));
        }
        if self.dropped_rows > 0 {
            let place = if self.line_is_row { "row" } else { "line" };
            let mut lines: Vec<String> = self
                .dropped
                .iter()
                .take(SHOWN)
                .map(|d| format!("{place} {} ({})", d.line, d.reason))
                .collect();
            if self.dropped_rows > lines.len() {
                lines.push(format!("{} more", self.dropped_rows - lines.len()));
            }
            let share = 100.0 * self.dropped_rows as f64 / self.rows.max(1) as f64;
            notes.push(format!(
                "dropped {} corrupt rows ({share:.2} %): {}",
                self.dropped_rows,
                lines.join(", ")
            ));
        }
        if self.rows_without_numbers > 0 {
            let share = 100.0 * self.rows_without_numbers as f64 / self.rows.max(1) as f64;
            notes.push(format!(
                "left out {} rows ({share:.2} %) with empty or NaN cells, as drop = \"nan\" says",
                self.rows_without_numbers
            ));
        }
        if self.repeated_rows > 0 {
            notes.push(format!("{} rows are written more than once; each counts once", self.repeated_rows));
        }
        notes.extend(self.remarks.iter().chain(&self.irregularities).cloned());
        notes.extend(self.warnings());
        notes
    }
}

impl Recording {
    /// A recording from arrays: stamps in s, angles in rad as `[joint][sample]`.
    ///
    /// # Errors
    /// As [`Self::validate`]; [`RecordingError::Count`] without joints.
    pub fn from_arrays(time_s: Vec<f64>, position_rad: Vec<Vec<f64>>) -> Result<Self, RecordingError> {
        if position_rad.is_empty() {
            return Err(RecordingError::Count { what: "joints".into(), expected: 1, found: 0 });
        }
        let rows = time_s.len();
        let report = ReadReport { format: "arrays".into(), rows, ..ReadReport::default() };
        let recording = Self {
            file: PathBuf::from("arrays"),
            time_s,
            position_rad,
            velocity_rad_s: None,
            measurement: None,
            unit: MeasurementUnit::default(),
            joints: RecordedJoints::Unnamed,
            report,
        };
        recording.validate()?;
        Ok(recording)
    }

    /// The same with measured velocities in rad/s, as `[joint][sample]`.
    ///
    /// # Errors
    /// As [`Self::validate`].
    pub fn with_velocity(self, velocity_rad_s: Vec<Vec<f64>>) -> Result<Self, RecordingError> {
        let recording = Self { velocity_rad_s: Some(velocity_rad_s), ..self };
        recording.validate()?;
        Ok(recording)
    }

    /// The same with measured joint torques in Nm or motor currents in A, as `[joint][sample]`.
    ///
    /// # Errors
    /// As [`Self::validate`].
    pub fn with_measurement(
        self,
        measurement: Vec<Vec<f64>>,
        unit: MeasurementUnit,
    ) -> Result<Self, RecordingError> {
        let recording = Self { measurement: Some(measurement), unit, ..self };
        recording.validate()?;
        Ok(recording)
    }

    /// The same under another name, for messages and reports.
    #[must_use]
    pub fn named(self, name: impl Into<PathBuf>) -> Self {
        Self { file: name.into(), ..self }
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.position_rad.len()
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.time_s.len()
    }

    pub(crate) fn bytes(&self) -> u64 {
        let columns = 1 + self.families().map(Vec::len).sum::<usize>();
        8 * (columns * self.samples()) as u64
    }

    /// Time from the first to the last stamp, in s.
    pub fn duration_s(&self) -> f64 {
        match (self.time_s.first(), self.time_s.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// The samples from `window_s[0]` to `window_s[1]` seconds after the first stamp, both ends included.
    /// Stamps stay as they are.
    ///
    /// # Errors
    /// [`RecordingError::Window`] if the window is not finite, ends before it starts, or holds no sample.
    pub fn window(&self, window_s: [f64; 2]) -> Result<Self, RecordingError> {
        let [from_s, to_s] = window_s;
        let refused = |reason| RecordingError::Window {
            path: self.file.clone(),
            from_s,
            to_s,
            reason,
            duration_s: self.duration_s(),
        };
        if !(from_s.is_finite() && to_s.is_finite()) {
            return Err(refused("is not finite"));
        }
        if from_s >= to_s {
            return Err(refused("ends before it starts"));
        }
        let origin = self.time_s.first().copied().unwrap_or(0.0);
        let first = self.time_s.partition_point(|t| t - origin < from_s);
        let end = self.time_s.partition_point(|t| t - origin <= to_s);
        if first >= end {
            return Err(refused("holds no samples"));
        }
        Ok(self.rows(first..end))
    }

    /// The samples of a range.
    pub fn rows(&self, range: Range<usize>) -> Self {
        self.with_series(|series| series[range.clone()].to_vec())
    }

    /// The same recording of other samples: `of` gives those of each series, stamps among them.
    pub(crate) fn with_series(&self, of: impl Fn(&[f64]) -> Vec<f64>) -> Self {
        let family = |family: &Vec<Vec<f64>>| family.iter().map(|series| of(series)).collect();
        Self {
            file: self.file.clone(),
            time_s: of(&self.time_s),
            position_rad: family(&self.position_rad),
            velocity_rad_s: self.velocity_rad_s.as_ref().map(family),
            measurement: self.measurement.as_ref().map(family),
            unit: self.unit,
            joints: self.joints.clone(),
            report: self.report.clone(),
        }
    }

    /// All series but the stamps: positions, velocities, measurements.
    pub(crate) fn families(&self) -> impl Iterator<Item = &Vec<Vec<f64>>> {
        let others = [self.velocity_rad_s.as_ref(), self.measurement.as_ref()];
        std::iter::once(&self.position_rad).chain(others.into_iter().flatten())
    }

    /// Appends the samples of a later recording of the same joints; series that one of both lacks stay as they are.
    pub fn extend(&mut self, later: Self) {
        let append = |ours: &mut Vec<Vec<f64>>, theirs: Vec<Vec<f64>>| {
            ours.iter_mut().zip(theirs).for_each(|(ours, theirs)| ours.extend(theirs));
        };
        self.time_s.extend(later.time_s);
        append(&mut self.position_rad, later.position_rad);
        for (ours, theirs) in
            [(&mut self.velocity_rad_s, later.velocity_rad_s), (&mut self.measurement, later.measurement)]
        {
            if let Some((ours, theirs)) = ours.as_mut().zip(theirs) {
                append(ours, theirs);
            }
        }
    }

    /// Checks that all series have one length, that stamps and values are finite and stamps do not go back.
    ///
    /// [`read_recording`](crate::read_recording) guarantees it; recordings made otherwise are checked before
    /// they are preprocessed.
    ///
    /// # Errors
    /// [`RecordingError::Count`], [`RecordingError::Sample`] or [`RecordingError::Clock`].
    pub fn validate(&self) -> Result<(), RecordingError> {
        let samples = self.samples();
        let count = |what: &str, expected, found| {
            if expected == found {
                return Ok(());
            }
            Err(RecordingError::Count { what: format!("{}: {what}", self.file.display()), expected, found })
        };
        let families = [
            ("positions", Some(&self.position_rad)),
            ("velocities", self.velocity_rad_s.as_ref()),
            ("measurements", self.measurement.as_ref()),
        ];
        for (what, family) in families {
            let Some(family) = family else { continue };
            count(&format!("joints with {what}"), self.joints(), family.len())?;
            for (joint, series) in family.iter().enumerate() {
                count(&format!("{what} of joint {joint}"), samples, series.len())?;
                if let Some(k) = series.iter().position(|v| !v.is_finite()) {
                    return Err(RecordingError::Sample {
                        path: self.file.clone(),
                        reason: format!("sample {k} of the {what} of joint {joint} is not finite"),
                    });
                }
            }
        }
        let bad = self
            .time_s
            .iter()
            .position(|t| !t.is_finite())
            .or_else(|| self.time_s.windows(2).position(|w| w[1] < w[0]).map(|k| k + 1));
        if let Some(k) = bad {
            return Err(RecordingError::clock(
                &self.file,
                format!("the time stamp of sample {k} is not finite or lies before the one before it"),
                "sort the samples by time, or cut the recording there",
            ));
        }
        Ok(())
    }
}
