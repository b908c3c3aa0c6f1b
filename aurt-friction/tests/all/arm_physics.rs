//! Arm terms against the laws that they stand for.

use crate::registry::planar_arm;

use aurt_friction::arm_terms::base_tilt::BaseTilt;
use aurt_friction::arm_terms::counterbalance::Counterbalance;
use aurt_friction::arm_terms::coupling::Coupling;
use aurt_friction::arm_terms::drive_efficiency::DriveEfficiency;
use aurt_friction::arm_terms::encoder_offset::EncoderOffset;
use aurt_friction::arm_terms::joint_compliance::JointCompliance;
use aurt_friction::arm_terms::joint_selection::JointSelection;
use aurt_friction::arm_terms::lugre_damped::LuGreDamped;
use aurt_friction::arm_terms::payload::{Inertial, Payload};
use aurt_friction::arm_terms::rotor_inertia::RotorInertia;
use aurt_friction::arm_terms::torque_ripple::TorqueRipple;
use aurt_friction::conformance::arm::evaluate;
use aurt_friction::conformance::recording::Recording;
use aurt_friction::hysteresis::lugre::LuGre;
use aurt_traits::{ArmTerm, ModelError, Motion, RegressorTile, RigidBodyRegressor};
use planar_arm::PlanarArm;

const JOINTS: usize = 3;
const SAMPLES: usize = 200;

fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!(
        (found - expected).abs() <= tolerance * expected.abs().max(1.0),
        "{what}: {found} for {expected}"
    );
}

/// Torque of all joints, joint after joint, of bodies with the given standard parameters.
fn torque(body: &dyn RigidBodyRegressor, recording: &Recording, standard: &[f64]) -> Vec<f64> {
    let (joints, count, samples) = (body.joints(), standard.len(), recording.samples());
    let destination: Vec<u32> = (0..(joints * count) as u32).collect();
    let mut data = vec![0.0; joints * count * samples];
    let mut tile = RegressorTile::new(&destination, count, samples, samples, &mut data);
    body.evaluate(recording.motion().view(), &mut tile);
    (0..joints * samples)
        .map(|i| {
            let (joint, n) = (i / samples, i % samples);
            standard.iter().enumerate().map(|(p, x)| x * data[(joint * count + p) * samples + n]).sum()
        })
        .collect()
}

/// The same of an arm one of whose joints stands further by some angle at each sample.
fn turned_torque(
    body: &PlanarArm,
    shown: &Recording,
    standard: &[f64],
    joint: usize,
    by_rad: impl Fn(usize) -> f64,
) -> Vec<f64> {
    let motion = shown.motion();
    let view = motion.view();
    let of = |series: &dyn Fn(usize) -> Vec<f64>| (0..JOINTS).flat_map(series).collect::<Vec<f64>>();
    let by = |j: usize, n: usize| if j == joint { by_rad(n) } else { 0.0 };
    let position = of(&|j| view.position_rad(j).iter().enumerate().map(|(n, q)| q + by(j, n)).collect());
    let velocity = of(&|j| view.velocity_rad_s(j).to_vec());
    let acceleration = of(&|j| view.acceleration_rad_s2(j).to_vec());
    let real = Motion::new(JOINTS, view.time_s().to_vec(), position, velocity, acceleration).unwrap();
    let mut found = vec![0.0; JOINTS * SAMPLES];
    body.torque(real.view(), standard, &mut found, SAMPLES);
    found
}

fn some_parameters() -> Vec<f64> {
    (0..10 * JOINTS).map(|p| 0.3 + 0.37 * (p as f64 * 1.7).sin().abs()).collect()
}

