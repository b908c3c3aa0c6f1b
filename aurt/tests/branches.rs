//! A torso with two arms: the model is of one, and the other moves; or of both.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

use aurt::Drive;
use aurt::data::Loaded;
use aurt::friction::arm_terms::payload::Payload;
use aurt::prelude::*;
use aurt::traits::{ArmSeries, ArmTerm, Columns, Motion};
use aurt_recording::{BranchMotion, ReadOptions, ReadReport, RecordedJoints, RobotJoints, read_recording};

const GRAVITY: [f64; 3] = [0.0, 0.0, -9.81];
const NOISE_NM: f64 = 0.05;

/// A torso that pitches and two arms of `left_kg` and 3 kg; the right one has an elbow.
fn urdf(left_kg: f64) -> String {
    let link = |name: &str, mass: f64, at: &str| {
        format!(
            r#"<link name="{name}"><inertial><origin xyz="{at}"/><mass value="{mass}"/>
               <inertia ixx="0.05" iyy="0.06" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link>"#
        )
    };
    let joint = |name: &str, parent: &str, child: &str, at: &str| {
        format!(
            r#"<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/><origin xyz="{at}"/>
               <axis xyz="0 1 0"/><limit lower="-3" upper="3" velocity="5" effort="200"/></joint>"#
        )
    };
    [
        r#"<robot name="two_arms"><link name="base"/>"#.to_owned(),
        link("torso", 10.0, "0.02 0 0.3"),
        link("left_arm", left_kg, "0.3 0 0"),
        link("right_arm", 3.0, "0.2 0 0"),
        link("right_hand", 1.0, "0.15 0 0"),
        joint("torso_pitch", "base", "torso", "0 0 0.5"),
        joint("left_shoulder", "torso", "left_arm", "0 0.3 0.5"),
        joint("right_shoulder", "torso", "right_arm", "0 -0.3 0.5"),
        joint("right_elbow", "right_arm", "right_hand", "0.35 0 0"),
        "</robot>".to_owned(),
    ]
    .concat()
}

fn arm(left_kg: f64, tip: &str) -> Robot {
    Robot::from_urdf(&urdf(left_kg), None, Some(tip), GRAVITY).unwrap()
}

/// Torques of a motion of the chain to a tip; only the links from `first` on have mass.
fn torque(robot: &Robot, first: usize, time_s: &[f64], sines: &[[f64; 2]]) -> Vec<f64> {
    let of = |derivative: i32| -> Vec<f64> {
        let turn = derivative as f64 * std::f64::consts::FRAC_PI_2;
        let series = |[size, rate]: &[f64; 2]| {
            let (size, rate) = (*size, *rate);
            time_s
                .iter()
                .map(move |t| size * rate.powi(derivative) * (rate * t + turn).sin())
                .collect::<Vec<_>>()
        };
        sines.iter().flat_map(series).collect()
    };
    let motion = Motion::new(sines.len(), time_s.to_vec(), of(0), of(1), of(2)).unwrap();
    let mut standard = robot.described().unwrap().standard_parameters.clone().unwrap();
    standard[..10 * first].fill(0.0);
    let mut torque = vec![0.0; sines.len() * time_s.len()];
    robot.rigid_body().torque(motion.view(), &standard, &mut torque, time_s.len());
    torque
}

/// Text with a column for each quantity of each joint, the joints in another order than the chain's. The torques are the sums
/// of those of two chains, each with the masses that the other is without.
fn recorded(seed: f64, left_rad: f64, left_kg: f64) -> String {
    let time_s: Vec<f64> = (0..4000).map(|k| 0.008 * f64::from(k)).collect();
    let sines = [[0.4, 1.1 + 0.1 * seed], [0.9, 1.7 - 0.1 * seed], [0.8, 2.3 + 0.05 * seed]];
    let left = [left_rad, 1.9];
    let right = torque(&arm(1e-9, "right_hand"), 0, &time_s, &sines);
    let other = torque(&arm(left_kg, "left_arm"), 1, &time_s, &[sines[0], left]);
    let samples = time_s.len();
    let mut text = String::from("time");
    for quantity in ["position", "effort"] {
        for joint in ["left_shoulder", "right_elbow", "right_shoulder", "torso_pitch"] {
            text += &format!(",{joint}.{quantity}");
        }
    }
    let mut state = 0.5 + 0.01 * seed;
    let mut noise = || {
        let sum: f64 = (0..12)
            .map(|_| {
                state = (state * 9_301.0 + 0.211_327).fract();
                state
            })
            .sum();
        NOISE_NM * (sum - 6.0)
    };
    for (k, t) in time_s.iter().enumerate() {
        let q = |[size, rate]: [f64; 2]| size * (rate * t).sin();
        let friction = |[size, rate]: [f64; 2]| 2.0 * (size * rate * (rate * t).cos() / 1e-3).tanh();
        let measured = [
            other[samples + k],
            right[2 * samples + k] + friction(sines[2]),
            right[samples + k] + friction(sines[1]),
            right[k] + other[k] + friction(sines[0]),
        ];
        text += &format!("\n{t},{},{},{},{}", q(left), q(sines[2]), q(sines[1]), q(sines[0]));
        measured.iter().for_each(|tau| text += &format!(",{}", tau + noise()));
    }
    text
}

