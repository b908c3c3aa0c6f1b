use aurt_traits::Jet;
use nalgebra::DMatrix;

use crate::drives::{
    DriveError, DriveRecording, DrivenArm, Options, Selection, columns::columns, output_error::Problem,
};

/// Derivatives of a rollout's positions by the selected numbers at their values, in units of [`Options::deviation_rad`] for
/// one deviation of what was known beforehand: a row for each number, a column for each joint of every `stride`-th sample.
///
/// # Errors
/// As [`output_error`](crate::drives::output_error).
pub fn slopes(
    arm: &DrivenArm,
    selection: &Selection,
    recording: &DriveRecording,
    options: &Options,
    stride: usize,
) -> Result<DMatrix<f64>, DriveError> {
    recording.check(arm.joints.len(), 0)?;
    let (columns, recordings) = (columns(arm, selection)?, std::slice::from_ref(recording));
    let theta: Vec<f64> = columns.iter().map(|c| c.start).collect();
    let passes = Problem::new(arm, &columns, recordings, options).passes(&theta, 0)?;
    let joints = arm.joints.len();
    let kept: Vec<usize> = (0..passes[0].len()).filter(|at| (at / joints).is_multiple_of(stride)).collect();
    let of = |row: usize, column: usize| passes[row / Jet::LANES][kept[column]].slope[row % Jet::LANES];
    Ok(DMatrix::from_fn(columns.len(), kept.len(), of))
}
