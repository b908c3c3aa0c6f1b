//! Friction that brakes: at every speed and load that calibration covered.

use aurt_traits::{ArmSeries, ColumnGroup, Columns, Invariant, JointSeries, ModelError, Motion, RobotModel};

use super::fitted::{Estimated, Fitted};
use crate::JointRange;

/// Speeds that are tried, as shares of the largest that calibration covered.
const SPEEDS: [f64; 4] = [0.1, 0.3, 0.6, 1.0];
/// A share at which viscous friction is next to nothing.
const SLOW: f64 = 0.01;
/// Loads that are tried, as shares of the largest.
const LOADS: [f64; 3] = [0.0, 0.5, 1.0];
/// What has memory has forgotten the start after this way, in rad, in this many samples.
const WAY_RAD: f64 = 1.0;
const SAMPLES: usize = 129;

/// A state of motion in which a joint's friction drives it.
struct Driven {
    joint: usize,
    torque: Estimated,
    speed_rad_s: f64,
    load: f64,
}

pub(super) fn warnings(fitted: &Fitted<'_>) -> Vec<String> {
    // A model that cannot be evaluated at steady speed has said so before; here it makes no claim.
    let driven: Vec<Driven> =
        (0..fitted.model.joints()).filter_map(|j| worst(fitted, j).ok().flatten()).collect();
    if driven.is_empty() {
        return Vec::new();
    }
    let (unit, names) = (fitted.unit_of_measurement.symbol(), fitted.model.names());
    let listed: Vec<String> = driven
        .iter()
        .map(|d| {
            let load = if d.load == 0.0 { String::new() } else { format!(" under {:.2} {unit}", d.load) };
            format!("{} ({} {unit} at {:.2} rad/s{load})", names.joint(d.joint), d.torque, d.speed_rad_s)
        })
        .collect();
    vec![format!(
        "unphysical: within the speeds and loads of the calibration, friction accelerates instead of braking: {}. The friction \
         model has more parameters than these motions determine (use fewer powers or constant Coulomb friction), or it \
         compensates for a missing effect; if all friction of a joint is negative, the sign of its measurement is wrong \
         (`[instrument] gains`)",
        listed.join(", ")
    )]
}

/// The state in which friction contradicts physics most clearly, if it does.
fn worst(fitted: &Fitted<'_>, joint: usize) -> Result<Option<Driven>, ModelError> {
    let (model, range) = (fitted.model, &fitted.ranges[joint]);
    if range.velocity_rad_s <= fitted.options.rest_velocity(&**model.rigid_body(), joint) {
        return Ok(None);
    }
    let loads = loads(model, joint, range);
    let mut worst: Option<Driven> = None;
    for speed in SPEEDS.map(|s| s * range.velocity_rad_s) {
        for load in loads.iter().copied() {
            let braking = braking(model, joint, speed, load)?;
            let torque = fitted.estimated(0..braking.len(), &braking);
            let clearer = |w: &Driven| torque.value / torque.std < w.torque.value / w.torque.std;
            if torque.is_negative() && worst.as_ref().is_none_or(clearer) {
                worst = Some(Driven { joint, torque, speed_rad_s: speed, load });
            }
        }
    }
    Ok(worst)
}

fn loads(model: &RobotModel, joint: usize, range: &JointRange) -> Vec<f64> {
    let stack = &model.stacks()[joint];
    let loaded =
        stack.coulomb().reads_load() || stack.hysteresis().reads_load() || stack.viscous().reads_load();
    let shares: &[f64] = if loaded && range.load_torque.is_some() { &LOADS } else { &LOADS[..1] };
    shares.iter().map(|l| l * range.load_torque.unwrap_or(0.0)).collect()
}

