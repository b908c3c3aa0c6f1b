//! A two-link arm in a vertical plane whose torques come from its closed-form equations of motion, moved by
//! multi-sines, with friction that each test integrates by itself.

use aurt_calibration::NamedRecording;
use aurt_plugins::model::RigidBodyDynamics;
use aurt_plugins::{Registry, SlotModel};
use aurt_rbd::{MdhRows, MdhTable};
use aurt_recording::{PreprocessOptions, Recording, preprocess};
use aurt_traits::{ArmTerm, JointStack, MeasurementUnit, RobotModel};
use serde_json::{Value, json};

use crate::known_robot::Normal;

const LENGTH_M: f64 = 0.5;
const GRAVITY_M_S2: f64 = 9.81;

/// The arm's model with the same stack on both joints.
pub fn model(coulomb: Value, hysteresis: Value, viscous: Value, terms: &[Value]) -> RobotModel {
    let table =
        MdhTable::parse(&format!("alpha,a,d\n0,{LENGTH_M},0\n0,0,0\n"), "mdh.csv", MdhRows::Next).unwrap();
    let bodies = RigidBodyDynamics::from_mdh(&table, [0.0, -GRAVITY_M_S2, 0.0], 0).unwrap();
    let stack = JointStack::new(build(&coulomb), build(&hysteresis), build(&viscous)).unwrap();
    let terms = terms.iter().map(build::<dyn ArmTerm>).collect();
    bodies.with_joint_dynamics(vec![stack.clone(), stack], terms).unwrap()
}

fn build<M: SlotModel + ?Sized>(configuration: &Value) -> Box<M> {
    Registry::linked().unwrap().build_from_json(configuration).unwrap()
}

/// `{ model = name }`.
pub fn named(name: &str) -> Value {
    json!({ "model": name })
}

/// Viscous friction in proportion to velocity.
pub fn linear() -> Value {
    json!({ "model": "polynomial", "powers": [1] })
}

/// A level that grows with the load, smoothed at rest, and viscous friction on both joints.
pub fn load_dependent_friction() -> [Friction; 2] {
    [1.0, 0.6].map(|scale| -> Friction {
        Box::new(move |[_, v, _], load| scale * ((2.0 + 0.1 * load.abs()) * (v / 1e-3).tanh() + 3.0 * v))
    })
}

/// Amplitudes in rad and frequencies in Hz of the motion of a joint.
pub type Sines = &'static [(f64, f64, f64)];

/// A motion with slow and fast parts and many reversals of unequal size.
pub const RICH: [Sines; 2] = [
    &[(0.5, 0.11, 0.3), (0.12, 0.37, 1.1), (0.03, 0.83, 2.0), (0.008, 1.31, 0.7)],
    &[(0.4, 0.13, 1.9), (0.15, 0.29, 0.2), (0.04, 0.71, 0.9), (0.01, 1.19, 2.6)],
];

/// Position, velocity and acceleration at a time.
pub fn motion(sines: Sines, t: f64) -> [f64; 3] {
    let mut motion = [0.0; 3];
    for (amplitude, hertz, phase) in sines {
        let w = std::f64::consts::TAU * hertz;
        let (sin, cos) = (w * t + phase).sin_cos();
        motion[0] += amplitude * sin;
        motion[1] += amplitude * w * cos;
        motion[2] -= amplitude * w * w * sin;
    }
    motion
}

/// Torques of the two links in a plane, gravity along −y, both angles zero along x (textbook form).
pub fn rigid_torques([q1, v1, a1]: [f64; 3], [q2, v2, a2]: [f64; 3]) -> [f64; 2] {
    let (m1, c1, i1) = (4.0, 0.22, 0.35);
    let (m2, c2, i2) = (2.5, 0.18, 0.14);
    let (l, g) = (LENGTH_M, GRAVITY_M_S2);
    let coupling = m2 * l * c2;
    let m12 = i2 + coupling * q2.cos();
    let m11 = i1 + i2 + m2 * l * l + 2.0 * coupling * q2.cos();
    let far = m2 * c2 * g * (q1 + q2).cos();
    [
        m11 * a1 + m12 * a2 - coupling * q2.sin() * (2.0 * v1 * v2 + v2 * v2)
            + (m1 * c1 + m2 * l) * g * q1.cos()
            + far,
        m12 * a1 + i2 * a2 + coupling * q2.sin() * v1 * v1 + far,
    ]
}

/// Friction of a joint, moved on by one fine step: time, motion, load torque → torque.
pub type Friction = Box<dyn FnMut([f64; 3], f64) -> f64>;

/// Samples per second of a recording, and steps of the friction's integration per sample.
pub const RATE_HZ: f64 = 500.0;
/// Fine steps between two samples.
pub const FINE: usize = 10;

/// A recording of `duration_s` seconds, with white noise on the torques.
pub fn recording(
    name: &str,
    sines: [Sines; 2],
    (start_s, duration_s): (f64, f64),
    mut friction: [Friction; 2],
    noise_nm: f64,
) -> NamedRecording {
    let samples = (duration_s * RATE_HZ) as usize;
    let (mut time_s, mut position, mut torque) = (Vec::new(), vec![Vec::new(); 2], vec![Vec::new(); 2]);
    let mut noise = Normal(0x9E37_79B9_7F4A_7C15);
    for k in 0..samples * FINE {
        let t = start_s + k as f64 / (RATE_HZ * FINE as f64);
        let state = sines.map(|s| motion(s, t));
        let rigid = rigid_torques(state[0], state[1]);
        let dry: Vec<f64> = (0..2).map(|j| friction[j](state[j], rigid[j])).collect();
        if k % FINE == 0 {
            time_s.push(k as f64 / (RATE_HZ * FINE as f64));
            for joint in 0..2 {
                position[joint].push(state[joint][0]);
                torque[joint].push(rigid[joint] + dry[joint] + noise_nm * noise.next());
            }
        }
    }
    let recording = Recording::from_arrays(time_s, position).unwrap().named(name);
    let recording = recording.with_measurement(torque, MeasurementUnit::NewtonMetre).unwrap();
    NamedRecording { name: name.into(), data: preprocess(&recording, &PreprocessOptions::new(10.0)).unwrap() }
}
