use std::path::{Path, PathBuf};

use aurt_traits::MeasurementUnit;

use crate::error::RecordingError;
use crate::long::spill::Spill;
use crate::read_options::ReadOptions;
use crate::reading::read_pieces;
use crate::recording::{ReadReport, Recording};

/// A recording of any length. Its samples lie in a temporary file, 8 bytes a number; in memory there are never more
/// than some ten thousand.
///
/// Rows that cannot be true are dropped as [`read_recording`](crate::read_recording) does; that neighbours contradict
/// a row, or that a measurement is absurd against others, is judged within pieces of 65 536 rows.
#[derive(Debug)]
pub struct LongRecording {
    pub(super) file: PathBuf,
    pub(super) joints: usize,
    pub(super) measured: bool,
    pub(super) unit: MeasurementUnit,
    pub(super) spill: Spill,
    first_s: Option<f64>,
    last_s: f64,
    pub(super) report: ReadReport,
}

impl LongRecording {
    /// An empty recording of a robot with that many joints; `file` is what messages call it.
    ///
    /// # Errors
    /// [`RecordingError::Spill`] if there can be no temporary file.
    pub fn new(
        file: PathBuf,
        joints: usize,
        measured: bool,
        unit: MeasurementUnit,
    ) -> Result<Self, RecordingError> {
        let width = 1 + joints * (1 + usize::from(measured));
        let spill =
            Spill::new(width).map_err(|source| RecordingError::Spill { path: file.clone(), source })?;
        let report = ReadReport::default();
        Ok(Self { file, joints, measured, unit, spill, first_s: None, last_s: f64::NEG_INFINITY, report })
    }

    /// Reads a text file as [`read_recording`](crate::read_recording) does, without holding it. Velocities are not
    /// read.
    ///
    /// # Errors
    /// As [`read_recording`](crate::read_recording), and [`RecordingError::Spill`].
    pub fn read(path: &Path, options: &ReadOptions) -> Result<Self, RecordingError> {
        let mut long: Option<Self> = None;
        let report = read_pieces(path, options, &mut |piece| {
            let ours = options.joints.as_ref().map(|robot| piece.clone().of_robot(robot)).transpose()?;
            let piece = ours.as_deref().unwrap_or(piece);
            let long = match &mut long {
                Some(long) => long,
                None => long.insert(Self::new(
                    path.to_owned(),
                    piece.joints(),
                    piece.measurement.is_some(),
                    piece.unit,
                )?),
            };
            long.push(piece)
        })?;
        let found = "no row follows the header".into();
        let long = long.ok_or(RecordingError::NoRows { path: path.to_owned(), found })?;
        Ok(Self { report, ..long })
    }

    /// Appends samples. Velocities are skipped.
    ///
    /// # Errors
    /// [`RecordingError::Count`] if they are of another robot, [`RecordingError::Sample`] and
    /// [`RecordingError::Clock`] as [`Recording::validate`], [`RecordingError::Spill`] if they cannot be written.
    pub fn push(&mut self, piece: &Recording) -> Result<(), RecordingError> {
        piece.validate()?;
        if piece.joints() != self.joints || piece.measurement.is_some() != self.measured {
            return Err(RecordingError::count(
                format!("{}: joints of a piece", self.file.display()),
                self.joints,
                piece.joints(),
            ));
        }
        let Some([first, last]) = piece.time_s.first().zip(piece.time_s.last()).map(|(a, b)| [*a, *b]) else {
            return Ok(());
        };
        if first < self.last_s {
            return Err(RecordingError::clock(
                &self.file,
                format!("time goes back from {} s to {first} s", self.last_s),
                "sort the samples by time",
            ));
        }
        self.first_s = self.first_s.or(Some(first));
        self.last_s = last;
        let families = piece.position_rad.iter().chain(piece.measurement.iter().flatten());
        let columns: Vec<&[f64]> =
            std::iter::once(&piece.time_s).chain(families).map(Vec::as_slice).collect();
        self.spill.append(&columns).map_err(|source| self.failed(source))
    }

    /// Number of joints.
    pub const fn joints(&self) -> usize {
        self.joints
    }

    /// Number of samples.
    pub const fn samples(&self) -> usize {
        self.spill.rows()
    }

    /// Unit of the measurement.
    pub const fn unit(&self) -> MeasurementUnit {
        self.unit
    }

    /// The first stamp, s; none of an empty recording.
    pub const fn first_stamp_s(&self) -> Option<f64> {
        self.first_s
    }

    /// What was found while the file was read; nothing of samples that were pushed.
    pub const fn report(&self) -> &ReadReport {
        &self.report
    }

    pub(super) fn failed(&self, source: std::io::Error) -> RecordingError {
        RecordingError::Spill { path: self.file.clone(), source }
    }
}
