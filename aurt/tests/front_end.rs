//! What a front end other than ours uses: robots of names and files, torques of whole motions, full diagnoses in memory.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::sync::Arc;

use aurt::friction::hysteresis::dahl::Dahl;
use aurt::prelude::*;
use aurt::simulation::{Motion, Scenario, effects, robots};
use aurt::traits::{
    Motion as Series, Parameter, RegressorTile, RigidBodyRegressor, RobotState, RobotTile, typetag,
};
use aurt::{Drive, TorqueSeries, simulate};
use serde::{Deserialize, Serialize};

const TWO_LINK: [f64; 3] = [0.0, -9.81, 0.0];

fn recorded(seed: u64, with: Vec<Box<dyn effects::Effect>>) -> Recording {
    let machine = robots::two_link();
    let motion = Motion::MultiSine { duration_s: 10.0, harmonics: 6, top_hz: 1.0, share: 0.6 };
    let mut scenario = Scenario::new(machine.clone(), motion.plan(&machine, seed).unwrap(), seed);
    scenario.effects = with;
    simulate(&scenario).unwrap().named(format!("recording {seed}"))
}

fn two_link() -> Robot {
    Robot::from_mdh(&robots::two_link().mdh_csv(), TWO_LINK).unwrap()
}

/// Torques are the regressor's columns times the coefficients, in stretches of any length.
#[test]
fn torques_are_those_of_the_regressor() {
    let recording = recorded(1, Vec::new());
    for (coulomb, load_torque) in [
        (Friction::coulomb(), LoadTorqueChoice::Fitted),
        (Friction::load_dependent(), LoadTorqueChoice::Fitted),
        (Friction::load_dependent(), LoadTorqueChoice::Literal),
    ] {
        let friction = coulomb.clone().viscous(1).hysteresis(Dahl::default());
        let model = two_link().model().friction(friction).arm_term(RotorInertia::default());
        let calibration = CalibrationOptions { load_torque, fit_shapes: false, ..Default::default() };
        let model = Calibrator::new(model.build().unwrap())
            .settings(Settings { calibration, ..Settings::default() })
            .calibration(&recording)
            .calibrate()
            .unwrap()
            .calibrated;
        let samples = 700;
        let time_s: Vec<f64> = (0..samples).map(|k| 0.002 * k as f64).collect();
        let of = |scale: f64| -> Vec<f64> {
            (0..2)
                .flat_map(|j| time_s.iter().map(move |t| scale * ((1.0 + 0.4 * j as f64) * 3.0 * t).sin()))
                .collect()
        };
        let motion = Series::new(2, time_s.clone(), of(1.0), of(2.0), of(-5.0)).unwrap();

        let (mut state, mut tile) = (RobotState::default(), RobotTile::default());
        model.model.evaluate(motion.view(), &model.calibration.load, &mut state, &mut tile).unwrap();
        let coefficients = model.calibration.coefficients();
        let expected = |joint: usize, k: usize| -> f64 {
            let row = model.model.row_slots(joint).zip(model.model.row_columns(joint));
            row.map(|(slot, column)| coefficients[*column] * tile.slot(slot)[k]).sum()
        };
        let whole = model.torque(motion.view()).unwrap();
        let mut stretches = TorqueSeries::new(&model).unwrap();
        let mut first = 0;
        for length in [1, 7, 255, 256, 181] {
            let (torque, stride) = stretches.next(motion.view().slice(first..first + length)).unwrap();
            for joint in 0..2 {
                for k in 0..length {
                    let (a, b) = (torque[joint * stride + k], expected(joint, first + k));
                    assert!((a - b).abs() <= 1e-11 * b.abs().max(100.0), "{coulomb:?}: {a} {b}");
                    assert!((whole[joint][first + k] - b).abs() <= 1e-11 * b.abs().max(100.0));
                }
            }
            first += length;
        }
        assert_eq!(first, samples);
        let other = Series::new(1, vec![0.0], vec![0.0], vec![0.0], vec![0.0]).unwrap();
        assert!(model.torque(other.view()).is_err());
    }
}

#[test]
fn robots_have_names_and_files() {
    let robot = Robot::by_name("UR10e", [0.0, 0.0, -9.81]).unwrap();
    assert_eq!((robot.joints(), robot.base_parameters().len()), (6, 36));
    assert_eq!(robot.described().unwrap().limits.len(), 6);
    let error = Robot::by_name("ur1oe", [0.0, 0.0, -9.81]).unwrap_err().to_string();
    assert!(error.contains("did you mean `ur10e`"), "{error}");
    let urdf = r#"<robot name="r"><link name="a"/><link name="b"/>
        <joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>"#;
    assert_eq!(Robot::from_urdf(urdf, None, None, [0.0; 3]).unwrap().joints(), 1);
    assert!(
        Robot::read_urdf("none.urdf", None, None, [0.0; 3]).unwrap_err().to_string().contains("none.urdf")
    );
}

