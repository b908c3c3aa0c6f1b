//! Effects added to recordings: what is added is what the truth says, nowhere else, and nothing leaks.

#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]
use std::sync::Arc;

use aurt_lab::Strength;
use aurt_lab::case::{Case, CaseRequest, CaseType, NullPlan, Plan, World};
use aurt_lab::injected::{InjectedRequest, InjectedWorld};
use aurt_recording::{PreprocessOptions, Recording};
use aurt_simulation::inject::{
    Injection, Kind, Presence, RealExperiment, RealRecording, Split, Structure, injectable,
    unknown_injectable,
};
use aurt_simulation::{Logger, Motion, Scenario, robots, simulate};
use aurt_traits::MeasurementUnit;

/// A recording of a simulated robot stands for a real one.
fn injected() -> InjectedWorld {
    let robot = robots::ur10e();
    let recordings = (0..3)
        .map(|k| {
            let motion = Motion::MultiSine { duration_s: 10.0, harmonics: 6, top_hz: 0.8, share: 0.5 };
            let mut scenario = Scenario::new(robot.clone(), motion.plan(&robot, k).unwrap(), k);
            scenario.logger = Logger { rate_hz: 100.0, ..Logger::default() };
            let made = simulate(&scenario).unwrap();
            let n = made.joints;
            let by_joint = |all: &[f64], gain: &dyn Fn(usize) -> f64| -> Vec<Vec<f64>> {
                (0..n).map(|j| all.iter().skip(j).step_by(n).map(|v| gain(j) * v).collect()).collect()
            };
            let name = format!("recording {k}");
            let position = by_joint(&made.position_rad, &|_| 1.0);
            let torque = by_joint(&made.measurement, &|j| robot.drives[j].torque_constant_nm_per_a);
            let recording = Recording::from_arrays(made.time_s.clone(), position).unwrap().named(&name);
            let recording = recording.with_measurement(torque, MeasurementUnit::NewtonMetre).unwrap();
            RealRecording { name, recording }
        })
        .collect();
    let injection = Injection::new(RealExperiment {
        name: "stand_in".into(),
        mdh_csv: Some(robot.mdh_csv()),
        bodies: Arc::new(robot.chain().unwrap()),
        unit: MeasurementUnit::NewtonMetre,
        experiment_toml: "schema = 1\n\n[robot]\nmdh = \"mdh.csv\"\ngravity_m_s2 = [0.0, 0.0, -9.81]\n"
            .into(),
        options: PreprocessOptions::new(4.0),
        structure: Structure::of(&robot),
        recordings,
    })
    .unwrap();
    InjectedWorld { injection }
}

fn request(effect: &str) -> InjectedRequest {
    requested(effect, Strength::Medium)
}

fn requested(effect: &str, strength: Strength) -> InjectedRequest {
    let case = CaseRequest {
        robot: "stand_in".into(),
        case_type: CaseType::Single,
        effects: vec![effect.into()],
        strength,
    };
    InjectedRequest { case, roles: None }
}

fn columns(case: &Case, file: &str) -> Vec<Vec<f64>> {
    let (_, content) = case.files.iter().find(|(name, _)| name == file).unwrap();
    let text = std::str::from_utf8(content).unwrap();
    let rows: Vec<Vec<f64>> =
        text.lines().skip(1).map(|l| l.split(',').map(|c| c.parse().unwrap()).collect()).collect();
    (0..rows[0].len()).map(|c| rows.iter().map(|r| r[c]).collect()).collect()
}

#[test]
fn a_reference_is_the_recordings_as_they_are() {
    let world = injected();
    for name in world.references() {
        let case = world.reference(&name).unwrap();
        let split = world.splits().into_iter().find(|s| s.reference_name("stand_in") == name).unwrap();
        let order = [&split.calibration[..], &split.target, &split.validation].concat();
        for (place, k) in order.into_iter().enumerate() {
            let columns = columns(&case, &format!("recording_{}.csv", place + 1));
            let recording = &world.injection.recorded()[k].recording;
            assert_eq!(columns[0], recording.time_s);
            assert_eq!(columns[1..7], recording.position_rad[..]);
            assert_eq!(columns[7..13], recording.measurement.as_ref().unwrap()[..]);
        }
    }
    let text = world.reference("no_such").unwrap_err().to_string();
    assert!(text.contains("stand_in_changed_1"), "{text}");
}

