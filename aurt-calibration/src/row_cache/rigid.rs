use std::sync::Arc;

use aurt_recording::{DecimatedTile, Segment};
use aurt_traits::{BaseParameters, MotionView, RegressorTile, RigidBodyRegressor, RobotModel};
use rayon::prelude::*;

use super::kept::Parts;
use super::series::tiles;
use crate::rows::check;
use crate::{CalibrationError, NamedRecording};

/// Recordings with the filtered, decimated rows of their rigid-body columns.
#[derive(Debug)]
pub struct RigidRows<'r> {
    rigid_body: Arc<dyn RigidBodyRegressor>,
    base: BaseParameters,
    recordings: &'r [NamedRecording],
    layout: Layout,
    segments: Vec<Vec<SegmentRows>>,
    pub(super) parts: Parts,
}

/// Where the rigid-body entries of each joint's row lie in a tile.
#[derive(Debug)]
struct Layout {
    /// The base parameters that can load each joint.
    columns: Vec<Vec<usize>>,
    /// Each joint's first slot, and the number of slots.
    first_slot: Vec<usize>,
    destination: Vec<u32>,
    standard: usize,
}

/// The rows of one segment, slot after slot.
#[derive(Debug)]
struct SegmentRows {
    rows: usize,
    data: Vec<f64>,
}

/// Unfiltered rigid-body entries over a few samples.
#[derive(Debug, Default)]
struct RigidTile {
    data: Vec<f64>,
    stride: usize,
    samples: usize,
}

impl<'r> RigidRows<'r> {
    pub(super) fn rigid_body(&self) -> &dyn RigidBodyRegressor {
        &*self.rigid_body
    }

    /// Evaluates and filters the rigid-body columns of `model` over `recordings`; any model of the same rigid bodies
    /// can then use them.
    ///
    /// # Errors
    /// [`CalibrationError::Joints`], [`CalibrationError::NoMeasurement`], and what the filter reports.
    pub fn new(model: &RobotModel, recordings: &'r [NamedRecording]) -> Result<Self, CalibrationError> {
        check(model, recordings)?;
        let layout = Layout::new(&**model.rigid_body(), model.base());
        let mut rows = Self {
            rigid_body: Arc::clone(model.rigid_body()),
            base: model.base().clone(),
            recordings,
            layout,
            segments: Vec::new(),
            parts: Parts::default(),
        };
        let of_recording = |r: &NamedRecording| -> Result<Vec<SegmentRows>, CalibrationError> {
            r.data.segments.par_iter().map(|segment| rows.filtered(segment)).collect()
        };
        rows.segments = recordings.par_iter().map(of_recording).collect::<Result<_, _>>()?;
        Ok(rows)
    }

    /// The recordings.
    pub const fn recordings(&self) -> &'r [NamedRecording] {
        self.recordings
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.layout.columns.len()
    }

    /// Whether `model` has the rigid bodies of these rows.
    pub(crate) fn fits(&self, model: &RobotModel) -> Result<(), CalibrationError> {
        let same = model.base().columns == self.base.columns
            && model.rigid_body().gravity_m_s2() == self.rigid_body.gravity_m_s2();
        if same && model.joints() == self.joints() {
            return Ok(());
        }
        Err(CalibrationError::Columns { left: self.base.len(), right: model.base().len() })
    }

    /// The base parameters that can load a joint.
    pub(crate) fn columns(&self, joint: usize) -> &[usize] {
        &self.layout.columns[joint]
    }

    pub(crate) fn segment(&self, recording: usize, segment: usize) -> &'r Segment {
        &self.recordings[recording].data.segments[segment]
    }

    /// The rows of the k-th of [`Self::columns`] of a joint.
    pub(crate) fn column(&self, recording: usize, segment: usize, joint: usize, k: usize) -> &[f64] {
        let rows = &self.segments[recording][segment];
        let slot = self.layout.first_slot[joint] + k;
        &rows.data[slot * rows.rows..(slot + 1) * rows.rows]
    }

    /// Σ weight · base column of each joint, unfiltered, joint after joint.
    pub(crate) fn torque(&self, motion: MotionView<'_>, weights: &[f64], out: &mut [f64]) {
        let mut standard = vec![0.0; self.layout.standard];
        self.base.columns.iter().zip(weights).for_each(|(column, weight)| standard[*column] = *weight);
        self.rigid_body.torque(motion, &standard, out, motion.samples());
    }

    /// Evaluates the rigid-body entries, unfiltered.
    fn evaluate(&self, motion: MotionView<'_>, tile: &mut RigidTile) {
        let samples = motion.samples();
        // Not a multiple of 4096 bytes, so that columns do not fall on the same cache sets.
        let padded = samples.next_multiple_of(8);
        tile.stride = if padded.is_multiple_of(64) { padded + 8 } else { padded };
        tile.samples = samples;
        tile.data.resize(self.layout.slots() * tile.stride, 0.0);
        let Layout { destination, standard, .. } = &self.layout;
        self.rigid_body.evaluate(
            motion,
            &mut RegressorTile::new(destination, *standard, samples, tile.stride, &mut tile.data),
        );
    }

    fn filtered(&self, segment: &Segment) -> Result<SegmentRows, CalibrationError> {
        let (slots, rows) = (self.layout.slots(), segment.rows());
        let mut data = vec![0.0; slots * rows];
        let mut store = |block: DecimatedTile<'_>| block.copy_to(data.chunks_exact_mut(rows.max(1)));
        let mut bank = segment.bank(slots);
        let motion = segment.motion.view();
        let mut tile = RigidTile::default();
        for (first, end) in tiles(segment) {
            self.evaluate(motion.slice(first..end), &mut tile);
            bank.push(&tile.data, tile.stride, tile.samples, &mut store);
        }
        bank.finish(&mut store)?;
        Ok(SegmentRows { rows, data })
    }
}

impl Layout {
    fn new(rigid_body: &dyn RigidBodyRegressor, base: &BaseParameters) -> Self {
        let (joints, standard) = (rigid_body.joints(), rigid_body.standard_parameters().len());
        let columns: Vec<Vec<usize>> = (0..joints)
            .map(|joint| (0..base.len()).filter(|k| rigid_body.loads(base.columns[*k], joint)).collect())
            .collect();
        let mut first_slot = vec![0];
        let mut destination = vec![RegressorTile::UNWANTED; joints * standard];
        for (joint, loading) in columns.iter().enumerate() {
            let first = first_slot[joint];
            for (k, column) in loading.iter().enumerate() {
                destination[joint * standard + base.columns[*column]] = (first + k) as u32;
            }
            first_slot.push(first + loading.len());
        }
        Self { columns, first_slot, destination, standard }
    }

    fn slots(&self) -> usize {
        self.first_slot[self.columns.len()]
    }
}
