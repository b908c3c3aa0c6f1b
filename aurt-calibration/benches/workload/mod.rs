//! What benchmarks work on: a UR10e's geometry, motions of many sines, and clocks.
#![allow(dead_code, clippy::allow_attributes, reason = "every benchmark uses a part")]

use std::io::Write;
use std::path::Path;
use std::time::Instant;

use aurt_plugins::model::RigidBodyDynamics;
use aurt_plugins::{Registry, SlotModel};
use aurt_rbd::{MdhRows, MdhTable};
use aurt_recording::Recording;
use aurt_traits::{JointStack, MeasurementUnit, RobotModel};
use serde_json::{Value, json};

const UR10E: &str =
    "alpha,a,d\npi/2,0,0.1807\n0,-0.6127,0\n0,-0.57155,0\npi/2,0,0.17415\n-pi/2,0,0.11985\n0,0,0.11655\n";

/// Rate of the recordings, Hz.
pub const RATE_HZ: f64 = 500.0;

fn build<M: SlotModel + ?Sized>(configuration: &Value) -> Box<M> {
    Registry::linked().unwrap().build_from_json(configuration).unwrap()
}

/// The first `joints` joints of a UR10e with the friction of the paper: Coulomb friction square in load, no memory,
/// viscous powers 1, 2, 3.
pub fn model(joints: usize) -> RobotModel {
    with_friction(&bodies(joints), &json!({ "model": "square" }), &json!({ "model": "sign" }), &[1, 2, 3])
}

/// The rigid bodies of the first `joints` joints of a UR10e.
pub fn bodies(joints: usize) -> RigidBodyDynamics {
    let rows: Vec<&str> = UR10E.lines().take(joints + 1).collect();
    let table = MdhTable::parse(&rows.join("\n"), "ur10e.csv", MdhRows::Next).unwrap();
    RigidBodyDynamics::from_mdh(&table, [0.0, 0.0, -9.81], 0).unwrap()
}

/// Rigid bodies with the same friction in all joints.
pub fn with_friction(
    bodies: &RigidBodyDynamics,
    coulomb: &Value,
    hysteresis: &Value,
    powers: &[u32],
) -> RobotModel {
    let joints = bodies.rigid_body.joints();
    let viscous = build(&json!({ "model": "polynomial", "powers": powers }));
    let stack = JointStack::new(build(coulomb), build(hysteresis), viscous).unwrap();
    bodies.clone().with_joint_dynamics(vec![stack; joints], Vec::new()).unwrap()
}

/// The linear friction models of `examples/ur10e_hundred_variants.toml`: every Coulomb model with every model of
/// hysteresis and every viscous polynomial.
pub fn variants(bodies: &RigidBodyDynamics) -> Vec<RobotModel> {
    let slip = |elements: usize| json!({ "model": "maxwell_slip", "elements": elements });
    let plain = |name: &str| json!({ "model": name });
    let hystereses = [plain("sign"), plain("tanh"), plain("dahl"), slip(2), slip(3), slip(4), slip(5)];
    let powers: [&[u32]; 5] = [&[1], &[1, 2], &[1, 3], &[1, 2, 3], &[1, 2, 3, 4]];
    let mut models = Vec::new();
    for coulomb in ["constant", "square", "absolute"] {
        for hysteresis in &hystereses {
            for powers in powers {
                models.push(with_friction(bodies, &plain(coulomb), hysteresis, powers));
            }
        }
    }
    models
}

/// Angle and torque of a joint at a time; the torque is some smooth function of the motion.
fn sample(joint: usize, t: f64) -> [f64; 2] {
    let mut angle = 0.0;
    let mut torque = 0.0;
    for k in 0..4 {
        let omega = std::f64::consts::TAU * (0.07 + 0.19 * f64::from(k) + 0.013 * joint as f64);
        let (sin, cos) = libm::sincos(omega * t + joint as f64 + 1.7 * f64::from(k));
        angle += 0.5 / f64::from(k + 1) * sin;
        torque += 5.0 * cos - 3.0 * omega * sin + 2.0 * cos.signum();
    }
    [angle, torque + libm::sin(1e4 * angle)]
}

/// A recording of so many samples.
pub fn recording(joints: usize, samples: usize) -> Recording {
    let time_s: Vec<f64> = (0..samples).map(|k| k as f64 / RATE_HZ).collect();
    let series =
        |what: usize| (0..joints).map(|j| time_s.iter().map(|t| sample(j, *t)[what]).collect()).collect();
    let (position, torque) = (series(0), series(1));
    let recording = Recording::from_arrays(time_s, position).unwrap();
    recording.with_measurement(torque, MeasurementUnit::NewtonMetre).unwrap()
}

/// Writes such a recording as a table, without holding it.
pub fn write_csv(path: &Path, joints: usize, samples: usize) {
    let mut file = std::io::BufWriter::new(std::fs::File::create(path).unwrap());
    let names = |what: &str| (0..joints).map(|j| format!(",{what}_{j}")).collect::<String>();
    writeln!(file, "time{}{}", names("q"), names("torque")).unwrap();
    for k in 0..samples {
        let t = k as f64 / RATE_HZ;
        write!(file, "{t:.3}").unwrap();
        for what in 0..2 {
            for joint in 0..joints {
                write!(file, ",{:.6}", sample(joint, t)[what]).unwrap();
            }
        }
        writeln!(file).unwrap();
    }
    file.flush().unwrap();
}

/// Seconds that the processor spent on this thread; what other programs do in the meantime does not count. Where the
/// system does not tell, the time that went by.
pub fn processor_s() -> f64 {
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    // The kernel brings the account of a thread up to date when it yields, and else at its next tick, 4 ms later.
    std::thread::yield_now();
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|t| t.split_whitespace().next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| START.get_or_init(Instant::now).elapsed().as_secs_f64(), |n| n * 1e-9)
}

/// Median and extremes of some rounds.
pub fn summary(rounds: &mut [f64]) -> [f64; 3] {
    rounds.sort_by(f64::total_cmp);
    [rounds[rounds.len() / 2], rounds[0], rounds[rounds.len() - 1]]
}

/// The number behind an option, if it was given.
pub fn option(name: &str) -> Option<usize> {
    let mut arguments = std::env::args().skip_while(|a| a != name);
    arguments.nth(1).and_then(|value| value.parse().ok())
}

/// Seconds that processors spent on all threads of this process.
pub fn process_s() -> f64 {
    scheduled_s(0)
}

/// Seconds that threads of this process were ready to run while the processors did something else, added up.
pub fn waited_s() -> f64 {
    scheduled_s(1)
}

/// A place of the kernel's account of each thread (time run, time waited), summed over all threads.
fn scheduled_s(place: usize) -> f64 {
    std::thread::yield_now();
    let threads = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let spent = threads.filter_map(|thread| {
        let told = std::fs::read_to_string(thread.path().join("schedstat")).ok()?;
        told.split_whitespace().nth(place)?.parse::<f64>().ok()
    });
    spent.sum::<f64>() * 1e-9
}

/// The largest memory that this process ever held, in MB; NaN where the system does not tell.
pub fn largest_memory_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.and_then(|l| l.split_whitespace().next()?.parse::<f64>().ok()).map_or(f64::NAN, |kb| kb / 1024.0)
}
