//! A segment's regressor, tile by tile: evaluated, filtered in parallel with the measurement, decimated.

use aurt_recording::{DecimatedTile, Segment};
use aurt_traits::{LoadTorque, RobotModel, RobotState, RobotTile};

use crate::CalibrationError;

/// Samples evaluated at once: the slots of a six-joint model then take about 1 MB.
pub(crate) const TILE_SAMPLES: usize = 512;

/// Filtered and decimated rows, column by column.
#[derive(Debug, Clone, Copy)]
pub struct RowBlock<'a> {
    /// Index of the block's first row within the segment's measurement.
    pub first_row: usize,
    /// Number of rows.
    pub rows: usize,
    tile: DecimatedTile<'a>,
}

impl<'a> From<DecimatedTile<'a>> for RowBlock<'a> {
    fn from(tile: DecimatedTile<'a>) -> Self {
        Self { first_row: tile.first_row(), rows: tile.rows(), tile }
    }
}

impl<'a> RowBlock<'a> {
    /// The rows of one column: a tile slot of the robot model, or a joint for predictions.
    pub fn column(&self, column: usize) -> &'a [f64] {
        self.tile.column(column)
    }

    /// The joint's measurement for these rows.
    pub fn measurement<'s>(&self, joint_rows: &'s [f64]) -> &'s [f64] {
        &joint_rows[self.first_row..self.first_row + self.rows]
    }

    /// |q̇| of a joint at a row of the block, rad/s.
    pub fn speed(&self, segment: &Segment, joint: usize, row: usize) -> f64 {
        segment.motion.view().velocity_rad_s(joint)[segment.sample(self.first_row + row)].abs()
    }
}

/// Evaluates the model over a segment, without filter, and hands over each tile with its first sample.
///
/// # Errors
/// Whatever a model reports.
pub fn for_each_tile(
    model: &RobotModel,
    segment: &Segment,
    load: &LoadTorque,
    mut visit: impl FnMut(usize, &RobotTile),
) -> Result<(), CalibrationError> {
    let motion = segment.motion.view();
    let mut state = RobotState::default();
    let mut tile = RobotTile::default();
    let mut first = 0;
    while first < motion.samples() {
        let end = (first + TILE_SAMPLES).min(motion.samples());
        model.evaluate(motion.slice(first..end), load, &mut state, &mut tile)?;
        visit(first, &tile);
        first = end;
    }
    Ok(())
}

/// Evaluates the model over a segment and hands over its filtered, decimated rows, one column per tile slot; samples that
/// are left out of the segment are zero.
///
/// # Errors
/// Whatever a model reports.
pub fn for_each_row_block(
    model: &RobotModel,
    segment: &Segment,
    load: &LoadTorque,
    mut visit: impl FnMut(RowBlock<'_>),
) -> Result<(), CalibrationError> {
    let mut filter = segment.bank(model.slots());
    let mut visit = |tile: DecimatedTile<'_>| visit(RowBlock::from(tile));
    let mut silenced = Vec::new();
    for_each_tile(model, segment, load, |first, tile| {
        let mut values = tile.raw();
        if segment.left_out.is_some() {
            silenced.clear();
            silenced.extend_from_slice(values);
            for joint in 0..model.joints() {
                for slot in model.row_slots(joint) {
                    let start = slot * tile.stride();
                    segment.silence(joint, first, &mut silenced[start..start + tile.samples()]);
                }
            }
            values = &silenced;
        }
        filter.push(values, tile.stride(), tile.samples(), &mut visit);
    })?;
    Ok(filter.finish(&mut visit)?)
}

/// Evaluates ŷ = W ζ over a segment and hands over its filtered, decimated rows, one column per joint.
///
/// # Errors
/// Whatever a model reports.
pub fn for_each_predicted_block(
    model: &RobotModel,
    segment: &Segment,
    load: &LoadTorque,
    coefficients: &[f64],
    mut visit: impl FnMut(RowBlock<'_>),
) -> Result<(), CalibrationError> {
    let joints = model.joints();
    let mut filter = segment.bank(joints);
    let mut visit = |tile: DecimatedTile<'_>| visit(RowBlock::from(tile));
    let mut predicted = vec![0.0; joints * TILE_SAMPLES];
    for_each_tile(model, segment, load, |first, tile| {
        predict_tile(model, tile, coefficients, TILE_SAMPLES, &mut predicted);
        for (joint, series) in predicted.chunks_exact_mut(TILE_SAMPLES).enumerate() {
            segment.silence(joint, first, &mut series[..tile.samples()]);
        }
        filter.push(&predicted, TILE_SAMPLES, tile.samples(), &mut visit);
    })?;
    Ok(filter.finish(&mut visit)?)
}

/// ŷ = Σ coefficient · column over a tile, joint after joint, `stride` apart.
pub fn predict_tile(
    model: &RobotModel,
    tile: &RobotTile,
    coefficients: &[f64],
    stride: usize,
    out: &mut [f64],
) {
    for joint in 0..model.joints() {
        let sum = &mut out[joint * stride..joint * stride + tile.samples()];
        sum.fill(0.0);
        for (slot, column) in model.row_slots(joint).zip(model.row_columns(joint)) {
            let coefficient = coefficients[*column];
            for (s, value) in sum.iter_mut().zip(tile.slot(slot)) {
                *s += coefficient * value;
            }
        }
    }
}
