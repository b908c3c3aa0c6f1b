//! Stacks from the columns that are kept.

use std::sync::Arc;

use aurt_traits::{JointModel, JointStack};

use super::kept::Part;
use super::rigid::RigidRows;
use super::series::{LoadSeries, filtered, identity, unfiltered};
use crate::CalibrationError;

impl RigidRows<'_> {
    /// The columns of a model that does not read the load torque; `identity` tells it from others.
    pub(super) fn part(
        &self,
        (recording, segment, joint): (usize, usize, usize),
        model: &dyn JointModel,
        identity: Option<String>,
    ) -> Result<Arc<Part>, CalibrationError> {
        let key = identity.map(|identity| (recording, segment, joint, identity));
        let bytes = |part: &Part| 8 * (part.unfiltered.len() + part.rows.iter().map(Vec::len).sum::<usize>());
        self.parts.get(key, bytes, || {
            let source = self.segment(recording, segment);
            let samples = source.motion.samples();
            let unfiltered = unfiltered(model, source, joint, &vec![0.0; samples])?;
            let rows = filtered(source, &unfiltered, model.columns().len())?;
            Ok(Part { unfiltered, samples, rows })
        })
    }

    /// Σ coefficient · column of a separable stack over a segment; `coefficients` are the stack's own. What does not
    /// depend on τ_J is added to `rows`, filtered and decimated; the rest, unfiltered, to `sums`.
    pub(super) fn add_stack(
        &self,
        (recording, segment, joint): (usize, usize, usize),
        stack: &JointStack,
        load: &LoadSeries,
        coefficients: &[f64],
        rows: &mut [f64],
        sums: &mut StackSums,
    ) -> Result<(), CalibrationError> {
        let place = (recording, segment, joint);
        let hysteresis = self.part(place, stack.hysteresis(), identity("hysteresis", stack.hysteresis()))?;
        let viscous = self.part(place, stack.viscous(), identity("viscous", stack.viscous()))?;
        let source = self.segment(recording, segment);
        let levels = unfiltered(stack.coulomb(), source, joint, load.joint(joint))?;
        let mut coefficients = coefficients.iter();
        for level in levels.chunks_exact(source.motion.samples().max(1)) {
            let own = coefficients.by_ref().take(hysteresis.rows.len());
            let is = |value: f64| level.iter().all(|l| *l == value);
            if is(1.0) {
                own.zip(&hysteresis.rows).for_each(|(c, column)| add(rows, *c, column));
            } else if is(0.0) {
                own.for_each(|_| ());
            } else {
                sums.any = true;
                let sum = sums.of(joint);
                for (coefficient, column) in own.zip(hysteresis.columns()) {
                    for (s, (l, h)) in sum.iter_mut().zip(level.iter().zip(column)) {
                        *s += coefficient * l * h;
                    }
                }
            }
        }
        coefficients.zip(&viscous.rows).for_each(|(c, column)| add(rows, *c, column));
        Ok(())
    }
}

/// What stacks add up to before the filter.
pub(super) struct StackSums {
    /// Joint after joint.
    pub sums: Vec<f64>,
    samples: usize,
    /// Whether anything was added.
    pub any: bool,
}

impl StackSums {
    pub(super) fn new(joints: usize, samples: usize) -> Self {
        Self { sums: vec![0.0; joints * samples], samples, any: false }
    }

    fn of(&mut self, joint: usize) -> &mut [f64] {
        &mut self.sums[joint * self.samples..(joint + 1) * self.samples]
    }
}

pub(super) fn add(sum: &mut [f64], coefficient: f64, column: &[f64]) {
    for (s, v) in sum.iter_mut().zip(column) {
        *s += coefficient * v;
    }
}