fn read(robot: &Robot, seed: f64, left_rad: f64) -> Recording {
    read_with(robot, seed, left_rad, 4.0)
}

fn read_with(robot: &Robot, seed: f64, left_rad: f64, left_kg: f64) -> Recording {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("{seed}.csv"));
    std::fs::write(&path, recorded(seed, left_rad, left_kg)).unwrap();
    let joints = Some(RobotJoints::of(robot.rigid_body()));
    read_recording(&path, &ReadOptions { joints, ..ReadOptions::default() }).unwrap()
}

#[test]
fn an_arm_that_moves_beside_the_chain_is_told_and_nothing_is_claimed_upstream() {
    let robot = arm(4.0, "right_hand");
    let described = robot.described().unwrap();
    let [branch] = &described.branches[..] else { panic!("{:?}", described.branches) };
    assert_eq!((&*branch.joint, &branch.upstream[..]), ("left_shoulder", &[0][..]));
    // 4 kg at 0.3 m from the axis.
    assert!((branch.displaced.unwrap() - 1.2).abs() < 1e-12);

    let model = || robot.model().friction(Friction::coulomb()).build().unwrap();
    let calibrate = |left_rad| {
        let outcome = Calibrator::new(model())
            .calibration(&read(&robot, 1.0, left_rad))
            .validation(&read(&robot, 2.0, left_rad))
            .calibrate()
            .unwrap();
        let warnings = outcome.calibrated.calibration.warnings.clone();
        (outcome, warnings.into_iter().filter(|w| w.contains("left_shoulder")).collect::<Vec<_>>())
    };
    let (still, told) = calibrate(0.0);
    assert_eq!(told, [""; 0]);
    let (moved, told) = calibrate(0.7);
    assert_eq!(told.len(), 2, "both recordings: {told:?}");
    assert!(told[0].contains("left_shoulder by 1.400 rad") && told[0].contains("joint 0 "), "{told:?}");
    let error = |outcome: &Outcome| outcome.recordings[1].validation.all.nrmse[0];
    assert!(error(&moved) > 10.0 * error(&still), "{} {}", error(&moved), error(&still));

    // The model file carries it: predictions are told too.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rd_calibrated.json");
    std::fs::write(&path, moved.calibrated.to_file().unwrap()).unwrap();
    let again = CalibratedModel::load(&path).unwrap();
    let loaded = Loaded::of(&read(&robot, 3.0, 0.7), &again.pipeline().joints).unwrap();
    assert_eq!(loaded.recording.report.warnings().count(), 1);

    let diagnosis = Diagnoser::new(model())
        .calibration(&read(&robot, 1.0, 0.7))
        .calibration(&read(&robot, 2.0, 0.7))
        .diagnose(&Progress::silent())
        .unwrap();
    let verdict = &diagnosis.verdict;
    assert!(verdict.effects.iter().all(|e| !e.joints.contains(&0)), "{:?}", verdict.effects);
    let beside =
        verdict.not_examined.iter().filter(|n| n.joints == [0] && n.reason.contains("left_shoulder"));
    assert_eq!(beside.count(), 2, "{:?}", verdict.not_examined);
    assert_eq!(verdict.warnings.iter().filter(|w| w.contains("left_shoulder")).count(), 2);
}