#[test]
fn the_planar_arm_obeys_lagrange() {
    // Power balance: τ·q̇ is the rate of the kinetic and potential energy of the links.
    let body = PlanarArm { gravity_m_s2: [0.8, -9.6, 0.0], ..PlanarArm::new(JOINTS) };
    let standard = some_parameters();
    let dense = Recording::closed(1, JOINTS, 20_001, 1, 0.5, 2.0);
    let tau = torque(&body, &dense, &standard);
    let energy = |n: usize| {
        let (mut angle, mut rate, mut p, mut v, mut sum) = (0.0_f64, 0.0, [0.0; 2], [0.0; 2], 0.0);
        for link in 0..JOINTS {
            angle += dense.joint(link).position_rad[n];
            rate += dense.joint(link).velocity_rad_s[n];
            let (sin, cos) = angle.sin_cos();
            let own = &standard[10 * link..10 * link + 10];
            let s = [own[6] * cos - own[7] * sin, own[6] * sin + own[7] * cos];
            let ds = [-rate * s[1], rate * s[0]];
            sum += 0.5 * own[9] * (v[0] * v[0] + v[1] * v[1]) + v[0] * ds[0] + v[1] * ds[1];
            sum += 0.5 * own[5] * rate * rate;
            sum -= 0.8 * (own[9] * p[0] + s[0]) - 9.6 * (own[9] * p[1] + s[1]);
            let length = body.lengths_m[link];
            p = [p[0] + length * cos, p[1] + length * sin];
            v = [v[0] - length * rate * sin, v[1] + length * rate * cos];
        }
        sum
    };
    for n in (100..19_900).step_by(700) {
        let dt = dense.joint(0).time_s[1] - dense.joint(0).time_s[0];
        let rate = (energy(n + 1) - energy(n - 1)) / (2.0 * dt);
        let power: f64 =
            (0..JOINTS).map(|j| tau[j * dense.samples() + n] * dense.joint(j).velocity_rad_s[n]).sum();
        assert_close(power, rate, 1e-5, "power");
    }
}

#[test]
fn a_payload_is_the_difference_that_it_makes_to_its_link() {
    let body = PlanarArm::new(JOINTS);
    let recording = Recording::random(4, JOINTS, SAMPLES);
    let standard = some_parameters();
    for link in 0..JOINTS {
        let load = [0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.3, -0.2, 0.1, 2.8];
        let mut loaded = standard.clone();
        loaded[10 * link..10 * link + 10].iter_mut().zip(load).for_each(|(p, x)| *p += x);
        let (before, after) = (torque(&body, &recording, &standard), torque(&body, &recording, &loaded));
        let term = Payload { link: Some(link), parameters: None };
        let columns = evaluate(&term, &body, &recording, &[]).unwrap();
        for joint in 0..=link {
            for n in 0..SAMPLES {
                let made: f64 = (0..10).map(|k| load[k] * columns[joint * 10 + k][n]).sum();
                let i = joint * SAMPLES + n;
                assert_close(made, after[i] - before[i], 1e-10, "payload");
            }
        }
    }
    let term = Payload { link: None, parameters: Some(vec![Inertial::M, Inertial::MX]) };
    let names: Vec<String> = term.columns(6).into_iter().map(|p| p.name).collect();
    assert_eq!(names, ["m_5", "mX_5"]);
}

#[test]
fn a_payload_needs_ten_parameters_per_link() {
    let body = PlanarArm::new(JOINTS);
    let recording = Recording::random(4, JOINTS, 10);
    let motion = recording.motion();
    let series = recording.arm(motion.view(), 0, &body);
    let mut data = vec![0.0; 300];
    let mut out = aurt_traits::Columns::new(&mut data, 30, 10, 10);
    let result = Payload::default().evaluate(&series, &mut [21.0], &mut out);
    assert!(matches!(result, Err(ModelError::Evaluation { .. })), "{result:?}");
}