/// The difference between a case and its reference is the torque of the effect that the truth states, in the recordings
/// that the truth says have it.
#[test]
fn what_was_added_is_what_the_truth_says() {
    let world = injected();
    for effect in injectable(MeasurementUnit::NewtonMetre).into_iter().chain(unknown_injectable()) {
        if effect == "dropped_samples" {
            continue;
        }
        for seed in 0..2 {
            let Ok(case) = world.make(&request(effect), seed, "case_0001") else { continue };
            let truth = &case.truth;
            assert_eq!(truth.world, World::Injected);
            let name = truth.reference.as_deref().unwrap();
            let reference = world.reference(name).unwrap();
            let added: aurt_simulation::inject::Added =
                serde_json::from_value(truth.effects[0].fields.clone()).unwrap();
            let split = world.splits().into_iter().find(|s| s.reference_name("stand_in") == name).unwrap();
            let order = [&split.calibration[..], &split.target, &split.validation].concat();
            for (place, k) in order.into_iter().enumerate() {
                let file = format!("recording_{}.csv", place + 1);
                let (with, mut without) = (columns(&case, &file), columns(&reference, &file));
                let recorded = &world.injection.recorded()[k];
                let measured = recorded.recording.measurement.as_ref().unwrap();
                let affected = match truth.effects[0].recording.as_deref() {
                    Some(only) => only == file,
                    None => split.presence == Presence::All || place >= split.calibration.len(),
                };
                let torque = added.torque(&recorded.scene, measured).unwrap();
                // Nothing late was measured before the recording began.
                let first = without[0].len() - with[0].len();
                let is_late = affected && effect == "time_delay";
                let begins_s = if is_late { added.size } else { 0.0 };
                assert_eq!(first, without[0].partition_point(|t| *t < without[0][0] + begins_s), "{effect}");
                without.iter_mut().for_each(|column| drop(column.drain(..first)));
                assert_eq!(with[..7], without[..7], "{effect}: stamps and positions");
                let mut largest = 0.0_f64;
                for j in 0..6 {
                    for (row, t) in torque[j][first..].iter().enumerate() {
                        let difference = with[7 + j][row] - without[7 + j][row];
                        let expected = if affected { *t } else { 0.0 };
                        assert!((difference - expected).abs() < 1e-9, "{effect} on joint {j}");
                        largest = largest.max(difference.abs());
                    }
                }
                assert!(affected || largest == 0.0, "{effect} in {file}");
                // These act where a joint comes to, which may be in none of a recording's places.
                let local = ["saturation", "sticking_window"].contains(&effect);
                assert!(local || !affected || largest > 0.0, "{effect} in {file}");
            }
        }
    }
}

/// Coulomb friction in words of its own: a step of twice the stated size wherever the joint reverses.
#[test]
fn coulomb_friction_is_a_square_wave_of_the_stated_size() {
    let world = injected();
    let case = world.make(&request("coulomb"), 3, "case_0001").unwrap();
    let effect = &case.truth.effects[0];
    let reference = world.reference(case.truth.reference.as_deref().unwrap()).unwrap();
    let (joint, size) = (effect.joints[0], effect.parameters[0].1[0]);
    assert_eq!(effect.parameters[0].0, "coulomb_nm");
    // More friction than at calibration may also be called a change of its level.
    assert_eq!(case.truth.background[0].effect, "friction_level_changed");
    let (with, without) = (columns(&case, "recording_2.csv"), columns(&reference, "recording_2.csv"));
    let mut fast = 0;
    for row in 1..with[0].len() - 1 {
        let speed =
            (with[1 + joint][row + 1] - with[1 + joint][row - 1]) / (with[0][row + 1] - with[0][row - 1]);
        if speed.abs() > 0.1 {
            fast += 1;
            let difference = with[7 + joint][row] - without[7 + joint][row];
            assert!((difference - size * speed.signum()).abs() < 1e-9, "{difference} {size} {speed}");
        }
    }
    assert!(fast > 100);
}

