//! What a front end other than ours uses: robots of names and files, torques of whole motions, full diagnoses in memory.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

use aurt::{
    Drive, TorqueSeries,
    prelude::*,
    traits::{Motion as Series, RobotState, RobotTile},
};

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
        ("constant", LoadTorqueChoice::Fitted),
        ("absolute", LoadTorqueChoice::Fitted),
        ("absolute", LoadTorqueChoice::Literal),
    ] {
        let model = two_link().model().coulomb(coulomb).hysteresis("dahl").arm_term("rotor_inertia");
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
                    assert!((a - b).abs() <= 1e-11 * b.abs().max(100.0), "{coulomb}: {a} {b}");
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
fn a_diagnosis_in_memory_gives_the_improved_model_and_its_report() {
    let spring = effects::Spring { joint: 1, stiffness_nm_rad: 8.0, rest_rad: 0.3 };
    let explanation = Diagnoser::new(two_link().model().build().unwrap())
        .calibration(&recorded(1, Vec::new()))
        .calibration(&recorded(2, Vec::new()))
        .target(&recorded(3, vec![Box::new(spring)]))
        .explain(&Progress::silent())
        .unwrap();
    assert!(explanation.is_found() && explanation.verdict.effects.iter().any(|e| e.effect == "spring"));
    let improved = &explanation.model;
    let names: Vec<&str> = improved.model.arm_terms().iter().map(|term| term.name()).collect();
    assert!(names.contains(&"spring"), "{names:?}");
    let stiffness = improved.calibration.parameters.iter().find(|p| p.name.starts_with("spring.k")).unwrap();
    assert!((stiffness.value - 8.0).abs() < 1.0, "{stiffness:?}");
    assert!(explanation.report.to_html().contains("spring"));
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
    let model = two_link().model().arm_term("rotor_inertia").build().unwrap();
    let diagnoser = recordings.iter().fold(Diagnoser::new(model), |d, recording| d.calibration(recording));
    let verdict = diagnoser.diagnose().unwrap();
    let found = verdict.effects.iter().find(|e| e.effect == "drive_efficiency").unwrap();
    assert_eq!(found.joints, [1]);
    // Only the ratio of what both directions pass on is free of the gain.
    let of = |name: &str| found.parameters[name].value.as_f64().unwrap();
    let ratio = (1.0 + of("driving")) / (1.0 - of("driven"));
    let truth = (1.0 + driving) / (1.0 - driven);
    println!("{ratio} of {truth}: {:?}", found.parameters);
    assert!((ratio / truth - 1.0).abs() < 0.03, "{ratio} of {truth}: {:?}", found.parameters);
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