#[test]
fn a_diagnosis_in_memory_gives_typed_effects_and_the_improved_model() {
    let spring = effects::Spring { joint: 1, stiffness_nm_rad: 8.0, rest_rad: 0.3 };
    let explanation = Diagnoser::new(two_link().model().build().unwrap())
        .calibration(&recorded(1, Vec::new()))
        .calibration(&recorded(2, Vec::new()))
        .target(&recorded(3, vec![Box::new(spring)]))
        .explain(&Progress::silent())
        .unwrap();
    assert!(explanation.diagnosis.is_found());
    let found = explanation.diagnosis.effects();
    let spring = found.iter().find(|found| found.effect.kind() == Some(EffectKind::Spring)).unwrap();
    assert_eq!((&*spring.finding.joints, spring.presence()), (&[1][..], Presence::Target));
    let Effect::Spring(spring) = &spring.effect else { panic!("{:?}", spring.effect) };
    assert!((spring.stiffness_nm_rad[0].value - 8.0).abs() < 1.0, "{spring:?}");
    let improved = &explanation.model;
    let names: Vec<&str> = improved.model.arm_terms().iter().map(|term| term.name()).collect();
    assert!(names.contains(&"spring"), "{names:?}");
    let stiffness = improved.calibration.parameters.iter().find(|p| p.name.starts_with("spring.k")).unwrap();
    assert!((stiffness.value - 8.0).abs() < 1.0, "{stiffness:?}");
}

/// Friction is that of another day, and inertia that is late resembles it.
#[test]
fn a_delay_is_known_beside_friction_that_differs() {
    let friction = effects::FrictionLevelChanged {
        joints: vec![0, 1],
        coulomb_change: vec![-0.03, 0.03],
        viscous_change: vec![-0.06, -0.06],
    };
    let late: Vec<Box<dyn effects::Effect>> =
        vec![Box::new(effects::TimeDelay { delay_s: 0.012 }), Box::new(friction)];
    let diagnosis = Diagnoser::new(two_link().model().build().unwrap())
        .calibration(&recorded(1, Vec::new()))
        .calibration(&recorded(2, Vec::new()))
        .target(&recorded(3, late))
        .diagnose(&Progress::silent())
        .unwrap();
    let effects = diagnosis.effects();
    let Some(Effect::TimeDelay(late)) = effects.first().map(|found| &found.effect) else {
        panic!("{effects:?}")
    };
    let found = late.delay_s[0];
    assert!((found.value - 0.012).abs() < 2.0 * found.std.unwrap(), "{found:?}");
}

/// Drives whose torque constants nobody states: motion determines their ratio, so that a load is one on all joints.
#[test]
fn a_load_is_found_in_currents() {
    let in_amperes = |mut recording: Recording| {
        for (series, nm_per_a) in recording.measurement.iter_mut().flatten().zip([40.0, 15.0]) {
            series.iter_mut().for_each(|y| *y /= nm_per_a);
        }
        recording.unit = MeasurementUnit::Ampere;
        recording
    };
    let load = effects::Payload { link: 1, mass_kg: 1.5, com_m: [0.3, 0.1, 0.0], edges_m: [0.1, 0.1, 0.1] };
    let explanation = Diagnoser::new(two_link().model().build().unwrap())
        .calibration(&in_amperes(recorded(1, Vec::new())))
        .calibration(&in_amperes(recorded(2, Vec::new())))
        .target(&in_amperes(recorded(3, vec![Box::new(load)])))
        .explain(&Progress::silent())
        .unwrap();
    let found = explanation.diagnosis.effects();
    let in_target = found.iter().filter(|found| found.presence() == Presence::Target);
    let changed: Vec<&Effect> = in_target.map(|found| &found.effect).collect();
    let [Effect::Payload(load)] = changed[..] else { panic!("{changed:?}") };
    let moment = load.first_moment_kg_m.unwrap().map(|per_a| 40.0 * per_a.value);
    assert!((moment[0] - 0.45).abs() < 0.02 && (moment[1] - 0.15).abs() < 0.02, "{moment:?}");
    let notes = &explanation.diagnosis.verdict.notes;
    assert!(notes.iter().any(|note| note.contains("torque constants over its own")), "{notes:?}");
}