#[test]
fn a_tilt_is_the_derivative_with_respect_to_the_mounting() {
    let body = PlanarArm::new(JOINTS);
    let recording = Recording::random(7, JOINTS, SAMPLES);
    let standard = some_parameters();
    let term = |around_rad: &[f64]| BaseTilt {
        inertial_columns: (0..10 * JOINTS).collect(),
        inertial_values: standard.clone(),
        around_rad: around_rad.to_vec(),
        first_axis: true,
    };
    let columns = evaluate(&term(&[]), &body, &recording, &[]).unwrap();
    let [x, y, z] = body.gravity_m_s2;
    let angle = 1e-4_f64;
    let (sin, cos) = angle.sin_cos();
    // The base frame turned by +angle sees gravity turned by −angle.
    let tilted = [[x, cos * y + sin * z, cos * z - sin * y], [cos * x - sin * z, y, cos * z + sin * x]];
    let level = torque(&body, &recording, &standard);
    for (k, gravity) in tilted.into_iter().enumerate() {
        let other = torque(&*body.with_gravity(gravity), &recording, &standard);
        for joint in 0..JOINTS {
            for n in 0..SAMPLES {
                let i = joint * SAMPLES + n;
                assert_close(columns[joint * 4 + k][n], (other[i] - level[i]) / angle, 2e-3, "tilt");
            }
        }
    }
    assert!(columns[0].iter().any(|x| x.abs() > 1.0) && columns[1].iter().any(|x| x.abs() > 0.1));
    for n in 0..SAMPLES {
        assert_close(columns[2][n], recording.joint(0).position_rad[n].sin(), 1e-15, "sin q0");
        assert_eq!(columns[4 + 2][n], 0.0);
    }
    // Turned by roll, then by pitch about its own axis, it sees R_y(pitch)ᵀ R_x(roll)ᵀ g.
    for [roll, pitch] in [[0.3, -0.4], [0.3, 0.0], [0.0, 0.2]] {
        let columns = evaluate(&term(&[roll, pitch]), &body, &recording, &[]).unwrap();
        let [h_y, h_z] = [roll.cos() * y + roll.sin() * z, roll.cos() * z - roll.sin() * y];
        let gravity = [pitch.cos() * x - pitch.sin() * h_z, h_y, pitch.cos() * h_z + pitch.sin() * x];
        let other = torque(&*body.with_gravity(gravity), &recording, &standard);
        for i in 0..JOINTS * SAMPLES {
            let of = |k: usize| columns[(i / SAMPLES) * 4 + k][i % SAMPLES];
            assert_close(roll * of(0) + pitch * of(1), other[i] - level[i], 1e-10, "tilt around");
        }
    }
}

#[test]
fn an_encoder_offset_is_the_torque_at_the_real_angle() {
    let body = PlanarArm::new(JOINTS);
    let shown = Recording::random(7, JOINTS, SAMPLES);
    let standard = some_parameters();
    let term = |around_rad: &[f64]| EncoderOffset {
        joints: JointSelection::of(vec![1, 2]),
        around_rad: around_rad.to_vec(),
        inertial_columns: (0..standard.len()).collect(),
        inertial_values: standard.clone(),
    };
    let expected = torque(&body, &shown, &standard);
    let trials = [(0, 1, 1e-4, 0.0), (1, 2, 1e-4, 0.0), (0, 1, 0.3, 0.3), (1, 2, -0.3, -0.3)];
    for (k, joint, offset, around) in trials {
        let columns = evaluate(&term(&[around; 2]), &body, &shown, &[]).unwrap();
        let found = turned_torque(&body, &shown, &standard, joint, |_| -offset);
        for i in 0..JOINTS * SAMPLES {
            let column = &columns[(i / SAMPLES) * 2 + k];
            assert_close(
                column[i % SAMPLES],
                (found[i] - expected[i]) / offset,
                if around == 0.0 { 2e-3 } else { 1e-12 },
                "offset",
            );
        }
        assert!(columns[2 + k].iter().any(|x| x.abs() > 1.0));
    }
    assert_eq!(term(&[0.1]).validate(JOINTS).unwrap_err().len(), 1);
    let unknown = evaluate(&EncoderOffset::default(), &body, &shown, &[]).unwrap();
    assert!(unknown.iter().flatten().all(|x| *x == 0.0) && unknown.len() == JOINTS * JOINTS);
}

