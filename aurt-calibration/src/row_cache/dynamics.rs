use aurt_recording::{DecimatedTile, Segment};
use aurt_traits::{
    ArmSeries, ArmTerm, ColumnGroup, Columns, JointSeries, JointStack, RigidBodyRegressor, RobotModel,
};

use super::series::{LoadSeries, separable, tiles};
use crate::CalibrationError;
use crate::rows::TILE_SAMPLES;

/// Distance between the columns of a tile; not a multiple of 4096 bytes, so that they do not share cache sets.
const STRIDE: usize = TILE_SAMPLES + 8;

/// What writes columns beside the rigid bodies.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Source<'m> {
    Stack { joint: usize, stack: &'m JointStack, first_column: usize },
    Term { term: &'m dyn ArmTerm, first_column: usize, rigid_body: &'m dyn RigidBodyRegressor },
}

/// A column of the regressor in the rows of one joint, filtered and decimated.
#[derive(Debug, Clone)]
pub(crate) struct DynamicsColumn {
    /// The joint whose rows these are.
    pub joint: usize,
    /// The coefficient.
    pub column: usize,
    /// Its rows.
    pub rows: Vec<f64>,
}

impl<'m> Source<'m> {
    /// What a column group of a model stands for; nothing for the rigid bodies.
    pub(crate) fn of(model: &'m RobotModel, group: ColumnGroup) -> Option<Self> {
        let first_column = model.group(group).start;
        match group {
            ColumnGroup::RigidBody => None,
            ColumnGroup::JointDynamics(joint) => {
                Some(Self::Stack { joint, stack: &model.stacks()[joint], first_column })
            }
            ColumnGroup::ArmTerm(k) => Some(Self::Term {
                term: &*model.arm_terms()[k],
                first_column,
                rigid_body: &**model.rigid_body(),
            }),
        }
    }

    pub(crate) fn all(model: &'m RobotModel) -> Vec<Self> {
        model.groups().iter().filter_map(|(group, _)| Self::of(model, *group)).collect()
    }

    /// The (joint, column) pairs that can be non-zero, columns counted within the source.
    fn entries(&self, joints: usize) -> Vec<(usize, usize)> {
        match self {
            Self::Stack { joint, stack, .. } => (0..stack.columns().len()).map(|c| (*joint, c)).collect(),
            Self::Term { term, .. } => {
                let columns = term.columns(joints).len();
                let acts = |joint: &usize, c: usize| term.acts_on(c, *joint, joints);
                term.joints(joints)
                    .iter()
                    .flat_map(|j| (0..columns).filter(|c| acts(j, *c)).map(|c| (*j, c)).collect::<Vec<_>>())
                    .collect()
            }
        }
    }

    /// Whether its columns may depend on τ_J.
    pub(crate) fn reads_load(&self) -> bool {
        match self {
            Self::Stack { stack, .. } => stack.coulomb().reads_load() || !separable(stack),
            Self::Term { .. } => true,
        }
    }

    /// True of an arm term whose torque joints transmit; it sees no load itself.
    pub(crate) fn is_load(&self) -> bool {
        matches!(self, Self::Term { term, .. } if term.is_load())
    }

    /// Whether it is a stack whose parts can be had apart.
    pub(crate) fn separable(&self) -> bool {
        matches!(self, Self::Stack { stack, .. } if separable(stack))
    }

    const fn first_column(&self) -> usize {
        match self {
            Self::Stack { first_column, .. } | Self::Term { first_column, .. } => *first_column,
        }
    }
}

/// A source with the state it carries from tile to tile.
struct Running<'m> {
    source: Source<'m>,
    entries: Vec<(usize, usize)>,
    first_slot: usize,
    state: Option<Vec<f64>>,
    scratch: Vec<f64>,
}

