//! Filtered rows of a segment, joint by joint, with their residuals.

use aurt_recording::Segment;
use aurt_traits::{LoadTorque, RobotModel};

use super::stream::for_each_row_block;
use crate::{CalibrationError, CalibrationOptions, Rest};

/// A joint's rows over a segment; rows that were left out of the fit are zero, so that those around them keep their
/// distance in time.
pub(crate) struct JointRows {
    /// Column after column of the model's [`RobotModel::row_columns`].
    pub columns: Vec<Vec<f64>>,
    /// y − W ζ̂.
    pub residual: Vec<f64>,
    /// Rows that were fitted.
    pub counted: usize,
}

/// The rows of all joints over a segment; none without a measurement.
pub(super) fn rows_of(
    model: &RobotModel,
    segment: &Segment,
    acting: &[bool],
    load: &LoadTorque,
    coefficients: &[f64],
    options: &CalibrationOptions,
) -> Result<Vec<JointRows>, CalibrationError> {
    let Some(measurement) = &segment.measurement else { return Ok(Vec::new()) };
    let count = segment.rows();
    let mut joints: Vec<JointRows> = (0..model.joints())
        .map(|j| JointRows {
            columns: vec![Vec::with_capacity(count); model.row_columns(j).len()],
            residual: Vec::with_capacity(count),
            counted: 0,
        })
        .collect();
    for_each_row_block(model, segment, load, |block| {
        for (j, rows) in joints.iter_mut().enumerate() {
            let rest = options.rest_velocity(&**model.rigid_body(), j);
            let moves = |row| block.speed(segment, j, row) > rest;
            let kept: Vec<bool> =
                (0..block.rows).map(|row| options.rest == Rest::Keep || moves(row)).collect();
            let mut left = block.measurement(&measurement[j]).to_vec();
            for ((slot, column), into) in model.row_slots(j).zip(model.row_columns(j)).zip(&mut rows.columns)
            {
                let factor = if acting[*column] { 1.0 } else { 0.0 };
                for ((value, residual), kept) in block.column(slot).iter().zip(&mut left).zip(&kept) {
                    *residual -= factor * coefficients[*column] * value;
                    into.push(if *kept { factor * value } else { 0.0 });
                }
            }
            left.iter_mut().zip(&kept).filter(|(_, kept)| !**kept).for_each(|(v, _)| *v = 0.0);
            rows.counted += kept.iter().filter(|k| **k).count();
            rows.residual.extend(left);
        }
    })?;
    Ok(joints)
}
