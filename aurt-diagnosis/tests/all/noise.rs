//! The noise floor against recordings whose noise is known: exact rigid bodies with dry and viscous friction, moved along
//! planned trajectories, seen through encoders, clocks and ammeters of our own making.

use std::path::Path;
use std::sync::Arc;

use aurt_calibration::CalibrationOptions;
use aurt_diagnosis::evidence::baseline::{Baseline, evaluate_all};
use aurt_diagnosis::noise::floor::noise_floor;
use aurt_diagnosis::noise::spectrum::RecordingNoise;
use aurt_diagnosis::{Fit, Question, QuestionedRecording, Role, SelectionOptions};
use aurt_experiment::Experiment;
use aurt_plugins::Registry;
use aurt_recording::{PreprocessOptions, ReadReport, Recording};
use aurt_simulation::{Motion, Robot, Scenario, SimulatedRecording, robots, simulate};
use aurt_traits::{ArmTerm, MeasurementUnit, Motion as Series, RegressorTile, RobotModel};
use serde_json::json;

use crate::dice::Dice;

const F_DYN_HZ: f64 = 10.0;
const VISCOUS_NM_S: f64 = 9.0;

/// What sees and writes the motion.
#[derive(Clone, Copy)]
struct Sight {
    rate_hz: f64,
    /// Standard deviation of the stamps' honest jitter, in periods.
    jitter: f64,
    encoder_rad: f64,
    step_rad: f64,
    white_nm: f64,
    markov_nm: f64,
    corner_hz: f64,
    /// Dry friction of the joints, Nm.
    coulomb_nm: f64,
}

const PERFECT: Sight = Sight {
    rate_hz: 500.0,
    jitter: 0.0,
    encoder_rad: 0.0,
    step_rad: 0.0,
    white_nm: 0.0,
    markov_nm: 0.0,
    corner_hz: 1.0,
    coulomb_nm: 6.0,
};

fn model_of(robot: &Robot) -> RobotModel {
    model_with(robot, "constant")
}

/// The robot's model with a Coulomb model of this name.
fn model_with(robot: &Robot, coulomb: &str) -> RobotModel {
    let folder = tempfile::tempdir().unwrap();
    let mdh = folder.path().join("mdh.csv");
    std::fs::write(&mdh, robot.mdh_csv()).unwrap();
    // The experiment has to name a recording that exists; none is read.
    let unread = folder.path().join("unread.csv");
    std::fs::write(&unread, "").unwrap();
    let text = format!(
        "schema = 1\n[robot]\nmdh = {mdh:?}\ngravity_m_s2 = {:?}\n[joint_dynamics]\ncoulomb = {{ model = {coulomb:?} }}\n\
         hysteresis = {{ model = \"sign\" }}\nviscous = {{ model = \"polynomial\", powers = [1] }}\n[preprocess]\n\
         f_dyn_hz = {F_DYN_HZ:?}\n[recordings]\ncalibration = [{unread:?}]\n",
        robot.gravity_m_s2,
    );
    let mut registry = Registry::linked().unwrap();
    let experiment = Experiment::parse(&text, Path::new("experiment.toml"), &mut registry).unwrap();
    experiment.robot_model().unwrap()
}

/// The torque of the robot's links along a motion, joint after joint, and of friction.
fn torque(robot: &Robot, model: &RobotModel, motion: &Series, coulomb_nm: f64) -> Vec<Vec<f64>> {
    let body = model.rigid_body();
    let (joints, count) = (robot.joints(), motion.samples());
    let values = robot.standard_parameters();
    let n = values.len();
    let destination: Vec<u32> = (0..joints * n).map(|k| k as u32).collect();
    let mut data = vec![0.0; joints * n * count];
    let mut tile = RegressorTile::new(&destination, n, count, count, &mut data);
    body.evaluate(motion.view(), &mut tile);
    (0..joints)
        .map(|j| {
            let velocity = motion.view().velocity_rad_s(j);
            (0..count)
                .map(|k| {
                    let v = velocity[k];
                    let sign = if v == 0.0 { 0.0 } else { v.signum() };
                    let links: f64 = (0..n).map(|p| values[p] * data[(j * n + p) * count + k]).sum();
                    links + coulomb_nm * sign + VISCOUS_NM_S * v
                })
                .collect()
        })
        .collect()
}

