use std::rc::Rc;

use aurt_recording::Preprocessed;

use super::experiment::{self, file_name};
use super::laboratory::Laboratory;
use super::layout::{RecordingSettings, Role, Slot, slots};
use super::probe::{Bench, Probed, bring_to_strength};
use super::request::{CaseRequest, CaseType};
use super::rough;
use super::truth::{TrueEffect, Truth, ValidationFloor};
use super::world::World;
use crate::effects::read_effect;
use crate::fit::processed_motion;
use aurt_simulation::effects::{Draw, Effect, EffectKind, Hidden, catalogue};
use aurt_simulation::inject::{OwnModel, mean_square};
use aurt_simulation::robots::Robot;
use aurt_simulation::sensors::SimulatedRecording;
use aurt_simulation::{Random, SimulationError, simulate};

/// A case: the files that a diagnosis may see, and the truth.
#[derive(Debug, Clone)]
pub struct Case {
    pub name: String,
    /// Names and contents of the files in the folder.
    pub files: Vec<(String, Vec<u8>)>,
    pub truth: Truth,
}

/// Share of the wanted strength with which an attempt is good enough.
const GOOD_ENOUGH: f64 = 0.7;
/// Share of the strongest joint's error from which a joint counts as one whose error a whole-arm effect makes,
/// and the least such error over noise.
const CONCERNED: (f64, f64) = (0.2, 0.1);

/// Makes one case of a world from its seed; the rough world's recordings have lengths and rates of their own.
pub fn make_case(
    world: World,

    name: &str,
    request: &CaseRequest,
    settings: &RecordingSettings,
    seed: u64,
) -> Result<Case, SimulationError> {
    let kinds = request.kinds()?;
    let mut random = Random::labelled(seed, "case");
    let rotors = CaseRequest::rotors(&kinds, &mut random);
    let later = CaseRequest::later(&kinds, &mut random);
    let robot = Robot::named(&request.robot)?.with_rotors(rotors);
    if !CaseRequest::is_possible(&robot, &kinds) {
        return Err(SimulationError::unreadable(
            name,
            format!("{} cannot have {} at once", request.robot, request.effects.join(" and ")),
        ));
    }
    let (robot, laboratory, slots) = match world {
        World::Clean => {
            let slots = slots(&robot, later, settings, &mut random)?;
            let laboratory = Laboratory::clean(&robot, settings);
            (robot, laboratory, slots)
        }
        World::Rough => rough::prepare(robot, later, seed)?,
        World::Mujoco | World::Injected | World::Servo => {
            return Err(SimulationError::unreadable(
                name,
                format!("cases of the world `{}` are not made by this simulator", world.name()),
            ));
        }
    };
    let laboratory = Rc::new(laboratory);
    let (bench, probed) = choose(&robot, &kinds, &slots, &laboratory, request, seed)?;
    let recordings =
        (0..slots.len()).map(|k| recording(&bench, &probed, &slots, k)).collect::<Result<Vec<_>, _>>()?;
    let text = experiment::text(&bench.robot, &bench.structure, &slots, laboratory.f_dyn_hz);
    let mut files = vec![
        ("experiment.toml".to_owned(), text.into_bytes()),
        ("mdh.csv".to_owned(), bench.robot.mdh_csv().into_bytes()),
    ];
    files.extend(recordings.iter().enumerate().map(|(k, r)| (file_name(k), r.csv())));
    let truth = Truth {
        case: name.to_owned(),
        world,
        seed,
        robot: request.robot.clone(),
        rotors,
        case_type: request.case_type,
        strength: request.strength,
        effects: kinds
            .iter()
            .zip(&probed)
            .map(|(kind, p)| true_effect(kind, p, &bench.robot, &slots, later))
            .collect(),
        background: rough::background(&laboratory, &bench.neglected(&slots)?)?,
        reference: None,
        noise_nm: bench.robot.drives.iter().map(|d| d.torque_noise_nm).collect(),
        validation: floors(&bench, &slots, &recordings)?,
    };
    Ok(Case { name: name.to_owned(), files, truth })
}

/// Whether an effect acts in a slot: those with a window are in the first target alone.
fn acts_in(slots: &[Slot], slot: usize, effect: &dyn Effect) -> bool {
    effect.window_s().is_none() || slots.iter().position(|s| s.role == Role::Target) == Some(slot)
}

