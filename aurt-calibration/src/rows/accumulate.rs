//! From recordings to one triangle per joint, tile by tile.

use std::ops::Range;

use aurt_recording::{Segment, ZeroPhaseBank};
use aurt_traits::{LoadTorque, MotionView, RobotModel, RobotState, RobotTile};
use rayon::prelude::*;

use super::recordings::NamedRecording;
use super::scope::TermScopes;
use super::stream::{RowBlock, TILE_SAMPLES};
use crate::{CalibrationError, CalibrationOptions, JointFactor, Rest, System};

/// Accumulates the factors of all joints over all recordings: segments in parallel and, within a segment, the joints'
/// filters and triangles beside the evaluation of the next tile. Triangles are merged in the order of segments, so
/// that results do not depend on the number of threads. Arm terms act where `scopes` says.
///
/// # Errors
/// What models report.
pub fn accumulate(
    model: &RobotModel,
    recordings: &[NamedRecording],
    scopes: &TermScopes,
    load: &LoadTorque,
    options: &CalibrationOptions,
) -> Result<System, CalibrationError> {
    Ok(accumulate_ranged(model, recordings, scopes, load, options)?.system)
}

/// A system, and what the joints carried while its rows were made.
#[derive(Debug)]
pub(crate) struct Accumulated {
    /// The factors of all joints.
    pub system: System,
    /// Largest |τ_J| of each joint.
    pub load_torque: Vec<f64>,
}

pub(crate) fn accumulate_ranged(
    model: &RobotModel,
    recordings: &[NamedRecording],
    scopes: &TermScopes,
    load: &LoadTorque,
    options: &CalibrationOptions,
) -> Result<Accumulated, CalibrationError> {
    let segments: Vec<(&Segment, Vec<bool>)> = recordings
        .iter()
        .flat_map(|r| r.data.segments.iter().map(|s| (s, scopes.acting(model, &r.name))))
        .collect();
    let parts = segments
        .par_iter()
        .map(|(segment, acting)| accumulate_segment(model, segment, acting, load, options))
        .collect::<Result<Vec<_>, _>>()?;
    let mut parts = parts.into_iter();
    let mut total = parts.next().ok_or(CalibrationError::NothingToCalibrateOn)?;
    for part in parts {
        total.system.merge(&part.system)?;
        for (largest, other) in total.load_torque.iter_mut().zip(part.load_torque) {
            *largest = largest.max(other);
        }
    }
    Ok(total)
}

fn accumulate_segment(
    model: &RobotModel,
    segment: &Segment,
    acting: &[bool],
    load: &LoadTorque,
    options: &CalibrationOptions,
) -> Result<Accumulated, CalibrationError> {
    let bank = |columns| segment.bank(columns);
    let mut folding = Folding::new(model, &bank, acting, load, options);
    if let Some(measurement) = &segment.measurement {
        let motion = segment.motion.view();
        let speed = |joint: usize, row: usize| motion.velocity_rad_s(joint)[segment.sample(row)].abs();
        folding.push(motion, &Measured { first_row: 0, measurement, speed: &speed })?;
        folding.finish(&Measured { first_row: 0, measurement, speed: &speed })
    } else {
        folding.empty()
    }
}

pub(crate) struct Measured<'a> {
    /// Index of the first row within the segment.
    pub first_row: usize,
    /// `[joint][row]`.
    pub measurement: &'a [Vec<f64>],
    /// |q̇| of a joint at a row, rad/s; rows count from `first_row`.
    pub speed: &'a (dyn Fn(usize, usize) -> f64 + Sync),
}

/// A segment on its way into triangles: its motion comes in consecutive pieces.
pub(crate) struct Folding<'a> {
    model: &'a RobotModel,
    load: &'a LoadTorque,
    state: RobotState,
    shares: Vec<Share<'a>>,
    tiles: [RobotTile; 2],
    load_torque: Vec<f64>,
}

impl<'a> Folding<'a> {
    /// Nothing taken in yet; `bank` makes the filter of some columns.
    pub(crate) fn new(
        model: &'a RobotModel,
        bank: &dyn Fn(usize) -> ZeroPhaseBank,
        acting: &'a [bool],
        load: &'a LoadTorque,
        options: &'a CalibrationOptions,
    ) -> Self {
        // A tile's columns do not know of one another: how they are shared out does not show in the results.
        let shares = if rayon::current_num_threads() == 1 { 1 } else { model.joints() };
        let shares = shares_of(model, shares)
            .into_iter()
            .map(|joints| {
                let slots = model.row_slots(joints.start).start..model.row_slots(joints.end - 1).end;
                Share {
                    model,
                    acting,
                    options,
                    filter: bank(slots.len()),
                    delivered: 0,
                    factors: joints
                        .clone()
                        .map(|j| JointFactor::new(model.row_columns(j).to_vec()))
                        .collect(),
                    first_joint: joints.start,
                    slots,
                }
            })
            .collect();
        let load_torque = vec![0.0; model.joints()];
        Self { model, load, state: RobotState::default(), shares, tiles: Default::default(), load_torque }
    }

