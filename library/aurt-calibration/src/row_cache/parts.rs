//! Columns of models that do not read the load torque, kept for all robot models that have them.

use std::{
    collections::HashMap,
    hash::Hash,
    sync::{Arc, Mutex, PoisonError},
};

use aurt_recording::{DecimatedTile, Segment};
use aurt_traits::{Columns, JointModel, JointSeries, JointStack};

use super::{dynamics::tiles, load::LoadSeries, rigid::RigidRows};
use crate::CalibrationError;

/// What is kept may take this much memory; what comes after is computed each time.
const MOST_BYTES: usize = 1 << 28;

/// The columns of a model at a joint over a segment.
#[derive(Debug)]
pub(crate) struct Part {
    /// Unfiltered, column after column.
    unfiltered: Vec<f64>,
    samples: usize,
    /// Filtered and decimated.
    pub rows: Vec<Vec<f64>>,
}

impl Part {
    /// The unfiltered columns.
    pub(crate) fn columns(&self) -> impl Iterator<Item = &[f64]> {
        self.unfiltered.chunks_exact(self.samples.max(1))
    }
}

/// Recording, segment, joint, and the model with its configuration.
pub(super) type Key = (usize, usize, usize, String);

/// What is kept of some recordings.
pub(super) type Parts = Kept<Key, Part>;

/// Results under what they depend on, up to some memory.
#[derive(Debug)]
pub(super) struct Kept<K, V>(Mutex<(HashMap<K, Arc<V>>, usize)>);

impl<K, V> Default for Kept<K, V> {
    fn default() -> Self {
        Self(Mutex::new((HashMap::new(), 0)))
    }
}

impl<K: Eq + Hash, V> Kept<K, V> {
    /// What is kept under `key`, or else what `make` makes. Two threads may make it at the same time: they make the same.
    /// Without a key nothing is kept.
    pub(super) fn get<E>(
        &self,
        key: Option<K>,
        bytes: impl Fn(&V) -> usize,
        make: impl FnOnce() -> Result<V, E>,
    ) -> Result<Arc<V>, E> {
        let kept = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = key.as_ref().and_then(|key| kept().0.get(key).cloned()) {
            return Ok(known);
        }
        let made = Arc::new(make()?);
        if let Some(key) = key {
            let bytes = bytes(&made);
            let mut kept = kept();
            if kept.1 + bytes <= MOST_BYTES && kept.0.insert(key, Arc::clone(&made)).is_none() {
                kept.1 += bytes;
            }
        }
        Ok(made)
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

impl RigidRows<'_> {
    /// The columns of a model that does not read the load torque; `identity` tells it from others.
    ///
    /// # Errors
    /// What the model reports.
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
    ///
    /// # Errors
    /// What models report.
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

/// Adds `coefficient` · column.
pub(super) fn add(sum: &mut [f64], coefficient: f64, column: &[f64]) {
    for (s, v) in sum.iter_mut().zip(column) {
        *s += coefficient * v;
    }
}

/// A model's columns at a joint over a whole segment, column after column.
///
/// # Errors
/// What the model reports.
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
        let series = JointSeries {
            time_s: motion.time_s(),
            position_rad: motion.position_rad(joint),
            velocity_rad_s: motion.velocity_rad_s(joint),
            acceleration_rad_s2: motion.acceleration_rad_s2(joint),
            load_torque,
        };
        let mut state = model.initial_state(&series.slice(0..1));
        model.evaluate(&series, &mut state, &mut Columns::new(&mut columns, count, samples, samples))?;
    }
    Ok(columns)
}

/// Columns over a whole segment, filtered and decimated.
///
/// # Errors
/// What the filter reports.
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