#[test]
fn a_compliant_joint_has_the_torque_of_its_link() {
    let body = PlanarArm::new(JOINTS);
    let shown = Recording::random(8, JOINTS, SAMPLES);
    let standard = some_parameters();
    let joint = 1;
    let term = |around_rad_nm: &[f64]| JointCompliance {
        joints: JointSelection::of(vec![joint]),
        around_rad_nm: around_rad_nm.to_vec(),
        inertial_columns: (0..standard.len()).collect(),
        inertial_values: standard.clone(),
    };
    let rigid = torque(&body, &shown, &standard);
    let mass = rigid[joint * SAMPLES..(joint + 1) * SAMPLES].iter().fold(0.0_f64, |m, t| m.max(t.abs()));
    // The largest load turns the joint by a fiftieth of a radian.
    let compliance = 0.02 / mass;
    let mut moved = rigid.clone();
    for _ in 0..50 {
        moved = turned_torque(&body, &shown, &standard, joint, |n| -compliance * moved[joint * SAMPLES + n]);
    }
    let largest = |error: &dyn Fn(usize, usize) -> f64| {
        let all = (0..JOINTS).flat_map(|j| (0..SAMPLES).map(move |n| (j, n)));
        all.map(|(j, n)| error(j, n).abs()).fold(0.0, f64::max)
    };
    let change = |j: usize, n: usize| moved[j * SAMPLES + n] - rigid[j * SAMPLES + n];
    let size = largest(&change);
    for (around, tolerance) in [(0.0, 0.1), (compliance, 1e-4)] {
        let columns = evaluate(&term(&[around]), &body, &shown, &[]).unwrap();
        let error = largest(&|j, n| compliance * columns[j][n] - change(j, n));
        assert!(error < tolerance * size && size > 0.1, "{error} of {size} around {around}");
    }
    assert_eq!(term(&[0.1, 0.1]).validate(JOINTS).unwrap_err().len(), 1);
    let unknown = evaluate(&JointCompliance::default(), &body, &shown, &[]).unwrap();
    assert!(unknown.iter().flatten().all(|x| *x == 0.0) && unknown.len() == JOINTS * JOINTS);
}

#[test]
fn a_tilt_of_unknown_bodies_is_zero() {
    let columns =
        evaluate(&BaseTilt::default(), &PlanarArm::new(2), &Recording::random(1, 2, 20), &[]).unwrap();
    assert!(columns.iter().flatten().all(|x| *x == 0.0) && columns.len() == 4);
}

#[test]
fn a_coupled_motor_spends_its_power_on_both_joints() {
    let body = PlanarArm::new(6);
    let recording = Recording::random(9, 6, SAMPLES);
    let term = Coupling {
        joint: 5,
        partner: 4,
        ratio: -1.7,
        inertia: true,
        viscous: true,
        coulomb: true,
        rest_velocity_rad_s: 0.0,
    };
    assert_eq!(term.joints(6), [4, 5]);
    let columns = evaluate(&term, &body, &recording, &[]).unwrap();
    let (own, partner) = (recording.joint(5), recording.joint(4));
    for n in 0..SAMPLES {
        let speed = own.velocity_rad_s[n] - 1.7 * partner.velocity_rad_s[n];
        let acceleration = own.acceleration_rad_s2[n] - 1.7 * partner.acceleration_rad_s2[n];
        let sign = if speed == 0.0 { 0.0 } else { speed.signum() };
        for (k, force) in [acceleration, speed, sign].into_iter().enumerate() {
            let power = columns[k][n] * partner.velocity_rad_s[n] + columns[3 + k][n] * own.velocity_rad_s[n];
            assert_close(power, force * speed, 1e-12, "power");
            assert_close(columns[3 + k][n], force, 1e-12, "own row");
        }
    }
}

#[test]
fn half_the_difference_of_driving_and_driven_is_a_gain() {
    let term = DriveEfficiency { joints: JointSelection::of(vec![1]) };
    let recording = Recording::random(13, 2, SAMPLES);
    let columns = evaluate(&term, &PlanarArm::new(2), &recording, &[]).unwrap();
    let series = recording.joint(1);
    for n in 0..SAMPLES {
        let (v, load) = (series.velocity_rad_s[n], series.load_torque[n]);
        let moving = if v == 0.0 { 0.0 } else { 1.0 };
        assert_close(columns[0][n] - columns[1][n], load * moving, 1e-12, "odd part");
        assert_close(columns[0][n] + columns[1][n], load.abs() * v.signum() * moving, 1e-12, "even part");
    }
}

