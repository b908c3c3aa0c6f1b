//! Finding the size at which an effect has the strength that was asked for.

use std::rc::Rc;
use std::sync::Arc;

use super::laboratory::Laboratory;
use super::layout::{Role, Slot};
use crate::effects::read_effect;
use crate::fit::{NoiseFreeFit, Samples, without_absorbed_rotors};
use crate::strength::Strength;
use aurt_simulation::effects::{Effect, EffectKind, Factor, Shapes};
use aurt_simulation::inject::{Structure, StructureColumns};
use aurt_simulation::plant::Traces;
use aurt_simulation::robots::Robot;
use aurt_simulation::sensors::Instrument;
use aurt_simulation::{SimulationError, trace_with_instrument};

/// How often the size may be corrected.
const CORRECTIONS: usize = 4;
/// A ratio to the wanted strength within which it is met.
const MET: f64 = 1.25;
const LARGEST_CORRECTION: f64 = 2.5;

/// The recordings of a case without any effect.
#[derive(Debug)]
pub(super) struct Undisturbed {
    pub traces: Vec<Traces>,
    pub instrument: Instrument,
}

impl Undisturbed {
    /// Largest drive torque of each joint over all recordings, Nm.
    pub fn peak_torque_nm(&self, joints: usize) -> Vec<f64> {
        let mut peak = vec![0.0_f64; joints];
        for row in self.traces.iter().flat_map(|t| t.torque_nm.chunks_exact(joints)) {
            for (p, u) in peak.iter_mut().zip(row) {
                *p = p.max(u.abs());
            }
        }
        peak
    }
}

/// Everything that the recordings of a case are made from: the robot as the experiment knows it, the terms that
/// the experiment has, and the recordings without any effect.
#[derive(Debug)]
pub(super) struct Bench {
    pub robot: Robot,
    pub structure: Structure,
    pub columns: Arc<StructureColumns>,
    pub laboratory: Rc<Laboratory>,
    pub bounds: Robot,
    pub undisturbed: Undisturbed,
    /// The structure fitted to the undisturbed calibration recordings.
    calm: NoiseFreeFit,
}

impl Bench {
    pub fn new(
        robot: Robot,
        whole: &Robot,
        slots: &[Slot],
        laboratory: &Rc<Laboratory>,
    ) -> Result<Self, SimulationError> {
        let structure = without_absorbed_rotors(Structure::of(&robot), &robot)?;
        let columns = Arc::new(StructureColumns::of_robot(&robot, &structure)?);
        let instrument = laboratory.instrument.clone();
        let traces =
            slots.iter().map(|slot| laboratory.trace(&robot, slot)).collect::<Result<Vec<_>, _>>()?;
        let reference = traces
            .iter()
            .zip(slots)
            .filter(|(_, slot)| slot.role == Role::Calibration)
            .map(|(traces, _)| Samples::new(traces, &instrument, None))
            .collect::<Result<Vec<_>, _>>()?;
        let calm = NoiseFreeFit::new(&robot, &columns, &reference, laboratory.rest_rad_s);
        let laboratory = Rc::clone(laboratory);
        // Friction that an effect stands for is not in `robot`, whose bounds for it are then narrow. Cases of the clean
        // world have been made so, and stay what they were.
        let bounds = if laboratory.shapes == Shapes::Continuum { whole.clone() } else { robot.clone() };
        Ok(Self {
            robot,
            structure,
            columns,
            laboratory,
            bounds,
            undisturbed: Undisturbed { traces, instrument },
            calm,
        })
    }
}

impl Bench {
    /// What the structure cannot absorb of the undisturbed calibration recordings, over noise, per joint: nothing in the
    /// clean world, and what the experiment neglects elsewhere.
    pub fn neglected(&self, slots: &[Slot]) -> Result<Vec<f64>, SimulationError> {
        let mut largest = vec![0.0_f64; self.robot.joints()];
        let calibration = slots.iter().zip(&self.undisturbed.traces);
        for (_, traces) in calibration.filter(|(slot, _)| slot.role == Role::Calibration) {
            let samples = Samples::new(traces, &self.undisturbed.instrument, None)?;
            for (most, left) in largest.iter_mut().zip(self.calm.left_over(&samples)) {
                *most = most.max(left.sqrt());
            }
        }
        Ok(largest)
    }
}

/// An effect of a certain size: what it does to the recordings, and how strong that is.
#[derive(Debug)]
pub(super) struct Probed {
    pub effect: Box<dyn Effect>,
    /// Over noise, per joint.
    pub achieved: Vec<f64>,
    pub disturbed: Vec<(usize, Traces, Instrument)>,
}

impl Probed {
    /// The strength on the joints that the effect is to have it on: each if it has a size for each, else the
    /// largest.
    pub fn own_joints(&self, kind: &EffectKind) -> Vec<f64> {
        if kind.joint_by_joint() {
            self.effect.joints().iter().map(|j| self.achieved[*j]).collect()
        } else {
            vec![self.strongest(kind)]
        }
    }

    /// The largest strength over the effect's joints.
    pub fn strongest(&self, kind: &EffectKind) -> f64 {
        let joints = self.effect.joints();
        let concerned = |j: &usize| kind.whole_arm() || joints.contains(j);
        (0..self.achieved.len()).filter(concerned).map(|j| self.achieved[j]).fold(0.0, f64::max)
    }
}

