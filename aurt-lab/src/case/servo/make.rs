//! Cases of servo arms.

use std::fmt::Write as _;
use std::path::Path;

use aurt_simulation::robots::Rotors;
use aurt_simulation::{Motion, MotionLimits, Random, Robot, SimulationError};
use serde_json::json;

use super::arm::{GRAVITY_M_S2, ServoArm};
use super::effect::{EFFECTS, ServoEffect, factors};
use super::motion::{STREAM_S, commands};
use super::plant::{Recorded, simulate};
use crate::case::{Case, CaseRequest, CaseType, Plan, SinglePlan, TrueEffect, Truth, World};
use crate::strength::Strength;

/// Recordings to calibrate on, then to validate with, and the length of each in s.
const RECORDINGS: (usize, usize, f64) = (3, 4, 12.0);
/// The expected error of positions that experiments state, in rad.
const DEVIATION_RAD: f64 = 0.002;
const HALVINGS: usize = 8;
/// Share of experiments that give the gains of the servos instead of estimating them.
const GIVEN: f64 = 0.5;

/// Root mean square by which an effect of a strength moves the positions of some joint: multiples of [`DEVIATION_RAD`].
const fn wanted_rad(strength: Strength) -> f64 {
    DEVIATION_RAD
        * match strength {
            Strength::Weak => 1.5,
            Strength::Medium => 4.0,
            Strength::Strong => 10.0,
        }
}

/// The cases of a plan, which may name effects of this world alone, in an order that reveals nothing.
pub(crate) fn requests(plan: &Plan, seed: u64) -> Vec<CaseRequest> {
    let mut random = Random::labelled(seed, "servo plan");
    let named = |of: &SinglePlan, in_vocabulary: bool| -> Vec<&'static str> {
        let own = EFFECTS.iter().filter(|e| e.in_vocabulary == in_vocabulary).map(|e| e.id);
        own.filter(|id| of.effects.is_empty() || of.effects.iter().any(|name| name == id)).collect()
    };
    let request = |effects: &[&str], case_type: CaseType, strength: Strength| CaseRequest {
        robot: "servo_arm".into(),
        case_type,
        effects: effects.iter().map(|id| (*id).to_owned()).collect(),
        strength,
    };
    let mut all = Vec::new();
    let kinds =
        [(&plan.singles, true, CaseType::Single), (&plan.unknown_effects, false, CaseType::UnknownEffect)];
    for (of, in_vocabulary, case_type) in kinds {
        let Some(of) = of else { continue };
        for id in named(of, in_vocabulary) {
            let trials = of.strengths.iter().flat_map(|s| std::iter::repeat_n(*s, of.trials));
            all.extend(trials.map(|strength| request(&[id], case_type, strength)));
        }
    }
    if let Some(pairs) = &plan.pairs {
        let mut known = named(&SinglePlan { effects: pairs.effects.clone(), ..SinglePlan::default() }, true);
        for _ in 0..if known.len() < 2 { 0 } else { pairs.count } {
            random.shuffle(&mut known);
            all.push(request(&known[..2], CaseType::Pair, pairs.strength));
        }
    }
    let nulls = plan.nulls.as_ref().map_or(0, |n| n.count);
    all.extend((0..nulls).map(|_| request(&[], CaseType::Null, Strength::Medium)));
    random.shuffle(&mut all);
    all
}

/// An arm without the effects and with them.
struct Arms {
    effects: Vec<&'static ServoEffect>,
    /// Commands of each recording.
    streams: Vec<Vec<Vec<f64>>>,
    described: ServoArm,
    truth: ServoArm,
    /// Size and reached strength of each effect, rad by joint.
    reached: Vec<(f64, Vec<f64>)>,
}

