//! A segment's regressor, tile by tile: evaluated, filtered in parallel with the measurement, decimated.

use aurt_recording::{DecimatedTile, Segment, ZeroPhase, ZeroPhaseBank};
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

impl<'a> RowBlock<'a> {
    /// The rows of one column: a tile slot of the robot model, or a joint for predictions.
    #[must_use]
    pub fn column(&self, column: usize) -> &'a [f64] {
        &self.tile.column(column)[..self.rows]
    }

    /// The joint's measurement for these rows.
    #[must_use]
    pub fn measurement<'s>(&self, joint_rows: &'s [f64]) -> &'s [f64] {
        &joint_rows[self.first_row..self.first_row + self.rows]
    }

    /// |q̇| of a joint at a row of the block, rad/s.
    #[must_use]
    pub fn speed(&self, segment: &Segment, joint: usize, row: usize) -> f64 {
        segment.motion.view().velocity_rad_s(joint)[(self.first_row + row) * segment.decimation].abs()
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

/// Evaluates the model over a segment and hands over its filtered, decimated rows, one column per tile slot.
///
/// # Errors
/// Whatever a model reports.
pub fn for_each_row_block(
    model: &RobotModel,
    segment: &Segment,
    load: &LoadTorque,
    mut visit: impl FnMut(RowBlock<'_>),
) -> Result<(), CalibrationError> {
    let mut filter = FilteredRows::of(segment, model.slots());
    for_each_tile(model, segment, load, |_, tile| {
        filter.push(tile.raw(), tile.stride(), tile.samples(), &mut visit);
    })?;
    filter.finish(&mut visit)
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
    let mut filter = FilteredRows::of(segment, joints);
    let mut predicted = vec![0.0; joints * TILE_SAMPLES];
    for_each_tile(model, segment, load, |_, tile| {
        predict_tile(model, tile, coefficients, TILE_SAMPLES, &mut predicted);
        filter.push(&predicted, TILE_SAMPLES, tile.samples(), &mut visit);
    })?;
    filter.finish(&mut visit)
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

/// A filter bank that stops at the end of the measurement.
pub(crate) struct FilteredRows {
    bank: ZeroPhaseBank,
    rows: usize,
    delivered: usize,
}

impl FilteredRows {
    /// A bank of `columns` columns, of whose rows the first `rows` count.
    pub(crate) fn new((filter, decimation): (&ZeroPhase, usize), columns: usize, rows: usize) -> Self {
        Self { bank: ZeroPhaseBank::new(filter, columns, decimation), rows, delivered: 0 }
    }

    /// A bank for a segment.
    fn of(segment: &Segment, columns: usize) -> Self {
        Self::new((&segment.parallel_filter, segment.decimation), columns, segment.rows())
    }

    /// Rows handed over so far.
    pub(crate) const fn delivered(&self) -> usize {
        self.delivered
    }

    pub(crate) fn push(
        &mut self,
        data: &[f64],
        stride: usize,
        samples: usize,
        visit: &mut impl FnMut(RowBlock<'_>),
    ) {
        let Self { bank, rows, delivered } = self;
        bank.push(data, stride, samples, &mut |tile| {
            *delivered = tile.first_row() + tile.rows();
            hand_over(tile, *rows, visit);
        });
    }

    pub(crate) fn finish(mut self, visit: &mut impl FnMut(RowBlock<'_>)) -> Result<(), CalibrationError> {
        let rows = self.rows;
        Ok(self.bank.finish(&mut |tile| hand_over(tile, rows, visit))?)
    }
}

fn hand_over(tile: DecimatedTile<'_>, total: usize, visit: &mut impl FnMut(RowBlock<'_>)) {
    let rows = tile.rows().min(total.saturating_sub(tile.first_row()));
    if rows > 0 {
        visit(RowBlock { first_row: tile.first_row(), rows, tile });
    }
}