#[test]
fn a_base_that_moves_or_leans_is_told() {
    let robot = Robot::from_urdf(&urdf(4.0), Some("torso"), Some("right_hand"), GRAVITY).unwrap();
    let joints = RobotJoints::of(robot.rigid_body());
    let names = ["torso_pitch", "right_shoulder", "right_elbow"].map(str::to_owned).to_vec();
    let time_s: Vec<f64> = (0..500).map(|k| 0.01 * f64::from(k)).collect();
    let report = |torso: &dyn Fn(f64) -> f64| {
        let series = |of: &dyn Fn(f64) -> f64| time_s.iter().map(|t| of(*t)).collect::<Vec<f64>>();
        let arm = series(&|t| t.sin());
        let recording =
            Recording::from_arrays(time_s.clone(), vec![series(torso), arm.clone(), arm]).unwrap();
        let named = Recording { joints: RecordedJoints::Named(names.clone()), ..recording };
        named.of_robot(&joints).unwrap().report.clone()
    };
    let [upright, leans, moves] = [report(&|_| 0.0), report(&|_| 0.4), report(&|t| 0.1 * t)];
    assert_eq!(upright.branches, []);
    let told = |report: &ReadReport| report.warnings().collect::<Vec<_>>().join("; ");
    assert!(
        told(&leans).contains("torso_pitch at 0.400 rad") && told(&leans).contains("gravity"),
        "{}",
        told(&leans)
    );
    assert!(told(&moves).contains("torso_pitch by 0.499 rad"), "{}", told(&moves));
    assert_eq!((leans.branches[0].moves, &moves.branches[0].upstream[..]), (false, &[0, 1][..]));
    assert!(BranchMotion::elsewhere(&leans.branches, &upright.branches).is_some());
    assert!(BranchMotion::elsewhere(&leans.branches, &leans.branches).is_none());

    let model = robot.model().friction(Friction::coulomb()).build().unwrap();
    let asked =
        Diagnoser::new(model).calibration(&read(&robot, 1.0, 0.0)).calibration(&read(&robot, 2.0, 0.0));
    let refused = asked.diagnose(&Progress::silent()).unwrap_err().to_string();
    assert!(refused.contains("joints that carry the base move"), "{refused}");
}

#[test]
fn both_arms_are_one_tree_and_a_load_is_on_the_hand_that_carries_it() {
    let whole = Robot::from_urdf(&urdf(4.0), None, None, GRAVITY).unwrap();
    let names = &whole.described().unwrap().joint_names;
    assert_eq!(names[..], ["torso_pitch", "left_shoulder", "right_shoulder", "right_elbow"]);
    let model = |robot: &Robot| robot.model().friction(Friction::coulomb()).build().unwrap();
    let errors = |robot: &Robot, left_rad: f64| {
        let outcome = Calibrator::new(model(robot))
            .calibration(&read(robot, 1.0, left_rad))
            .validation(&read(robot, 2.0, left_rad))
            .calibrate()
            .unwrap();
        assert!(outcome.calibrated.calibration.warnings.iter().all(|w| !w.contains("left_shoulder")));
        outcome.recordings[1].validation.all.mse.iter().map(|mse| mse.sqrt()).collect::<Vec<f64>>()
    };
    let (alone, both) = (errors(&arm(4.0, "right_hand"), 0.0), errors(&whole, 0.7));
    println!("RMS errors in Nm: {alone:?} of one arm alone, {both:?} of the tree with both moving");
    assert!(both[0] < 1.1 * alone[0] && both.iter().all(|rms| *rms < 1.5 * NOISE_NM), "{alone:?} {both:?}");

    let diagnosis = Diagnoser::new(model(&whole))
        .calibration(&read(&whole, 1.0, 0.7))
        .calibration(&read(&whole, 2.0, 0.7))
        .target(&read_with(&whole, 3.0, 0.7, 5.5))
        .target(&read_with(&whole, 4.0, 0.7, 5.5))
        .diagnose(&Progress::silent())
        .unwrap();
    let verdict = &diagnosis.verdict;
    let claimed: Vec<&str> = verdict.effects.iter().map(|e| e.sentence.as_str()).collect();
    println!("{claimed:?}");
    let [load] = &verdict.effects[..] else { panic!("{claimed:?}") };
    assert_eq!((load.effect.as_str(), load.parameters["link"].value.as_f64()), ("payload", Some(1.0)));
    let mass = load.parameters["mass_kg"].value.as_f64().unwrap();
    assert!((mass - 1.5).abs() < 0.1, "{mass}");
}