pub(crate) fn make(name: &str, request: &CaseRequest, seed: u64) -> Result<Case, SimulationError> {
    let failed = |error: aurt_rbd::RbdError| SimulationError::unreadable(name, error.to_string());
    let mut random = Random::labelled(seed, "servo");
    let arms =
        Arms::draw(&effects(name, &request.effects)?, request.strength, &mut random).map_err(failed)?;
    // The draw is made in every case: what is given says nothing of what is concealed.
    let gains_given = random.chance(GIVEN) || request.effects.iter().any(|e| e == "torque_constant");
    let urdf = arms.described.urdf(&mut random);
    let mut files = vec![
        ("experiment.toml".to_owned(), experiment(&arms.described, gains_given).into_bytes()),
        ("robot.urdf".to_owned(), urdf.into_bytes()),
    ];
    for (k, streams) in arms.streams.iter().enumerate() {
        let recorded = simulate(&arms.truth, streams, random.bits()).map_err(failed)?;
        files.push((format!("recording_{}.csv", k + 1), table(&recorded)));
    }
    let truth = Truth {
        case: name.to_owned(),
        world: World::Servo,
        seed,
        robot: request.robot.clone(),
        rotors: Rotors::Geared,
        case_type: request.case_type,
        strength: request.strength,
        effects: arms
            .effects
            .iter()
            .zip(&arms.reached)
            .map(|(e, r)| true_effect(e, r, &arms.truth))
            .collect(),
        background: Vec::new(),
        reference: None,
        noise_nm: Vec::new(),
        validation: Vec::new(),
    };
    Ok(Case { name: name.to_owned(), files, truth })
}

/// Structures are those of the arm: which joints show them is not judged.
fn true_effect(effect: &ServoEffect, (size, reached): &(f64, Vec<f64>), arm: &ServoArm) -> TrueEffect {
    TrueEffect {
        effect: effect.id.to_owned(),
        family: effect.family,
        in_vocabulary: effect.in_vocabulary,
        joints: Vec::new(),
        present_in: vec!["calibration".to_owned()],
        recording: None,
        window_s: None,
        parameters: effect.parameters(arm),
        achieved: reached.iter().map(|r| r / DEVIATION_RAD).collect(),
        fields: json!({ "size": size }),
    }
}

impl Arms {
    /// Draws an arm and puts effects into it, each at the size that moves its positions as much as is wanted.
    fn draw(
        effects: &[&'static ServoEffect],
        strength: Strength,
        random: &mut Random,
    ) -> Result<Self, aurt_rbd::RbdError> {
        let mut described = ServoArm::draw(random);
        effects.iter().for_each(|e| e.without(&mut described));
        let streams: Vec<Vec<Vec<f64>>> = (0..RECORDINGS.0 + RECORDINGS.1)
            .map(|_| described.servos.iter().map(|_| commands(RECORDINGS.2, random)).collect())
            .collect();
        let (mut truth, mut reached) = (described.clone(), Vec::new());
        let still = simulate(&described, &streams[0], 0)?;
        for effect in effects {
            let factors = factors(described.servos.len(), random);
            let moved = |size: f64| -> Result<Vec<f64>, aurt_rbd::RbdError> {
                Ok(apart(&simulate(&effect.on(&described, size, &factors), &streams[0], 0)?, &still))
            };
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                let most = moved(effect.size(middle))?.into_iter().fold(0.0, f64::max);
                if most < wanted_rad(strength) { low = middle } else { high = middle }
            }
            let size = effect.size(0.5 * (low + high));
            truth = effect.on(&truth, size, &factors);
            reached.push((size, moved(size)?));
        }
        Ok(Self { effects: effects.to_vec(), streams, described, truth, reached })
    }
}

fn effects(name: &str, ids: &[String]) -> Result<Vec<&'static ServoEffect>, SimulationError> {
    let unknown = |id: &String| SimulationError::unreadable(name, format!("servo arms have no `{id}`"));
    ids.iter().map(|id| EFFECTS.iter().find(|e| e.id == *id).ok_or_else(|| unknown(id))).collect()
}