/// What the logger writes in a slot; what has been simulated already is not simulated again.
fn recording(
    bench: &Bench,
    probed: &[Probed],
    slots: &[Slot],
    k: usize,
) -> Result<SimulatedRecording, SimulationError> {
    let slot = &slots[k];
    let here: Vec<&Probed> =
        probed.iter().filter(|p| slot.affected && acts_in(slots, k, &*p.effect)).collect();
    let (unit, logger) = (bench.robot.unit, &bench.laboratory.logger);
    match here.as_slice() {
        [] => logger.record(&bench.undisturbed.traces[k], &bench.undisturbed.instrument, unit, slot.seed),
        [one] if one.disturbed.iter().any(|(slot, ..)| *slot == k) => one
            .disturbed
            .iter()
            .filter(|(slot, ..)| *slot == k)
            .map(|(_, traces, instrument)| logger.record(traces, instrument, unit, slot.seed))
            .next_back()
            .unwrap_or_else(|| Err(SimulationError::value("recording", k as f64, "it was not probed"))),
        several => {
            let effects = several
                .iter()
                .map(|p| read_effect(p.effect.identifier(), p.effect.fields()))
                .collect::<Result<Vec<_>, _>>()?;
            simulate(&bench.laboratory.scenario(&bench.robot, slot, effects))
        }
    }
}

/// Effects on joints and of sizes that have the wanted strength; the best of a few attempts.
fn choose(
    robot: &Robot,
    kinds: &[&EffectKind],
    slots: &[Slot],
    laboratory: &Rc<Laboratory>,
    request: &CaseRequest,
    seed: u64,
) -> Result<(Rc<Bench>, Vec<Probed>), SimulationError> {
    let plain = Rc::new(bench(robot, &[], slots, laboratory)?);
    if kinds.is_empty() {
        return Ok((plain, Vec::new()));
    }
    let peak_torque_nm = plain.undisturbed.peak_torque_nm(robot.joints());
    let duration_s = slots.iter().map(|s| s.trajectory.duration_s()).fold(f64::INFINITY, f64::min);
    let mut best: Option<(f64, Rc<Bench>, Vec<Probed>)> = None;
    let mut refusal = None;
    for attempt in 0..laboratory.effort.1 {
        let mut random = Random::labelled(seed, &format!("attempt {attempt}"));
        let mut effects = Vec::new();
        for kind in kinds {
            let joints = kind.choose_joints(robot, &mut random);
            let draw = Draw {
                robot,
                joints: &joints,
                peak_torque_nm: &peak_torque_nm,
                duration_s,
                shapes: laboratory.shapes,
            };
            effects.push(kind.draw(&draw, &mut random));
        }
        if overlap(&effects) {
            continue;
        }
        let hides = effects.iter().any(|e| e.hidden() != Hidden::Nothing);
        let bench = if hides {
            bench(robot, &effects, slots, laboratory).map(Rc::new)
        } else {
            Ok(Rc::clone(&plain))
        };
        let probed = bench.and_then(|bench| {
            let probed = kinds
                .iter()
                .zip(effects)
                .map(|(kind, effect)| bring_to_strength(&bench, slots, kind, effect, request.strength))
                .collect::<Result<Vec<_>, _>>()?;
            Ok((bench, probed))
        });
        match probed {
            Ok((bench, probed)) => {
                // 1 where every effect is as strong as wanted, less where one is weaker or stronger.
                let wanted = request.strength.over_noise();
                let reached = kinds
                    .iter()
                    .zip(&probed)
                    .flat_map(|(kind, p)| p.own_joints(kind))
                    .map(|s| (s / wanted).min(wanted / s.max(1e-9)))
                    .fold(f64::INFINITY, f64::min);
                if best.as_ref().is_none_or(|(before, ..)| reached > *before) {
                    best = Some((reached, bench, probed));
                }
                if reached >= GOOD_ENOUGH {
                    break;
                }
            }
            Err(error) => refusal = Some(error),
        }
    }
    match (best, refusal) {
        (Some((_, bench, probed)), _) => Ok((bench, probed)),
        (None, Some(error)) => Err(error),
        (None, None) => Err(SimulationError::unreadable(
            request.effects.join(" and "),
            "no joints were found on which the effects do not overlap",
        )),
    }
}

/// Whether two effects that name joints name the same one.
fn overlap(effects: &[Box<dyn Effect>]) -> bool {
    let all =
        |e: &dyn Effect| e.joints().is_empty() || e.parameters().iter().any(|(name, _)| *name == "link");
    effects.iter().enumerate().any(|(i, a)| {
        effects[..i]
            .iter()
            .any(|b| !all(&**a) && !all(&**b) && a.joints().iter().any(|joint| b.joints().contains(joint)))
    })
}

