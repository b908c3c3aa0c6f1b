//! The physics that an experiment neglects: in every recording, below the weakest effect.

use std::sync::Arc;

use serde_json::Value;

use super::super::laboratory::Laboratory;
use super::super::layout::{Role, Slot};
use super::super::truth::TrueEffect;
use crate::effects::{Lacks, PRESLIDING_RAD, Undeclared, kind};
use crate::fit::{NoiseFreeFit, Samples, without_absorbed_rotors};
use crate::strength::Strength;
use aurt_simulation::effects::{BristleModel, Effect, Factor};
use aurt_simulation::inject::{Structure, StructureColumns};
use aurt_simulation::robots::Robot;
use aurt_simulation::{Random, SimulationError};

/// Torque that the experiment neglects on a joint, beyond what its structure absorbs, over the noise that strengths are
/// measured in: smallest and largest. A weak effect has 0.3; what is neglected is to be a sixth to five sixths of it.
const LEVEL: (f64, f64) = (0.05, 0.25);
/// How near to its level a joint's neglected torque has to come, as a factor.
const MET: f64 = 1.5;
const CORRECTIONS: usize = 2;
/// Share of laboratories whose arms have a lack of each kind: cubic viscous friction, Stribeck, load dependence,
/// presliding, warming. Presliding is what careful measurements of gears always find, the others often.
const SHARES: [f64; 5] = [0.6, 0.5, 0.5, 0.8, 0.6];

/// Draws what the experiment neglects and brings it to its level on each joint.
pub(in crate::case) fn neglect(
    laboratory: &mut Laboratory,
    robot: &Robot,
    slots: &[Slot],
    random: &mut Random,
) -> Result<(), SimulationError> {
    let calibration: Vec<&Slot> = slots.iter().filter(|s| s.role == Role::Calibration).collect();
    let shortest_s = slots.iter().map(|s| s.trajectory.duration_s()).fold(f64::INFINITY, f64::min);
    let least_rad = least_presliding_rad(robot)?;
    let wanted: Vec<f64> = robot.drives.iter().map(|_| random.between_logs(LEVEL.0, LEVEL.1)).collect();
    let mut undeclared = drawn(robot, &wanted, shortest_s, random);
    let structure = without_absorbed_rotors(Structure::of(robot), robot)?;
    let columns = Arc::new(StructureColumns::of_robot(robot, &structure)?);
    for correction in 0..=CORRECTIONS {
        stay_soft(&mut undeclared, &least_rad);
        laboratory.undeclared = Some(undeclared.clone());
        let levels = levels(laboratory, robot, &columns, &calibration)?;
        let factors: Vec<f64> = levels.iter().zip(&wanted).map(|(l, w)| correction_of(*l, *w)).collect();
        if factors.iter().all(|f| *f == 1.0) {
            return Ok(());
        }
        // After the last correction only what stands out still falls.
        let last = correction == CORRECTIONS;
        let mut others = vec![1.0; robot.joints()];
        for (j, lacks) in undeclared.lacks.iter_mut().enumerate() {
            let factor = if last && levels[j] <= LEVEL.1 { 1.0 } else { factors[j] };
            if factor < 1.0 && lacks.presliding_rad > 0.0 {
                // Presliding is the usual excess. Its torque grows as the root of its length, and where the length would
                // be too short there is none; the joint's other lacks remain.
                let shorter_rad = lacks.presliding_rad * factor * factor;
                let gone = last || shorter_rad < least_rad[j];
                lacks.presliding_rad = if gone { 0.0 } else { shorter_rad };
            } else {
                others[j] = factor;
            }
        }
        undeclared.scale(Factor::PerJoint(&others), robot);
    }
    stay_soft(&mut undeclared, &least_rad);
    laboratory.undeclared = Some(undeclared);
    Ok(())
}

/// The factor that brings a level to the wanted one; 1 if it is near enough.
fn correction_of(level: f64, wanted: f64) -> f64 {
    let factor = wanted / level.max(1e-9);
    if (1.0 / MET..=MET).contains(&factor) { 1.0 } else { factor.clamp(0.05, 20.0) }
}

/// Fastest rate that presliding may give a shaft, 1/s: servos and reversals stay below, and an integration that follows
/// it takes steps of 1 ms.
const STIFFEST_PER_S: f64 = 600.0;

/// The shortest presliding of each joint that is not stiffer than that, rad: the steepest of the bristles' laws begins with
/// 4 F_C / distance.
fn least_presliding_rad(robot: &Robot) -> Result<Vec<f64>, SimulationError> {
    let inertia = robot.link_inertia_kg_m2()?;
    let drives = robot.drives.iter().zip(inertia);
    Ok(drives
        .map(|(d, link)| {
            let softest = STIFFEST_PER_S.powi(2) * (d.rotor_inertia_kg_m2 + link).max(1e-9);
            (4.0 * d.coulomb_nm / softest).max(PRESLIDING_RAD[0])
        })
        .collect())
}

fn stay_soft(undeclared: &mut Undeclared, least_rad: &[f64]) {
    for (lacks, least) in undeclared.lacks.iter_mut().zip(least_rad) {
        if lacks.presliding_rad > 0.0 {
            lacks.presliding_rad = lacks.presliding_rad.max(*least);
        }
    }
}