fn recording(robot: &Robot, model: &RobotModel, motion: &Motion, sight: &Sight, seed: u64) -> Recording {
    let plan = motion.plan(robot, seed).unwrap();
    let joints = robot.joints();
    let mut dice = Dice(seed.wrapping_add(77));
    let count = (plan.duration_s() * sight.rate_hz) as usize;
    let time: Vec<f64> = (0..count)
        .map(|k| (k as f64 + sight.jitter * dice.normal().clamp(-4.0, 4.0)) / sight.rate_hz)
        .collect();
    let mut series = [vec![0.0; joints * count], vec![0.0; joints * count], vec![0.0; joints * count]];
    let (mut q, mut v, mut a) = (vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]);
    for (k, t) in time.iter().enumerate() {
        plan.at(*t, &mut q, &mut v, &mut a);
        for j in 0..joints {
            series[0][j * count + k] = q[j];
            series[1][j * count + k] = v[j];
            series[2][j * count + k] = a[j];
        }
    }
    let [position, velocity, acceleration] = series;
    let exact = Series::new(joints, time.clone(), position.clone(), velocity, acceleration).unwrap();
    let mut measurement = torque(robot, model, &exact, sight.coulomb_nm);
    let a = (-std::f64::consts::TAU * sight.corner_hz / sight.rate_hz).exp();
    for series in &mut measurement {
        let mut state = sight.markov_nm * dice.normal();
        for value in series.iter_mut() {
            state = a * state + sight.markov_nm * (1.0 - a * a).sqrt() * dice.normal();
            *value += state + sight.white_nm * dice.normal();
        }
    }
    let shown = |q: &f64, dice: &mut Dice| {
        let q = q + sight.encoder_rad * dice.normal();
        if sight.step_rad > 0.0 { (q / sight.step_rad).round() * sight.step_rad } else { q }
    };
    let position_rad = position
        .chunks_exact(count)
        .map(|series| series.iter().map(|q| shown(q, &mut dice)).collect())
        .collect();
    Recording {
        file: "made.csv".into(),
        time_s: time,
        position_rad,
        velocity_rad_s: None,
        measurement: Some(measurement),
        unit: MeasurementUnit::NewtonMetre,
        joints: aurt_recording::RecordedJoints::Unnamed,
        report: ReadReport::default(),
    }
}

/// Of each joint: the floor, and the residual of the fitted model, root mean square, over the rows that count of two
/// recordings.
fn floors(robot: &Robot, motion: &Motion, sight: &Sight) -> Vec<(f64, f64)> {
    let model = model_of(robot);
    floors_of(robot, &model, |seed| recording(robot, &model, motion, sight, seed))
}

fn floors_of(robot: &Robot, model: &RobotModel, recorded: impl Fn(u64) -> Recording) -> Vec<(f64, f64)> {
    floors_at(robot, model, F_DYN_HZ, recorded)
}

