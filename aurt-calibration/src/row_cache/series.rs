//! Columns of a model over a whole segment, and the load torque that they depend on.

use aurt_recording::{DecimatedTile, Segment};
use aurt_traits::{Columns, JointModel, JointSeries, JointStack};

use crate::CalibrationError;
use crate::rows::TILE_SAMPLES;

/// The load torque τ_J of every joint over a segment, unfiltered.
#[derive(Debug, Clone)]
pub(crate) struct LoadSeries {
    pub(super) values: Vec<f64>,
    samples: usize,
}

impl LoadSeries {
    pub(crate) fn zero(joints: usize, samples: usize) -> Self {
        Self { values: vec![0.0; joints * samples], samples }
    }

    /// All joints, `stride` apart, from sample `first` on.
    pub(crate) fn from(&self, first: usize) -> &[f64] {
        &self.values[first..]
    }

    /// Distance between the first samples of two joints.
    pub(crate) const fn stride(&self) -> usize {
        self.samples
    }

    pub(crate) fn joint(&self, joint: usize) -> &[f64] {
        &self.values[joint * self.samples..(joint + 1) * self.samples]
    }
}

/// Whether the parts of a stack can be had apart: its hysteresis and viscous columns do not depend on τ_J.
pub(crate) fn separable(stack: &JointStack) -> bool {
    !stack.hysteresis().reads_load() && !stack.viscous().reads_load()
}

/// What distinguishes a model from others; nothing for one that cannot be expressed.
pub(super) fn identity(slot: &str, model: &(impl serde::Serialize + ?Sized)) -> Option<String> {
    serde_json::to_string(model).ok().map(|text| format!("{slot} {text}"))
}

/// A model's columns at a joint over a whole segment, column after column.
pub(super) fn unfiltered(
    model: &dyn JointModel,
    segment: &Segment,
    joint: usize,
    load_torque: &[f64],
) -> Result<Vec<f64>, CalibrationError> {
    let motion = segment.motion.view();
    let (count, samples) = (model.columns().len(), motion.samples());
    let mut columns = vec![0.0; count * samples];
    if samples > 0 {
        let series = JointSeries::of(motion, joint, load_torque);
        let mut state = model.initial_state(&series.slice(0..1));
        model.evaluate(&series, &mut state, &mut Columns::new(&mut columns, count, samples, samples))?;
    }
    Ok(columns)
}

/// Columns over a whole segment, filtered and decimated.
pub(super) fn filtered(
    segment: &Segment,
    columns: &[f64],
    count: usize,
) -> Result<Vec<Vec<f64>>, CalibrationError> {
    let mut rows = vec![vec![0.0; segment.rows()]; count];
    if count == 0 {
        return Ok(rows);
    }
    let samples = segment.motion.samples();
    let mut bank = segment.bank(count);
    let mut store = |block: DecimatedTile<'_>| block.copy_to(rows.iter_mut().map(|r| &mut **r));
    for (first, end) in tiles(segment) {
        bank.push(&columns[first..], samples, end - first, &mut store);
    }
    bank.finish(&mut store)?;
    Ok(rows)
}

/// First sample and end of each tile of a segment.
pub(super) fn tiles(segment: &Segment) -> impl Iterator<Item = (usize, usize)> {
    let samples = segment.motion.samples();
    (0..samples).step_by(TILE_SAMPLES).map(move |first| (first, (first + TILE_SAMPLES).min(samples)))
}