#[test]
fn a_calibrated_tree_is_saved_moves_and_asks_for_the_link_of_a_load() {
    let whole = Robot::from_urdf(&urdf(4.0), None, None, GRAVITY).unwrap();
    let model = || whole.model().friction(Friction::coulomb());
    let calibrate = |model| Calibrator::new(model).calibration(&read(&whole, 1.0, 0.7)).calibrate();
    let calibrated = calibrate(model().build().unwrap()).unwrap().calibrated;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rd_calibrated.json");
    std::fs::write(&path, calibrated.to_file().unwrap()).unwrap();
    let again = CalibratedModel::load(&path).unwrap();
    let held_out = read(&whole, 2.0, 0.7);
    let predicted = |of: &CalibratedModel| of.predict_at_stamps(&held_out).unwrap();
    assert_eq!(predicted(&again), predicted(&calibrated));

    let moved = again.moved(&held_out, Drive::Motion { bandwidth_hz: 10.0 }, &Progress::silent()).unwrap();
    let size = |series: &[f64]| series.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    for (joint, reach) in [0.4, 0.7, 0.9, 0.8].into_iter().enumerate() {
        let found = size(&moved.position_rad[joint]);
        assert!((found - reach).abs() < 0.02, "joint {joint} moves by {found}, not {reach}");
    }

    let with = |link| model().arm_term(Payload { link, parameters: None }).build().unwrap();
    let error = calibrate(with(None)).unwrap_err().to_string();
    assert!(error.contains("the robot is a tree, and its last link 3 does not load joint 1"), "{error}");
    assert!(calibrate(with(Some(1))).is_ok());
}

#[test]
fn series_in_memory_and_light_branches_are_looked_at_too() {
    let joints = RobotJoints::of(arm(4.0, "right_hand").rigid_body());
    let names = ["left_shoulder", "right_elbow", "torso_pitch", "right_shoulder"].map(str::to_owned).to_vec();
    let time_s: Vec<f64> = (0..500).map(|k| 0.01 * f64::from(k)).collect();
    let sine = |size: f64| -> Vec<f64> { time_s.iter().map(|t| size * (2.0 * t).sin()).collect() };
    let of = |size: f64| {
        let recording =
            Recording::from_arrays(time_s.clone(), vec![sine(size), sine(1.0), sine(1.0), sine(1.0)])
                .unwrap();
        let named = Recording { joints: RecordedJoints::Named(names.clone()), ..recording };
        named.of_robot(&joints).unwrap().report.branches.clone()
    };
    assert_eq!(of(0.0), []);
    let [motion] = &of(0.25)[..] else { panic!("it moves") };
    assert!((motion.range_rad[1] - 0.25).abs() < 1e-3);
    assert_eq!(motion.upstream, [0]);
}

/// A bracket whose direction a parallelogram keeps: its moments of inertia make no torque of the shoulder, and what they leave
/// by rounding is no column.
#[test]
fn inertia_of_a_link_that_does_not_turn_is_no_column() {
    let urdf = include_str!("../../aurt-rbd/tests/descriptions/reference/coupled.urdf");
    let robot = Robot::from_urdf(urdf, None, Some("bracket"), GRAVITY).unwrap();
    let samples = 300_i32;
    let wave = |rate: f64| (0..2 * samples).map(|k| (0.37 * rate * f64::from(k)).sin()).collect::<Vec<f64>>();
    let time_s = (0..samples).map(f64::from).collect();
    let motion = Motion::new(2, time_s, wave(1.0), wave(2.1), wave(3.7)).unwrap();
    let samples = samples as usize;
    let term = Payload { link: Some(2), parameters: None };
    let series =
        ArmSeries { motion: motion.view(), load_torque: &[], load_stride: 0, rigid_body: robot.rigid_body() };
    let mut data = vec![1.0; 20 * samples];
    let mut out = Columns::new(&mut data, 20, samples, samples);
    term.evaluate(&series, &mut term.initial_state(&series), &mut out).unwrap();
    let longest = |column: usize| {
        data[column * samples..(column + 1) * samples].iter().fold(0.0, |m: f64, v| m.max(v.abs()))
    };
    let sizes: Vec<f64> = (10..20).map(longest).collect();
    assert!(sizes[..6].iter().all(|size| *size == 0.0) && sizes[9] > 1.0, "{sizes:?}");
}