fn floors_at(
    robot: &Robot,
    model: &RobotModel,
    f_dyn_hz: f64,
    recorded: impl Fn(u64) -> Recording,
) -> Vec<(f64, f64)> {
    let options = PreprocessOptions::new(f_dyn_hz);
    let recordings: Vec<QuestionedRecording> = (3..5)
        .map(|seed| {
            let name = format!("{seed}");
            let recording = recorded(seed);
            let read = QuestionedRecording::new(Role::Calibration, name, recording, options.clone());
            read.unwrap().repaired(&[]).unwrap()
        })
        .collect();
    let question = Question {
        model,
        frozen: None,
        recordings: &recordings,
        unit: MeasurementUnit::NewtonMetre,
        f_dyn_hz,
        calibration: CalibrationOptions::default(),
        selection: SelectionOptions::default(),
        without: &[],
        scale: None,
    };
    let baseline = Baseline::new(&question).unwrap();
    let fit = Fit { model, load: &baseline.load, coefficients: &baseline.coefficients };
    let rows = evaluate_all(&question, &fit).unwrap();
    let mut sums = vec![(0.0, 0.0, 0.0); robot.joints()];
    for (recording, rows) in recordings.iter().zip(&rows) {
        let noise =
            RecordingNoise::evaluate(&recording.raw, &recording.data.data, &recording.options, &fit).unwrap();
        let floor = noise_floor(&noise, &recording.data.data, rows).unwrap();
        for (j, (said, left, count)) in sums.iter_mut().enumerate() {
            let joint = &rows.joints[j];
            let columns = model.row_columns(j).iter().map(|c| baseline.coefficients[*c]);
            let counted = joint.counted(0, rows.rows());
            *said += floor[j] * counted;
            *left += joint.residual(columns).iter().map(|e| e * e).sum::<f64>();
            *count += counted;
        }
    }
    sums.iter().map(|(said, left, count)| ((said / count).sqrt(), (left / count).sqrt())).collect()
}

fn excitation() -> Motion {
    Motion::MultiSine { duration_s: 25.0, harmonics: 6, top_hz: 0.8, share: 0.6 }
}

fn assert_within(found: &[(f64, f64)], range: std::ops::Range<f64>, what: &str) {
    let ratios: Vec<f64> = found.iter().map(|(said, left)| said / left).collect();
    println!("{what}: {ratios:.3?} of {:.4?}", found.iter().map(|f| f.1).collect::<Vec<_>>());
    assert!(ratios.iter().all(|r| range.contains(r)), "{what}: {ratios:.3?}");
}

#[test]
fn a_clock_that_jitters_honestly_is_no_noise() {
    let robot = robots::ur10e();
    for jitter in [0.02, 0.06] {
        let found = floors(&robot, &excitation(), &Sight { jitter, ..PERFECT });
        for (said, left) in &found {
            assert!(*said <= 2.0 * left && *said < 1e-3, "{jitter}: {found:?}");
        }
    }
}

#[test]
fn joints_that_stand_have_no_steps_of_friction() {
    let robot = robots::ur10e();
    let motion = Motion::PointToPoint { duration_s: 25.0, rest_s: 0.8, share: 0.5 };
    let found = floors(&robot, &motion, &Sight { jitter: 0.03, white_nm: 0.05, ..PERFECT });
    for (said, left) in &found {
        assert!(*said < 0.04 && *said <= 1.1 * left, "{found:?}");
    }
}

/// A machine whose servos let its joints stick at reversals, by the simulator of closed loops.
#[test]
fn joints_that_stick_at_reversals_leave_what_they_are_said_to_leave() {
    let robot = robots::tx40();
    let mut model = model_of(&robot);
    let rotors =
        Registry::linked().unwrap().build_from_json::<dyn ArmTerm>(&json!({"model": "rotor_inertia"}));
    let stacks = model.stacks().to_vec();
    model =
        RobotModel::new(Arc::clone(model.rigid_body()), model.base().clone(), stacks, vec![rotors.unwrap()])
            .unwrap();
    let found = floors_of(&robot, &model, |seed| {
        let scenario = Scenario::new(robot.clone(), excitation().plan(&robot, seed).unwrap(), seed);
        let SimulatedRecording { joints, time_s, position_rad, measurement, .. } =
            simulate(&scenario).unwrap();
        let series = |rows: &[f64]| -> Vec<Vec<f64>> {
            (0..joints).map(|j| rows.iter().skip(j).step_by(joints).copied().collect()).collect()
        };
        Recording {
            file: "simulated.csv".into(),
            time_s,
            position_rad: series(&position_rad),
            velocity_rad_s: None,
            measurement: Some(series(&measurement)),
            unit: MeasurementUnit::NewtonMetre,
            joints: aurt_recording::RecordedJoints::Unnamed,
            report: ReadReport::default(),
        }
    });
    assert_within(&found, 0.6..1.25, "sticking joints");
}