/// The recording of a motion by the arm of a case, as a table like those of the case.
pub(crate) fn record(truth: &Truth, motion: &Path, seed: u64) -> Result<Vec<u8>, SimulationError> {
    let failed = |error: aurt_rbd::RbdError| SimulationError::unreadable(&truth.case, error.to_string());
    let ids: Vec<String> = truth.effects.iter().map(|e| e.effect.clone()).collect();
    let mut random = Random::labelled(truth.seed, "servo");
    let arms = Arms::draw(&effects(&truth.case, &ids)?, truth.strength, &mut random).map_err(failed)?;
    let limits = MotionLimits { position_rad: [-1e9, 1e9], velocity_rad_s: 1e9, acceleration_rad_s2: 1e9 };
    let robot = Robot::of_limits("arm", &vec![limits; arms.truth.servos.len()]);
    let motion = Motion::Recorded { file: motion.to_owned() }.plan(&robot, seed)?;
    let mut streams = vec![Vec::new(); robot.joints()];
    motion.rows(1.0 / STREAM_S, |_, q, _, _| streams.iter_mut().zip(q).for_each(|(s, q)| s.push(*q)))?;
    Ok(table(&simulate(&arms.truth, &streams, seed).map_err(failed)?))
}

/// Root mean square of the difference of two recordings, rad by joint.
fn apart(a: &Recorded, b: &Recorded) -> Vec<f64> {
    let of = |(a, b): (&Vec<f64>, &Vec<f64>)| {
        (a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / a.len().max(1) as f64).sqrt()
    };
    a.true_rad.iter().zip(&b.true_rad).map(of).collect()
}

/// What a user writes of an arm: starts that are usual for such servos, gains given or estimated.
fn experiment(arm: &ServoArm, gains_given: bool) -> String {
    let joints = arm.servos.len();
    let has = |value: fn(&super::arm::Servo) -> f64| arm.servos.iter().any(|s| value(s) > 0.0);
    let mut estimate = vec!["back_emf_nm_s_per_rad", "rotor_inertia_kg_m2"];
    let mut given = "back_emf_nm_s_per_rad = 0.4\nrotor_inertia_kg_m2 = 0.01\n".to_owned();
    if gains_given {
        let gains: Vec<String> = arm.servos.iter().map(|s| format!("{:.3}", s.gain_nm_per_rad)).collect();
        let _ = writeln!(given, "gain_nm_per_rad = [{}]", gains.join(", "));
    } else {
        estimate.push("gain_nm_per_rad");
        given.push_str("gain_nm_per_rad = 11.0\n");
    }
    let delays = has(|s| s.delay_s);
    if delays {
        estimate.push("delay_s");
    }
    let _ = writeln!(given, "delay_s = {}", if delays { 0.02 } else { 0.0 });
    if has(|s| s.coulomb_nm) {
        estimate.push("coulomb_nm");
        given.push_str("coulomb_nm = 0.06\n");
    }
    let columns = format!(
        "columns = {{ time = 0, measurement = [1, {joints}], position = [{}, {}] }}",
        joints + 1,
        2 * joints
    );
    let files = |range: std::ops::RangeInclusive<usize>| -> String {
        range.map(|k| format!("    {{ file = \"recording_{k}.csv\", {columns} }},\n")).collect()
    };
    format!(
        "schema = 1\n\n[robot]\nurdf = \"robot.urdf\"\ngravity_m_s2 = {GRAVITY_M_S2:?}\n\n[drive]\nmodel = \"position_servo\"\n\
         estimate = {estimate:?}\nshared = {:?}\n{given}position_deviation_rad = {DEVIATION_RAD}\n\n[recordings]\n\
         calibration = [\n{}]\nvalidation = [\n{}]\n",
        if delays { vec!["delay_s"] } else { Vec::new() },
        files(1..=RECORDINGS.0),
        files(RECORDINGS.0 + 1..=RECORDINGS.0 + RECORDINGS.1),
    )
}