/// Which slots show the effect: those to be explained, and of effects with a window only the first.
fn shown<'a>(
    slots: &'a [Slot],
    effect: &dyn Effect,
    at_most: usize,
) -> impl Iterator<Item = (usize, &'a Slot)> {
    let role = if slots.iter().any(|s| s.role == Role::Target) { Role::Target } else { Role::Calibration };
    let most = if effect.window_s().is_some() { 1 } else { at_most };
    slots.iter().enumerate().filter(move |(_, slot)| slot.role == role).take(most)
}

/// The sizes tried so far on one joint: logarithms of the last size, relative to the first, and of the strength
/// that it had.
#[derive(Debug, Clone, Copy)]
struct Search {
    size: f64,
    before: Option<(f64, f64)>,
}

impl Search {
    /// The factor that should bring `achieved` to `wanted`: strength is taken as a power of size, the first
    /// power until two sizes have been tried.
    fn factor(&mut self, achieved: f64, wanted: f64) -> f64 {
        let strength = libm::log(achieved.max(1e-6));
        let power = self.before.map_or(1.0, |(size, before)| {
            let (run, rise) = (self.size - size, strength - before);
            if run.abs() < 1e-3 { 1.0 } else { (rise / run).clamp(0.35, 3.0) }
        });
        let step = (libm::log(wanted) - strength) / power;
        let step = step.clamp(-LARGEST_CORRECTION, LARGEST_CORRECTION);
        self.before = Some((self.size, strength));
        self.size += step;
        libm::exp(step)
    }
}

/// Corrects the effect's size until it has the wanted strength, on each of its joints if it has a size for
/// each, or can get no nearer to it.
pub(super) fn bring_to_strength(
    bench: &Bench,
    slots: &[Slot],
    kind: &EffectKind,
    mut effect: Box<dyn Effect>,
    strength: Strength,
) -> Result<Probed, SimulationError> {
    let wanted = strength.over_noise();
    let joints = bench.robot.joints();
    if kind.identifier == "dropped_samples" {
        // Rows are lost, no torque is added: the size is the share of rows.
        effect.scale(Factor::Uniform(wanted), &bench.robot);
        return Ok(Probed { effect, achieved: vec![wanted; joints], disturbed: Vec::new() });
    }
    let mut searches = vec![Search { size: 0.0, before: None }; joints];
    let mut last = vec![0.0; joints];
    for correction in 0.. {
        let (achieved, disturbed) = measure(bench, slots, &*effect)?;
        let probed = Probed { effect, achieved, disturbed };
        let own = probed.own_joints(kind);
        let met = own.iter().all(|s| (1.0 / MET..=MET).contains(&(s / wanted)));
        // A size that no longer changes anything has met its bounds.
        let stuck = correction > 0
            && probed
                .achieved
                .iter()
                .zip(&last)
                .all(|(now, before)| (now - before).abs() <= 0.01 * now.max(0.01));
        if met || stuck || correction == CORRECTIONS {
            return Ok(probed);
        }
        last.clone_from(&probed.achieved);
        let factors: Vec<f64> = if kind.joint_by_joint() {
            searches.iter_mut().zip(&probed.achieved).map(|(search, a)| search.factor(*a, wanted)).collect()
        } else {
            vec![searches[0].factor(probed.strongest(kind), wanted); joints]
        };
        effect = probed.effect;
        effect.scale(Factor::PerJoint(&factors), &bench.bounds);
    }
    Err(SimulationError::NotSettled {
        what: "the size of an effect",
        iterations: CORRECTIONS,
        change: 0.0,
        time_s: 0.0,
    })
}

/// Strength per joint, and what happened in each recording, by its slot.
type Measured = (Vec<f64>, Vec<(usize, Traces, Instrument)>);

/// The effect's torque that the structure cannot absorb, over noise, per joint: in the recording that shows
/// most of it.
fn measure(bench: &Bench, slots: &[Slot], effect: &dyn Effect) -> Result<Measured, SimulationError> {
    let Bench { robot, columns, laboratory, undisturbed, calm, .. } = bench;
    let window_s = effect.window_s();
    let mut disturbed = Vec::new();
    for (k, slot) in shown(slots, effect, laboratory.effort.0) {
        let effects = vec![read_effect(effect.identifier(), effect.fields())?];
        let (traces, instrument) = trace_with_instrument(&laboratory.scenario(robot, slot, effects))?;
        disturbed.push((k, traces, instrument));
    }
    let samples = disturbed
        .iter()
        .map(|(_, traces, instrument)| Samples::new(traces, instrument, window_s))
        .collect::<Result<Vec<_>, _>>()?;
    // What has been there at calibration, calibration adapts to as far as it can.
    let structural = !slots.iter().any(|s| s.role == Role::Target);
    let adapted = structural.then(|| NoiseFreeFit::new(robot, columns, &samples, laboratory.rest_rad_s));
    let mut achieved = vec![0.0_f64; robot.joints()];
    for ((k, ..), samples) in disturbed.iter().zip(&samples) {
        let with = adapted.as_ref().unwrap_or(calm).left_over(samples);
        let plain = Samples::new(&undisturbed.traces[*k], &undisturbed.instrument, window_s)?;
        let without = calm.left_over(&plain);
        for ((a, with), without) in achieved.iter_mut().zip(with).zip(without) {
            *a = a.max((with - without).max(0.0).sqrt());
        }
    }
    Ok((achieved, disturbed))
}