#[test]
fn strengths_are_those_that_were_asked_for() {
    let world = injected();
    for (strength, wanted) in [(Strength::Weak, 0.7), (Strength::Medium, 1.5), (Strength::Strong, 4.0)] {
        for effect in ["stribeck", "payload", "rotor_inertia", "time_delay"] {
            let Ok(case) = world.make(&requested(effect, strength), 5, "case_0001") else { continue };
            let strongest = case.truth.effects[0].achieved.iter().copied().fold(0.0, f64::max);
            assert!((strongest / wanted - 1.0).abs() < 0.25, "{effect}: {strongest} of {wanted}");
        }
    }
}

#[test]
fn the_truth_is_not_in_the_case_folder_and_seeds_decide() {
    let world = injected();
    let make = |seed| world.make(&request("spring"), seed, "case_0001").unwrap();
    let case = make(7);
    let names: Vec<&str> = case.files.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        ["experiment.toml", "mdh.csv", "recording_1.csv", "recording_2.csv", "recording_3.csv"]
    );
    for (name, content) in &case.files {
        let text = std::str::from_utf8(content).unwrap();
        for word in ["spring", "stiffness", "injected", "stand_in", "reference", "seed"] {
            assert!(!text.contains(word), "{word} in {name}");
        }
    }
    assert_eq!(make(7).files, case.files);
    assert_ne!(make(8).truth.effects[0].fields, case.truth.effects[0].fields);
}

#[test]
fn nulls_are_distinct_and_in_other_roles_than_their_references() {
    let world = injected();
    let plan = |count| Plan { nulls: Some(NullPlan { count, ..NullPlan::default() }), ..Plan::default() };
    assert_eq!(world.requests(&plan(4), 1).unwrap().len(), 4);
    assert_eq!(world.missing_nulls(&plan(6)), None);
    let line = world.missing_nulls(&plan(7)).unwrap();
    assert!(line.starts_with("stand_in: 6 nulls instead of 7: 3 recordings"), "{line}");
    let requests = world.requests(&plan(7), 1).unwrap();
    assert_ne!(requests, world.requests(&plan(7), 2).unwrap(), "seeds decide on the order");
    let nulls: Vec<Case> = requests.iter().map(|r| world.make(r, 5, "case_0001").unwrap()).collect();
    for (k, null) in nulls.iter().enumerate() {
        assert!(!nulls[..k].iter().any(|other| other.files == null.files));
        let reference = null.truth.reference.as_deref().unwrap();
        assert!(reference.starts_with("stand_in_changed_"), "changes against changes");
        assert_ne!(world.reference(reference).unwrap().files, null.files);
        let experiment = std::str::from_utf8(&null.files[0].1).unwrap();
        assert!(experiment.contains("\ntarget = "), "{experiment}");
    }
    assert_eq!(nulls.len(), 6);
}

#[test]
fn what_cannot_be_added_is_refused_with_what_can() {
    let world = injected();
    let text = world.make(&request("sprign"), 1, "case_0001").unwrap_err().to_string();
    assert!(text.contains("sprign") && text.contains("spring"), "{text}");
    assert!(Kind::named("backlash").unwrap_err().to_string().contains("known are coulomb"));
    let one = RealExperiment {
        recordings: world.injection.real().recordings[..1].to_vec(),
        ..world.injection.real().clone()
    };
    let one = InjectedWorld { injection: Injection::new(one).unwrap() };
    assert!(Split::all(1, Presence::Changed).is_empty());
    let text = one.make(&request("payload"), 1, "case_0001").unwrap_err().to_string();
    assert!(text.contains("needs two recordings"), "{text}");
    let mut odd = world.injection.real().clone();
    odd.recordings[0].recording.position_rad.pop();
    let text = Injection::new(odd).unwrap_err().to_string();
    assert!(text.contains("recording 0: joints: expected 6, got 5"), "{text}");
}