#[test]
fn a_counterbalance_is_the_slope_of_its_energy() {
    let (a, b, dead_centre, stiffness, rest) = (0.12, 0.45, 0.3, 9_000.0, 0.25);
    let term = Counterbalance { joint: 0, crank_m: a, anchor_m: b, dead_centre_rad: dead_centre };
    let recording = Recording::random(2, 1, SAMPLES);
    let columns = evaluate(&term, &PlanarArm::new(1), &recording, &[]).unwrap();
    let energy = |q: f64| {
        let angle = q - dead_centre;
        let length = (a * a + b * b - 2.0 * a * b * angle.cos()).sqrt();
        0.5 * stiffness * (length - rest) * (length - rest)
    };
    for (n, q) in recording.joint(0).position_rad.iter().enumerate() {
        let slope = (energy(q + 1e-5) - energy(q - 1e-5)) / 2e-5;
        let held = stiffness * columns[0][n] + stiffness * rest * columns[1][n];
        assert_close(held, slope, 1e-6, "counterbalance");
    }
}

#[test]
fn damped_lugre_adds_the_bristles_velocity() {
    // Column 2 is ż with z = p H; a fine sampling lets it be compared with the differences of column 1.
    let term = LuGreDamped { presliding_rad: 0.02, ..LuGreDamped::default() };
    let recording = Recording::closed(3, 1, 200_001, 1, 0.2, 2.0);
    let columns = evaluate(&term, &PlanarArm::new(1), &recording, &[]).unwrap();
    let plain = LuGre { presliding_rad: 0.02, ..LuGre::default() };
    let undamped = aurt_friction::conformance::joint::evaluate(&plain, &recording.joint(0), &[]).unwrap();
    assert_eq!(columns[0], undamped[0]);
    let dt = recording.joint(0).time_s[1];
    for n in (1_000..199_000).step_by(997) {
        let rate = 0.02 * (columns[0][n + 1] - columns[0][n - 1]) / (2.0 * dt);
        assert!((rate - columns[1][n]).abs() < 2e-3, "sample {n}: {rate} and {}", columns[1][n]);
    }
}

#[test]
fn ripple_repeats_with_the_angle() {
    let term =
        TorqueRipple { cycles_per_revolution: 202.0, orders: vec![1, 3], joints: JointSelection::all() };
    let recording = Recording::random(2, 1, SAMPLES);
    let columns = evaluate(&term, &PlanarArm::new(1), &recording, &[]).unwrap();
    for (n, q) in recording.joint(0).position_rad.iter().enumerate() {
        let turned = q + std::f64::consts::TAU / 202.0;
        assert_close(columns[0][n], (202.0 * turned).sin(), 1e-11, "order 1");
        assert_close(columns[3][n], (606.0 * turned).cos(), 1e-11, "order 3");
    }
}

#[test]
fn joints_beyond_the_robot_are_refused_with_every_complaint() {
    let wrong = RotorInertia { joints: JointSelection::of(vec![2, 7, 2]) };
    let text: Vec<String> = wrong.validate(6).unwrap_err().iter().map(ToString::to_string).collect();
    assert_eq!(text.len(), 2, "{text:?}");
    assert!(text[0].contains("between 0 and 5") && text[0].contains('7'), "{text:?}");
    let coupled = Coupling {
        joint: 6,
        partner: 6,
        ratio: 0.0,
        inertia: false,
        viscous: false,
        coulomb: false,
        rest_velocity_rad_s: -1.0,
    };
    assert_eq!(coupled.validate(6).unwrap_err().len(), 6);
    assert!(Payload { link: Some(6), parameters: Some(Vec::new()) }.validate(6).is_err());
    let tilt = BaseTilt {
        inertial_columns: vec![10_000, 3, 3],
        inertial_values: vec![1.0],
        around_rad: vec![0.1],
        first_axis: false,
    };
    assert_eq!(tilt.validate(6).unwrap_err().len(), 4);
}