#[test]
fn white_noise_of_encoders_makes_the_residual_that_it_is_said_to_make() {
    let robot = robots::ur10e();
    let cases = [(1e-6, 125.0), (1e-5, 250.0), (1e-4, 500.0), (3e-5, 1000.0)];
    for (coulomb_nm, (encoder_rad, rate)) in [0.0, 6.0].into_iter().flat_map(|c| cases.map(|case| (c, case)))
    {
        let found = floors(
            &robot,
            &excitation(),
            &Sight { rate_hz: rate, encoder_rad, white_nm: 0.05, coulomb_nm, ..PERFECT },
        );
        let what = format!("{encoder_rad} rad at {rate} Hz, {coulomb_nm} Nm");
        if coulomb_nm == 0.0 {
            assert_within(&found, 0.85..1.1, &what);
            continue;
        }
        // Which reversal noise decides is chance, and a recording has few of them: joint by joint the floor is an
        // expectation.
        let mut ratios: Vec<f64> = found.iter().map(|(said, left)| said / left).collect();
        ratios.sort_by(f64::total_cmp);
        let middle = 0.5 * (ratios[2] + ratios[3]);
        assert!((0.8..1.2).contains(&middle), "{what}: {ratios:.3?}");
    }
}

#[test]
fn the_lattice_of_encoders_makes_the_residual_that_it_is_said_to_make() {
    let robot = robots::ur10e();
    for bits in [12, 14, 17, 20] {
        let step_rad = std::f64::consts::TAU / f64::from(1 << bits);
        let found =
            floors(&robot, &excitation(), &Sight { step_rad, white_nm: 0.05, coulomb_nm: 0.0, ..PERFECT });
        assert_within(&found, 0.72..1.25, &format!("{bits} bits"));
    }
}

#[test]
fn memory_of_the_measurement_is_carried_into_the_band_of_calibration() {
    let robot = robots::two_link();
    for corner_hz in [10.0, 20.0, 50.0] {
        let sight = Sight { white_nm: 0.1, markov_nm: 0.15, corner_hz, ..PERFECT };
        assert_within(&floors(&robot, &excitation(), &sight), 0.8..1.12, &format!("{corner_hz} Hz"));
    }
}

/// Joints that turn every second or two have no calm pieces of four periods of 2.5 Hz.
#[test]
fn friction_that_the_model_lacks_is_no_memory_of_the_instrument() {
    let robot = robots::ur10e();
    let model = model_with(&robot, "absent");
    let motion = Motion::MultiSine { duration_s: 30.0, harmonics: 5, top_hz: 0.5, share: 0.6 };
    let sight = Sight { white_nm: 0.3, ..PERFECT };
    let found = floors_at(&robot, &model, 2.5, |seed| recording(&robot, &model, &motion, &sight, seed));
    // White noise behind a filter of twice f_dyn.
    let white = sight.white_nm * (2.0 * 2.0 * 2.5 / sight.rate_hz).sqrt();
    println!("{found:.3?}, white {white:.3}");
    let few_pieces = found.iter().filter(|(said, _)| !(0.8..1.2).contains(&(said / white))).count();
    assert!(few_pieces <= 1, "{found:.3?}, white {white:.3}");
    for (said, left) in &found {
        assert!(*said < 5.0 * white && *left > 10.0 * said, "{found:.3?}, white {white:.3}");
    }
}