/// The robot as the experiment knows it: without the friction that effects stand for.
fn bench(
    robot: &Robot,
    effects: &[Box<dyn Effect>],
    slots: &[Slot],
    laboratory: &Rc<Laboratory>,
) -> Result<Bench, SimulationError> {
    let whole = robot;
    let mut robot = robot.clone();
    for effect in effects {
        for joint in effect.joints() {
            let Some(drive) = robot.drives.get_mut(joint) else { continue };
            match effect.hidden() {
                Hidden::Nothing => {}
                Hidden::Coulomb => drive.coulomb_nm = 0.0,
                Hidden::Viscous => drive.viscous_nm_s = 0.0,
            }
        }
    }
    Bench::new(robot, whole, slots, laboratory)
}

fn true_effect(kind: &EffectKind, probed: &Probed, robot: &Robot, slots: &[Slot], later: bool) -> TrueEffect {
    let effect = &probed.effect;
    let threshold = (CONCERNED.0 * probed.strongest(kind)).max(CONCERNED.1);
    let mut joints = if kind.whole_arm() {
        (0..robot.joints()).filter(|j| probed.achieved[*j] >= threshold).collect()
    } else {
        effect.joints()
    };
    joints.sort_unstable();
    let recording =
        effect.window_s().and_then(|_| slots.iter().position(|s| s.role == Role::Target)).map(file_name);
    TrueEffect {
        effect: kind.identifier.to_owned(),
        family: kind.family,
        in_vocabulary: catalogue().iter().any(|k| k.identifier == kind.identifier),
        joints,
        present_in: vec![if later { "target" } else { "calibration" }.to_owned()],
        recording,
        window_s: effect.window_s(),
        parameters: effect.parameters().into_iter().map(|(name, v)| (name.to_owned(), v)).collect(),
        achieved: probed.achieved.clone(),
        fields: effect.fields(),
    }
}

/// What the structure leaves of the held-out recordings, with the effects and without them.
fn floors(
    bench: &Bench,
    slots: &[Slot],
    recordings: &[SimulatedRecording],
) -> Result<Vec<ValidationFloor>, SimulationError> {
    let calm = bench
        .undisturbed
        .traces
        .iter()
        .zip(slots)
        .map(|(traces, slot)| {
            let recording = bench.laboratory.logger.record(
                traces,
                &bench.undisturbed.instrument,
                bench.robot.unit,
                slot.seed,
            )?;
            processed_motion(&recording, &bench.robot, bench.laboratory.f_dyn_hz)
        })
        .collect::<Result<Vec<_>, _>>()?;
    // A recording with corrupt rows cannot be preprocessed as it is; what it shows is its rows, not torque.
    let stirred: Option<Vec<Preprocessed>> = recordings
        .iter()
        .map(|r| processed_motion(r, &bench.robot, bench.laboratory.f_dyn_hz).ok())
        .collect();
    let fitted = |data: &[Preprocessed]| {
        let calibration: Vec<&Preprocessed> =
            data.iter().zip(slots).filter(|(_, s)| s.role == Role::Calibration).map(|(d, _)| d).collect();
        OwnModel::of_columns((*bench.columns).clone(), &calibration)
    };
    let rms_nm = |fit: &OwnModel, data: &Preprocessed| -> Result<Vec<f64>, SimulationError> {
        Ok(fit.residuals(data)?.iter().map(|r| mean_square(r).sqrt()).collect())
    };
    let calm_fit = fitted(&calm)?;
    let stirred_fit = stirred.as_deref().map(fitted).transpose()?;
    (0..slots.len())
        .filter(|k| slots[*k].role == Role::Validation)
        .map(|k| {
            let floor_nm = rms_nm(&calm_fit, &calm[k])?;
            let before_nm = match (&stirred, &stirred_fit) {
                (Some(data), Some(fit)) => rms_nm(fit, &data[k])?,
                _ => floor_nm.clone(),
            };
            Ok(ValidationFloor { recording: file_name(k), before_nm, floor_nm })
        })
        .collect()
}

pub(super) fn case_type(effects: &[&EffectKind]) -> CaseType {
    let known = |kind: &&EffectKind| catalogue().iter().any(|k| k.identifier == kind.identifier);
    match effects {
        [] => CaseType::Null,
        all if !all.iter().all(known) => CaseType::UnknownEffect,
        [_] => CaseType::Single,
        _ => CaseType::Pair,
    }
}
