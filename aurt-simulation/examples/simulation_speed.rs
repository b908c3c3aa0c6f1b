//! How long recordings take to make, one after the other on one core:
//! `time cargo run --release -p aurt-simulation --example simulation_speed [seconds of recording]`.
//!
//! Wall time is shown per recording; on a machine that does other things too, the command's user time is the
//! figure to go by.

use std::time::Instant;

use aurt_simulation::{Motion, Robot, Scenario, SimulationError, simulate_with_traces};

fn main() -> Result<(), SimulationError> {
    let duration_s = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(40.0);
    let motions = [
        ("multi-sine", Motion::MultiSine { duration_s, harmonics: 10, top_hz: 1.0, share: 0.7 }),
        ("triangles", Motion::Triangles { duration_s, speed_rad_s: 0.1, amplitude_rad: 0.4 }),
        ("sweeps", Motion::Sweeps { duration_s, share: 0.6 }),
        ("point-to-point", Motion::PointToPoint { duration_s, share: 0.5, rest_s: 0.4 }),
    ];
    println!("robot     motion            step   evaluations  events  simulated  written");
    for robot in Robot::all() {
        for (name, motion) in &motions {
            let scenario = Scenario::new(robot.clone(), motion.plan(&robot, 3)?, 3);
            let started = Instant::now();
            let (recording, traces) = simulate_with_traces(&scenario)?;
            let simulated = started.elapsed().as_secs_f64();
            let bytes = recording.csv().len();
            println!(
                "{:9} {name:15} {:5.0} us {:12} {:7} {simulated:8.3} s {:6.3} s  {:.1} MB",
                robot.name,
                1e6 * traces.step_s,
                traces.evaluations,
                traces.events,
                started.elapsed().as_secs_f64() - simulated,
                bytes as f64 / 1e6
            );
        }
    }
    Ok(())
}
