//! What benchmarks work on: a UR10e's geometry, motions of many sines, and clocks.
#![allow(dead_code, clippy::allow_attributes, reason = "every benchmark uses a part")]

use std::io::Write;
use std::path::Path;
use std::time::Instant;

use aurt_plugins::{Registry, RigidBodyDynamics, SlotModel};
use aurt_rbd::{MdhRows, MdhTable};
use aurt_recording::{ReadReport, Recording};
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
    let rows: Vec<&str> = UR10E.lines().take(joints + 1).collect();
    let table = MdhTable::parse(&rows.join("\n"), "ur10e.csv", MdhRows::Next).unwrap();
    let bodies = RigidBodyDynamics::from_mdh(&table, [0.0, 0.0, -9.81], 0).unwrap();
    let stack = JointStack::new(
        build(&json!({ "model": "square" })),
        build(&json!({ "model": "sign" })),
        build(&json!({ "model": "polynomial", "powers": [1, 2, 3] })),
    )
    .unwrap();
    bodies.with_joint_dynamics(vec![stack; joints], Vec::new()).unwrap()
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
    Recording {
        file: "benchmark.csv".into(),
        position_rad: series(0),
        velocity_rad_s: None,
        measurement: Some(series(1)),
        unit: MeasurementUnit::NewtonMetre,
        report: ReadReport::default(),
        time_s,
    }
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
    let threads = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let spent = threads.filter_map(|thread| {
        let told = std::fs::read_to_string(thread.path().join("schedstat")).ok()?;
        told.split_whitespace().next()?.parse::<f64>().ok()
    });
    spent.sum::<f64>() * 1e-9
}

/// The largest memory that this process ever held, in MB; NaN where the system does not tell.
pub fn largest_memory_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.and_then(|l| l.split_whitespace().next()?.parse::<f64>().ok()).map_or(f64::NAN, |kb| kb / 1024.0)
}