    /// Takes in the next samples. `measured` has the rows that the filter may deliver meanwhile.
    pub(crate) fn push(
        &mut self,
        motion: MotionView<'_>,
        measured: &Measured<'_>,
    ) -> Result<(), CalibrationError> {
        let Self { model, load, state, shares, tiles: [tile, following], load_torque } = self;
        let mut next = 0;
        let mut evaluate = |tile: &mut RobotTile| -> Result<bool, CalibrationError> {
            let end = (next + TILE_SAMPLES).min(motion.samples());
            if next == end {
                return Ok(false);
            }
            model.evaluate(motion.slice(next..end), load, state, tile)?;
            next = end;
            Ok(true)
        };
        let mut more = evaluate(tile)?;
        while more {
            for (joint, largest) in load_torque.iter_mut().enumerate() {
                *largest = tile.load_torque(joint).iter().fold(*largest, |a, v| a.max(v.abs()));
            }
            if let [share] = shares.as_mut_slice() {
                share.push(tile, measured);
                more = evaluate(tile)?;
            } else {
                let fold = || shares.par_iter_mut().for_each(|share| share.push(tile, measured));
                let (evaluated, ()) = rayon::join(|| evaluate(following), fold);
                more = evaluated?;
                std::mem::swap(tile, following);
            }
        }
        Ok(())
    }

    pub(crate) fn finish(self, measured: &Measured<'_>) -> Result<Accumulated, CalibrationError> {
        let coefficients = self.model.parameters().len();
        let finish = |share: Share<'_>| share.finish(measured);
        let factors: Vec<Vec<JointFactor>> =
            self.shares.into_par_iter().map(finish).collect::<Result<_, _>>()?;
        let system = System::new(coefficients, factors.into_iter().flatten().collect());
        Ok(Accumulated { system, load_torque: self.load_torque })
    }

    pub(crate) fn delivered(&self) -> usize {
        self.shares.first().map_or(0, |share| share.delivered)
    }

    fn empty(self) -> Result<Accumulated, CalibrationError> {
        let coefficients = self.model.parameters().len();
        let factors = self.shares.into_iter().flat_map(|share| share.factors).collect();
        Ok(Accumulated { system: System::new(coefficients, factors), load_torque: self.load_torque })
    }
}

/// Consecutive joints with about as many slots in each share.
fn shares_of(model: &RobotModel, shares: usize) -> Vec<Range<usize>> {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    let mut first = 0;
    for joint in 0..model.joints() {
        let slots = model.row_slots(joint).end;
        if slots * shares >= (ranges.len() + 1) * model.slots() || joint + 1 == model.joints() {
            ranges.push(first..joint + 1);
            first = joint + 1;
        }
    }
    ranges
}

/// The filter and the triangles of some joints' rows.
struct Share<'a> {
    model: &'a RobotModel,
    options: &'a CalibrationOptions,
    acting: &'a [bool],
    first_joint: usize,
    slots: Range<usize>,
    filter: ZeroPhaseBank,
    delivered: usize,
    factors: Vec<JointFactor>,
}

impl Share<'_> {
    fn push(&mut self, tile: &RobotTile, measured: &Measured<'_>) {
        let data = &tile.raw()[self.slots.start * tile.stride()..];
        let Self { model, options, acting, first_joint, filter, delivered, factors, .. } = self;
        filter.push(data, tile.stride(), tile.samples(), &mut |block| {
            *delivered = block.first_row() + block.rows();
            fold(model, options, acting, *first_joint, measured, block.into(), factors);
        });
    }

    fn finish(self, measured: &Measured<'_>) -> Result<Vec<JointFactor>, CalibrationError> {
        let Self { model, options, acting, first_joint, mut filter, mut factors, .. } = self;
        filter.finish(&mut |block| {
            fold(model, options, acting, first_joint, measured, block.into(), &mut factors);
        })?;
        Ok(factors)
    }
}

/// Takes the filtered rows that count into the factors of the joints from `first_joint` on.
fn fold(
    model: &RobotModel,
    options: &CalibrationOptions,
    acting: &[bool],
    first_joint: usize,
    measured: &Measured<'_>,
    block: RowBlock<'_>,
    factors: &mut [JointFactor],
) {
    let absent = vec![0.0; if acting.iter().all(|a| *a) { 0 } else { block.rows }];
    let first_slot = model.row_slots(first_joint).start;
    let first = block.first_row - measured.first_row;
    for (joint, factor) in (first_joint..).zip(factors) {
        let (slots, columns) = (model.row_slots(joint), model.row_columns(joint));
        let rest = options.rest_velocity(&**model.rigid_body(), joint);
        factor.push(
            |k| if acting[columns[k]] { block.column(slots.start - first_slot + k) } else { &absent },
            &measured.measurement[joint][first..first + block.rows],
            |row| options.rest == Rest::Keep || (measured.speed)(joint, first + row) > rest,
        );
    }
}