fn table(recorded: &Recorded) -> Vec<u8> {
    let mut text = "time".to_owned();
    for name in ["command", "position"] {
        (0..recorded.command_rad.len()).for_each(|j| text.push_str(&format!(",{name}_{j}")));
    }
    text.push('\n');
    for (k, time_s) in recorded.time_s.iter().enumerate() {
        let _ = write!(text, "{time_s:.5}");
        let all = recorded.command_rad.iter().chain(&recorded.position_rad);
        all.for_each(|series| text.push_str(&format!(",{:.6}", series[k])));
        text.push('\n');
    }
    text.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::leaks;

    fn request(effects: &[&str], case_type: CaseType) -> CaseRequest {
        let effects = effects.iter().map(|e| (*e).to_owned()).collect();
        CaseRequest { robot: "servo_arm".into(), case_type, effects, strength: Strength::Medium }
    }

    #[test]
    fn plans_ask_for_every_effect_at_every_strength() {
        let all = requests(
            &Plan::parse("[singles]\n[unknown_effects]\n[nulls]\ncount = 3", "plan.toml").unwrap(),
            5,
        );
        assert_eq!(all.len(), 3 * EFFECTS.len() + 3);
        let nameless = |r: &&CaseRequest| r.case_type == CaseType::UnknownEffect;
        assert!(all.iter().filter(nameless).all(|r| ["backlash", "supply_sag"].contains(&&*r.effects[0])));
        let pairs =
            Plan::parse("[singles]\neffects = [\"stribeck\"]\n[pairs]\ncount = 4", "plan.toml").unwrap();
        let all = requests(&pairs, 5);
        assert_eq!(all.iter().filter(|r| r.case_type == CaseType::Single).count(), 3);
        let mut two = all.iter().filter(|r| r.case_type == CaseType::Pair).map(|r| &r.effects);
        assert!(two.all(|e| e.len() == 2 && e[0] != e[1]));
    }

    #[test]
    fn a_case_is_read_has_its_strength_and_gives_nothing_away() {
        let folder = tempfile::tempdir().unwrap();
        let mut registry = aurt_plugins::Registry::linked().unwrap();
        for (k, effects) in
            [&["dead_band"][..], &["torque_constant"], &["supply_sag"], &[]].into_iter().enumerate()
        {
            let case_type = if effects.is_empty() { CaseType::Null } else { CaseType::Single };
            let name = Plan::case_name(k);
            let case = make(&name, &request(effects, case_type), 7_654_321).unwrap();
            case.write(folder.path(), folder.path()).unwrap();
            let own = folder.path().join(&name);
            assert_eq!(leaks(&own, &case.truth).unwrap(), Vec::<String>::new());
            let file = own.join("experiment.toml");
            let read = aurt_experiment::Experiment::read_with_drives(&file, &mut registry).unwrap();
            let drive = read.drive.unwrap();
            assert!((2..=4).contains(&drive.joints.len()));
            let is_estimated = drive.selection.estimate.iter().any(|e| e == "gain_nm_per_rad");
            assert!(!(is_estimated && effects == ["torque_constant"]), "a gain that is given wrong is given");
            for effect in &case.truth.effects {
                let most = effect.achieved.iter().fold(0.0_f64, |m, a| m.max(*a));
                assert!((most / (wanted_rad(Strength::Medium) / DEVIATION_RAD) - 1.0).abs() < 0.2, "{most}");
            }
        }
        let again = |seed| make("case_0001", &request(&["dead_band"], CaseType::Single), seed).unwrap().files;
        assert_eq!(again(3), again(3));
        assert_ne!(again(3), again(4));
        assert!(make("case_0001", &request(&["base_tilt"], CaseType::Single), 3).is_err());
    }

    /// Gravity, the servos' springs and dry friction balance at rest.
    #[test]
    fn arms_come_to_rest_where_torques_balance() {
        let arm = ServoArm::draw(&mut Random::new(9));
        let streams: Vec<Vec<f64>> = arm.servos.iter().map(|_| vec![0.1; 150]).collect();
        let recorded = simulate(&arm, &streams, 1).unwrap();
        let q: Vec<f64> = recorded.true_rad.iter().map(|q| q[q.len() - 1]).collect();
        let mut bias = vec![0.0; q.len()];
        arm.dynamics().unwrap().bias_torque(&q, &vec![0.0; q.len()], &mut bias);
        assert!(bias[1].abs() > 0.1, "gravity acts on the shoulder: {bias:?}");
        for (j, servo) in arm.servos.iter().enumerate() {
            let spring = servo.gain_nm_per_rad * (0.1 - q[j]);
            assert!((spring - bias[j]).abs() < servo.coulomb_nm + 0.02, "joint {j}: {spring} {}", bias[j]);
        }
    }
}