/// Lacks of about the wanted levels, as far as that can be said beforehand: by the sizes at which the effects of the
/// same names are of medium strength.
fn drawn(robot: &Robot, wanted: &[f64], shortest_s: f64, random: &mut Random) -> Undeclared {
    let mut present = SHARES.map(|share| random.chance(share));
    present[3] |= !present.contains(&true);
    let [cubic, stribeck, load, presliding, warming] = present;
    let lacks = robot
        .drives
        .iter()
        .zip(wanted)
        .map(|(drive, wanted)| {
            let noise = wanted * drive.torque_noise_nm;
            let mut part = || random.between(0.3, 1.0);
            let [a, b, c, d, e] = [part(), part(), part(), part(), part()];
            let here = |present: bool, size: f64| if present { size } else { 0.0 };
            let sign = random.sign();
            let shape = [random.between_logs(0.01, 0.15), random.between(0.5, 2.0)];
            let length_rad = random.between_logs(0.0005, 0.01);
            Lacks {
                cubic_nm: here(cubic, sign * 3.0 * a * noise),
                stribeck_nm: here(stribeck, 3.0 * b * noise),
                stribeck_shape: shape,
                load_coefficient: here(
                    load && drive.load_coefficient == 0.0,
                    (c * noise / (0.15 * drive.torque_limit_nm)).min(0.1),
                ),
                presliding_rad: here(presliding, d * length_rad),
                fall_per_k: here(warming, 0.03 * e * wanted),
            }
        })
        .collect();
    let bristles = [BristleModel::Lugre, BristleModel::Gms, BristleModel::Masing][random.index(3)];
    let quick_s = shortest_s * random.between(0.2, 2.0);
    Undeclared { lacks, bristles, time_constants_s: [quick_s, quick_s * random.between(2.0, 15.0)] }
}

/// What the structure leaves of the calibration recordings without noise, over noise, per joint: in the recording that
/// shows most of it.
fn levels(
    laboratory: &Laboratory,
    robot: &Robot,
    columns: &Arc<StructureColumns>,
    calibration: &[&Slot],
) -> Result<Vec<f64>, SimulationError> {
    let samples = calibration
        .iter()
        .map(|slot| {
            let traces = laboratory.trace(robot, slot)?;
            // The ripple of the drives is the sensors' and no part of the traces.
            Samples::new(&traces, &laboratory.instrument, None)
        })
        .collect::<Result<Vec<_>, _>>()?;
    let fit = NoiseFreeFit::new(robot, columns, &samples, laboratory.rest_rad_s);
    let mut levels = vec![0.0_f64; robot.joints()];
    for samples in &samples {
        for (level, left) in levels.iter_mut().zip(fit.left_over(samples)) {
            *level = level.max(left.sqrt());
        }
    }
    Ok(levels)
}

/// What the experiment neglects, for the sealed truth; `level` is that of all of it together, per joint.
pub(in crate::case) fn background(
    laboratory: &Laboratory,
    level: &[f64],
) -> Result<Vec<TrueEffect>, SimulationError> {
    let mut effects = Vec::new();
    let mut add = |identifier: &str, joints: Vec<usize>, parameters: Vec<(&str, Vec<f64>)>, fields: Value| {
        let kind = kind(identifier)?;
        effects.push(TrueEffect {
            effect: identifier.to_owned(),
            family: kind.family,
            in_vocabulary: true,
            achieved: (0..level.len()).map(|j| if joints.contains(&j) { level[j] } else { 0.0 }).collect(),
            joints,
            present_in: vec!["calibration".to_owned(), "target".to_owned()],
            recording: None,
            window_s: None,
            parameters: parameters.into_iter().map(|(name, values)| (name.to_owned(), values)).collect(),
            fields,
        });
        Ok::<(), SimulationError>(())
    };
    if let Some(undeclared) = &laboratory.undeclared {
        for lack in undeclared.by_name() {
            add(lack.identifier, lack.joints, vec![(lack.parameter, lack.values)], undeclared.fields())?;
        }
    }
    let channels = &laboratory.instrument.channels;
    let rippled: Vec<usize> =
        (0..channels.len()).filter(|j| channels[*j].ripple.amplitude_nm > 0.0).collect();
    if !rippled.is_empty() {
        let of = |value: fn(&aurt_simulation::sensors::DriveRipple) -> f64| -> Vec<f64> {
            rippled.iter().map(|j| value(&channels[*j].ripple)).collect()
        };
        let parameters = vec![("order", of(|r| r.order)), ("amplitude_nm", of(|r| r.amplitude_nm))];
        add("torque_ripple", rippled.clone(), parameters, Value::Null)?;
    }
    let lost = laboratory.logger.faults.missing_share;
    if lost > 0.0 {
        let parameters = vec![("share", vec![lost])];
        add("dropped_samples", (0..level.len()).collect(), parameters, Value::Null)?;
    }
    Ok(effects)
}

// What is neglected is weaker than the weakest effect.
const _: () = assert!(LEVEL.1 < Strength::Weak.over_noise());
