use aurt_recording::Segment;
use aurt_traits::{LoadTorque, RobotModel};
use rayon::prelude::*;

use super::joint_rows::{JointRows, rows_of};
use super::recordings::NamedRecording;
use super::scope::TermScopes;
use crate::{CalibrationError, CalibrationOptions};

/// Recordings that a model was fitted to, to be looked at again row by row.
#[derive(Clone, Copy)]
pub(crate) struct Observed<'a> {
    pub model: &'a RobotModel,
    pub recordings: &'a [&'a NamedRecording],
    pub scopes: &'a TermScopes,
    pub load: &'a LoadTorque,
    pub options: &'a CalibrationOptions,
}

/// A segment with how often it is listed.
pub(crate) struct Piece<'a> {
    pub segment: &'a Segment,
    /// Whether each coefficient acts in it.
    pub acting: Vec<bool>,
    pub times: f64,
}

impl<'a> Observed<'a> {
    /// The segments as they are listed, copies included.
    pub(crate) fn listed(&self) -> impl Iterator<Item = Piece<'a>> {
        self.recordings.iter().flat_map(|recording| self.pieces_of(recording, 1.0))
    }

    /// The segments, each once, with how often it is listed.
    pub(crate) fn pieces(&self) -> Vec<Piece<'a>> {
        let mut once: Vec<(&NamedRecording, f64)> = Vec::new();
        for recording in self.recordings {
            match once.iter_mut().find(|(known, _)| known.is_copy_of(recording)) {
                Some((_, times)) => *times += 1.0,
                None => once.push((recording, 1.0)),
            }
        }
        once.into_iter().flat_map(|(recording, times)| self.pieces_of(recording, times)).collect()
    }

    fn pieces_of(
        &self,
        recording: &'a NamedRecording,
        times: f64,
    ) -> impl Iterator<Item = Piece<'a>> + use<'a> {
        let acting = self.scopes.acting(self.model, &recording.name);
        recording.data.segments.iter().map(move |segment| Piece { segment, acting: acting.clone(), times })
    }

    /// The rows of all joints over each of the pieces, with the residual of `coefficients`.
    pub(crate) fn rows(
        &self,
        pieces: &[Piece<'_>],
        coefficients: &[f64],
    ) -> Result<Vec<Vec<JointRows>>, CalibrationError> {
        pieces.par_iter().map(|piece| self.rows_of(piece.segment, &piece.acting, coefficients)).collect()
    }

    /// The rows of all joints over a segment; none without a measurement.
    pub(crate) fn rows_of(
        &self,
        segment: &Segment,
        acting: &[bool],
        coefficients: &[f64],
    ) -> Result<Vec<JointRows>, CalibrationError> {
        rows_of(self.model, segment, acting, self.load, coefficients, self.options)
    }
}