impl Running<'_> {
    /// Evaluates the samples from `first` to `end` into the source's slots of `data`, [`STRIDE`] apart.
    fn evaluate(
        &mut self,
        segment: &Segment,
        load: &LoadSeries,
        (first, end): (usize, usize),
        data: &mut [f64],
    ) -> Result<(), CalibrationError> {
        let motion = segment.motion.view();
        let samples = end - first;
        let out = &mut data[self.first_slot * STRIDE..];
        match self.source {
            Source::Stack { joint, stack, .. } => {
                let now = motion.slice(first..end);
                let series = JointSeries::of(now, joint, &load.joint(joint)[first..end]);
                let state = self.state.get_or_insert_with(|| stack.initial_state(&series.slice(0..1)));
                let mut out = Columns::new(out, self.entries.len(), samples, STRIDE);
                stack.evaluate(&series, state, &mut out)?;
            }
            Source::Term { term, rigid_body, .. } => {
                let no_load = vec![0.0; if term.is_load() { motion.joints() * STRIDE } else { 0 }];
                let (load_torque, load_stride) =
                    if term.is_load() { (&*no_load, STRIDE) } else { (load.from(first), load.stride()) };
                let now = |end| {
                    let motion = motion.slice(first..end);
                    ArmSeries { motion, load_torque, load_stride, rigid_body }
                };
                let state = self.state.get_or_insert_with(|| term.initial_state(&now(first + 1)));
                let columns = term.columns(motion.joints()).len();
                let joints = term.joints(motion.joints());
                self.scratch.resize(joints.len() * columns * STRIDE, 0.0);
                let count = joints.len() * columns;
                let mut all = Columns::new(&mut self.scratch, count, samples, STRIDE);
                term.evaluate(&now(end), state, &mut all)?;
                for (slot, (joint, column)) in self.entries.iter().enumerate() {
                    let i = joints.iter().position(|j| j == joint).unwrap_or_default();
                    out[slot * STRIDE..slot * STRIDE + samples]
                        .copy_from_slice(all.column(i * columns + column));
                }
            }
        }
        Ok(())
    }
}

/// The filtered, decimated columns of some sources over a segment, in the sources' order.
pub(crate) fn dynamics_rows(
    sources: &[Source<'_>],
    segment: &Segment,
    load: &LoadSeries,
) -> Result<Vec<DynamicsColumn>, CalibrationError> {
    let rows = segment.rows();
    let (mut running, entries) = begin(sources, segment.motion.joints());
    let mut columns: Vec<DynamicsColumn> = entries
        .into_iter()
        .map(|(joint, column)| DynamicsColumn { joint, column, rows: vec![0.0; rows] })
        .collect();
    let mut data = vec![0.0; columns.len() * STRIDE];
    let mut bank = segment.bank(columns.len());
    let mut store = |block: DecimatedTile<'_>| block.copy_to(columns.iter_mut().map(|c| &mut *c.rows));
    for (first, end) in tiles(segment) {
        for source in &mut running {
            source.evaluate(segment, load, (first, end), &mut data)?;
        }
        bank.push(&data, STRIDE, end - first, &mut store);
    }
    bank.finish(&mut store)?;
    Ok(columns)
}

/// Adds the sources' columns over a segment, each times its coefficient, to its joint's part of `summed`.
pub(crate) fn add_sums(
    sources: &[Source<'_>],
    segment: &Segment,
    load: &LoadSeries,
    coefficient: impl Fn(usize) -> f64,
    summed: &mut [f64],
) -> Result<(), CalibrationError> {
    let (joints, samples) = (segment.motion.joints(), segment.motion.samples());
    let (mut running, entries) = begin(sources, joints);
    let mut data = vec![0.0; entries.len() * STRIDE];
    for (first, end) in tiles(segment) {
        for source in &mut running {
            source.evaluate(segment, load, (first, end), &mut data)?;
        }
        for ((joint, column), values) in entries.iter().zip(data.chunks_exact(STRIDE)) {
            let factor = coefficient(*column);
            let sum = &mut summed[joint * samples + first..joint * samples + end];
            sum.iter_mut().zip(values).for_each(|(s, v)| *s += factor * v);
        }
    }
    Ok(())
}

/// Sources without a state yet, and the (joint, coefficient) of each of their columns.
fn begin<'m>(sources: &[Source<'m>], joints: usize) -> (Vec<Running<'m>>, Vec<(usize, usize)>) {
    let mut columns = Vec::new();
    let mut running = Vec::new();
    for source in sources {
        let entries = source.entries(joints);
        let first_slot = columns.len();
        columns.extend(entries.iter().map(|(joint, column)| (*joint, source.first_column() + column)));
        running.push(Running { source: *source, entries, first_slot, state: None, scratch: Vec::new() });
    }
    (running, columns)
}