/// What the structure lacks is claimed where the calibration recordings show it; targets change nothing of it.
#[test]
fn the_structure_does_not_depend_on_the_targets() {
    let cable = || effects::Spring { joint: 1, stiffness_nm_rad: 8.0, rest_rad: 0.3 };
    let with = |seed, more: Vec<Box<dyn effects::Effect>>| {
        recorded(seed, [Box::new(cable()) as Box<dyn effects::Effect>].into_iter().chain(more).collect())
    };
    let calibration = [1, 2].map(|seed| with(seed, Vec::new()));
    let found = |targets: &[Recording]| {
        let alone = Diagnoser::new(two_link().model().build().unwrap());
        let diagnoser = calibration.iter().fold(alone, |d, recording| d.calibration(recording));
        let diagnoser = targets.iter().fold(diagnoser, |d, recording| d.target(recording));
        let diagnosis = diagnoser.diagnose(&Progress::silent()).unwrap();
        let effects = diagnosis.effects();
        let (changed, structure): (Vec<_>, Vec<_>) =
            effects.iter().partition(|found| found.presence() == Presence::Target);
        [structure, changed].map(|of| {
            let mut of: Vec<_> =
                of.iter().map(|f| (f.finding.effect.clone(), f.finding.joints.clone())).collect();
            of.sort();
            of
        })
    };
    let [alone, _] = found(&[]);
    // The rotors of the machine are no part of the model either.
    assert_eq!(alone, [("rotor_inertia".to_owned(), vec![1]), ("spring".to_owned(), vec![1])]);
    let other =
        effects::TorqueRipple { joint: 0, order: 9.0, amplitude_nm: 2.0, phase_rad: 0.4, overtone: 0.0 };
    let changed = with(3, vec![Box::new(other)]);
    for (target, expected) in
        [(with(4, Vec::new()), vec![]), (changed, vec![("torque_ripple".to_owned(), vec![0])])]
    {
        assert_eq!(found(&[target]), [alone.clone(), expected]);
    }
}

/// A drive's losses are a share of the load that the final model has: the model without them takes the arm for heavier.
#[test]
fn losses_of_a_drive_are_shares_of_the_load_that_it_carries() {
    let (driving, driven) = (0.05, 0.45);
    let lossy = |seed| {
        let losses =
            effects::DriveEfficiency { joints: vec![1], driving: vec![driving], driven: vec![driven] };
        recorded(seed, vec![Box::new(losses)])
    };
    let recordings = [1, 2, 3].map(lossy);
    let model = two_link().model().arm_term(RotorInertia::default()).build().unwrap();
    let diagnoser = recordings.iter().fold(Diagnoser::new(model), |d, recording| d.calibration(recording));
    let diagnosis = diagnoser.diagnose(&Progress::silent()).unwrap();
    let effects = diagnosis.effects();
    let found = effects.iter().find(|e| e.effect.kind() == Some(EffectKind::DriveEfficiency)).unwrap();
    assert_eq!(found.finding.joints, [1]);
    let Effect::DriveEfficiency(losses) = &found.effect else { panic!("{:?}", found.effect) };
    // Only the ratio of what both directions pass on is free of the gain.
    let ratio = (1.0 + losses.driving[0].value) / (1.0 - losses.driven[0].value);
    let truth = (1.0 + driving) / (1.0 - driven);
    println!("{ratio} of {truth}: {losses:?}");
    assert!((ratio / truth - 1.0).abs() < 0.03, "{ratio} of {truth}: {losses:?}");
}

#[test]
fn predictions_stand_at_the_stamps_and_models_move() {
    let recording = recorded(1, Vec::new());
    let outcome = Calibrator::new(two_link().model().build().unwrap())
        .calibration(&recording)
        .calibrate_with_series(&Progress::silent())
        .unwrap();
    assert!(!outcome.recordings[0].comparison.joints.is_empty());
    let predicted = outcome.calibrated.predict_at_stamps(&recording).unwrap();
    assert!(predicted.iter().all(|series| series.len() == recording.samples()));
    let drive = Drive::Motion { bandwidth_hz: 10.0 };
    let moved =
        outcome.calibrated.moved(&recording.window([0.0, 3.0]).unwrap(), drive, &Progress::silent()).unwrap();
    let far = moved.position_rad[0].iter().zip(&recording.position_rad[0]);
    assert!(far.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 0.02);
}

/// A pendulum whose regressor is nobody else's: τ = I q̈ + m_c g sin q.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Pendulum {
    gravity_m_s2: [f64; 3],
}

#[typetag::serde(name = "pendulum_of_the_test")]
impl RigidBodyRegressor for Pendulum {
    fn joints(&self) -> usize {
        1
    }

    fn standard_parameters(&self) -> Vec<Parameter> {
        vec![Parameter::new("I", "kg m^2"), Parameter::new("m_c", "kg m")]
    }