/// The braking torque of a joint, column by column, at the speeds and loads that calibration covered, slow motion
/// included; nothing for a joint that rested.
pub(crate) fn braking_rows(
    model: &RobotModel,
    joint: usize,
    range: &JointRange,
    rest_velocity: f64,
) -> Result<Vec<Vec<f64>>, ModelError> {
    let mut rows = Vec::new();
    if range.velocity_rad_s > rest_velocity {
        for load in loads(model, joint, range) {
            for share in std::iter::once(SLOW).chain(SPEEDS) {
                rows.push(braking(model, joint, share * range.velocity_rad_s, load)?);
            }
        }
    }
    Ok(rows)
}

/// What of a joint's torque brakes, column by column, at a steady speed in rad/s under a load: halved difference of both
/// directions, in which offsets, springs and ripple fall out.
pub(crate) fn braking(
    model: &RobotModel,
    joint: usize,
    speed: f64,
    load: f64,
) -> Result<Vec<f64>, ModelError> {
    let forth = columns(model, joint, speed, load)?;
    let back = columns(model, joint, -speed, load)?;
    Ok(forth.iter().zip(&back).map(|(f, b)| 0.5 * (f - b)).collect())
}

/// The columns of friction in a joint's row, while it alone moves at a steady speed and has arrived at zero.
fn columns(model: &RobotModel, joint: usize, speed: f64, load: f64) -> Result<Vec<f64>, ModelError> {
    let stack = &model.stacks()[joint];
    let memoryless =
        [stack.coulomb().invariants(), stack.hysteresis().invariants(), stack.viscous().invariants()]
            .iter()
            .all(|i| i.contains(Invariant::Memoryless))
            && model.arm_terms().iter().all(|t| t.invariants().contains(Invariant::Memoryless));
    let samples = if memoryless { 2 } else { SAMPLES };
    let (joints, step) = (model.joints(), WAY_RAD / (SAMPLES - 1) as f64);
    let time: Vec<f64> = (0..samples).map(|k| k as f64 * step / speed.abs()).collect();
    let mut position = vec![0.0; joints * samples];
    let mut velocity = vec![0.0; joints * samples];
    let own = joint * samples..(joint + 1) * samples;
    for (k, q) in position[own.clone()].iter_mut().enumerate() {
        *q = speed.signum() * (k as f64 - (samples - 1) as f64) * step;
    }
    velocity[own.clone()].fill(speed);
    let motion = Motion::new(joints, time, position, velocity, vec![0.0; joints * samples])?;
    let view = motion.view();
    let mut loads = vec![0.0; joints * samples];
    loads[own].fill(load);

    let mut found = vec![0.0; model.parameters().len()];
    let series = JointSeries::of(view, joint, &loads[joint * samples..(joint + 1) * samples]);
    let range = model.group(ColumnGroup::JointDynamics(joint));
    let mut data = vec![0.0; range.len() * samples];
    let mut state = stack.initial_state(&series.slice(0..1));
    stack.evaluate(&series, &mut state, &mut Columns::new(&mut data, range.len(), samples, samples))?;
    for (k, column) in range.enumerate() {
        found[column] = data[(k + 1) * samples - 1];
    }
    let arm = ArmSeries {
        motion: view,
        load_torque: &loads,
        load_stride: samples,
        rigid_body: &**model.rigid_body(),
    };
    for (k, term) in model.arm_terms().iter().enumerate().filter(|(_, t)| !t.is_load()) {
        let range = model.group(ColumnGroup::ArmTerm(k));
        let acting = term.joints(joints);
        let Some(place) = acting.iter().position(|j| *j == joint) else { continue };
        let count = acting.len() * range.len();
        let mut data = vec![0.0; count * samples];
        let mut state = term.initial_state(&ArmSeries { motion: view.slice(0..1), ..arm });
        term.evaluate(&arm, &mut state, &mut Columns::new(&mut data, count, samples, samples))?;
        for (i, column) in range.clone().enumerate() {
            if term.acts_on(i, joint, joints) {
                found[column] = data[(place * range.len() + i + 1) * samples - 1];
            }
        }
    }
    Ok(found)
}