    fn loads(&self, _parameter: usize, _joint: usize) -> bool {
        true
    }

    fn evaluate(&self, motion: MotionView<'_>, out: &mut RegressorTile<'_>) {
        if let Some(inertia) = out.entry_mut(0, 0) {
            inertia.copy_from_slice(motion.acceleration_rad_s2(0));
        }
        if let Some(weight) = out.entry_mut(0, 1) {
            let pull = -self.gravity_m_s2[1];
            weight.iter_mut().zip(motion.position_rad(0)).for_each(|(w, q)| *w = pull * q.sin());
        }
    }

    fn gravity_m_s2(&self) -> [f64; 3] {
        self.gravity_m_s2
    }

    fn with_gravity(&self, gravity_m_s2: [f64; 3]) -> Box<dyn RigidBodyRegressor> {
        Box::new(Self { gravity_m_s2 })
    }
}

/// Rigid bodies of any kind are calibrated, saved, and predicted sample by sample as whole.
#[test]
fn rigid_bodies_of_ones_own_are_predicted_sample_by_sample() {
    let (inertia, weight) = (0.2, 0.5);
    let time_s: Vec<f64> = (0..5000).map(|k| 0.002 * f64::from(k)).collect();
    let q: Vec<f64> = time_s.iter().map(|t| (3.0 * t).sin() + 0.5 * (7.0 * t).sin()).collect();
    let qd = |t: f64| 3.0 * (3.0 * t).cos() + 3.5 * (7.0 * t).cos();
    let qdd = |t: f64| -9.0 * (3.0 * t).sin() - 24.5 * (7.0 * t).sin();
    let torque = |(t, q): (&f64, &f64)| {
        inertia * qdd(*t) + 9.81 * weight * q.sin() + 0.3 * qd(*t).signum() + 0.1 * qd(*t)
    };
    let measured = time_s.iter().zip(&q).map(torque).collect();
    let recording = Recording::from_arrays(time_s.clone(), vec![q.clone()])
        .unwrap()
        .with_measurement(vec![measured], MeasurementUnit::NewtonMetre)
        .unwrap();
    let robot = Robot::of_bodies(Arc::new(Pendulum { gravity_m_s2: [0.0, -9.81, 0.0] })).unwrap();
    let model =
        robot.model().friction(Friction::coulomb().hysteresis(Dahl::default()).viscous(1)).build().unwrap();
    let model = Calibrator::new(model).calibration(&recording).calibrate().unwrap().calibrated;
    let folder = tempfile::tempdir().unwrap();
    model.save(folder.path().join("m.json")).unwrap();
    let model = CalibratedModel::load(folder.path().join("m.json")).unwrap();
    let found = &model.calibration.parameters[..2];
    assert!((found[0].value - inertia).abs() < 0.01 && (found[1].value - weight).abs() < 0.01, "{found:?}");

    let of = |f: &dyn Fn(f64) -> f64| time_s.iter().map(|t| f(*t)).collect::<Vec<f64>>();
    let (speed, acceleration) = (of(&qd), of(&qdd));
    let motion = Series::new(1, time_s.clone(), q.clone(), speed.clone(), acceleration.clone()).unwrap();
    let whole = model.torque(motion.view()).unwrap();
    let mut predictor = model.predictor().unwrap();
    for k in 0..time_s.len() {
        let now = predictor.torque(0.002, &q[k..=k], &speed[k..=k], &acceleration[k..=k]).unwrap()[0];
        assert!((now - whole[0][k]).abs() < 1e-9, "{k}: {now} {}", whole[0][k]);
    }
}

#[test]
fn kinds_of_effects_are_those_of_the_diagnosis() {
    let mut known: Vec<&str> = aurt::diagnosis::effects::ALL.iter().map(|effect| effect.id).collect();
    known.sort_unstable();
    let kinds: Vec<&str> = EffectKind::ALL.iter().map(|kind| kind.id()).collect();
    assert_eq!(kinds, known);
}

#[test]
fn a_model_is_given_to_a_diagnosis_as_it_is() {
    let recording = recorded(1, Vec::new());
    let given = Calibrator::new(two_link().model().build().unwrap())
        .calibration(&recording)
        .calibrate()
        .unwrap()
        .calibrated;
    let spring = effects::Spring { joint: 1, stiffness_nm_rad: 8.0, rest_rad: 0.3 };
    let found = |recording: &Recording| {
        let diagnoser = Diagnoser::of_given(given.clone()).without([EffectKind::Payload]).target(recording);
        diagnoser.diagnose(&Progress::silent()).unwrap().is_found()
    };
    assert!(found(&recorded(2, vec![Box::new(spring)])));
}
