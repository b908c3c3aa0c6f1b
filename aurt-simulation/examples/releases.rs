//! Arms that are let go without friction and without torque, as JSON, for comparison with other engines:
//! `cargo run --release -p aurt-simulation --example releases`.
//!
//! For each robot its geometry and bodies, the state at the beginning, and the joint angles every 0.1 s.

use aurt_simulation::plant::{Machine, Release, TRACE_STEP_S};
use aurt_simulation::{Robot, SimulationError};
use serde_json::{Map, Value, json};

const DURATION_S: f64 = 5.0;
/// Trace samples from one that is written to the next.
const EVERY: usize = 50;

fn released(mut robot: Robot) -> Result<(String, Value), SimulationError> {
    for drive in &mut robot.drives {
        (drive.coulomb_nm, drive.viscous_nm_s, drive.load_coefficient) = (0.0, 0.0, 0.0);
    }
    let n = robot.joints();
    let release = Release {
        start_rad: robot.drives.iter().enumerate().map(|(j, d)| d.home_rad + 0.2 * j as f64).collect(),
        start_rad_s: (0..n).map(|j| 0.8 - 0.3 * j as f64).collect(),
        torque_nm: vec![0.0; n],
        duration_s: DURATION_S,
        steps: None,
    };
    let traces = release.run(Machine::new(&robot))?;
    let rows: Vec<[f64; 3]> = robot.mdh.iter().map(|r| [r.alpha_rad, r.a_m, r.d_m]).collect();
    let bodies = robot.links.iter().map(|link| {
        json!({
            "mass_kg": link.mass_kg,
            "com_m": link.com_m,
            "inertia_at_com_kg_m2": link.inertia_at_com_kg_m2,
        })
    });
    let kept = (0..traces.samples).step_by(EVERY);
    let positions: Vec<&[f64]> = kept.map(|k| &traces.position_rad[k * n..(k + 1) * n]).collect();
    let value = json!({
        "mdh": rows,
        "gravity_m_s2": robot.gravity_m_s2,
        "bodies": bodies.collect::<Vec<_>>(),
        "rotor_inertia_kg_m2": robot.drives.iter().map(|d| d.rotor_inertia_kg_m2).collect::<Vec<_>>(),
        "start_rad": release.start_rad,
        "start_rad_s": release.start_rad_s,
        "every_s": EVERY as f64 * TRACE_STEP_S,
        "position_rad": positions,
    });
    Ok((robot.name, value))
}

fn main() -> Result<(), SimulationError> {
    let robots = Robot::all().into_iter().map(released).collect::<Result<Map<String, Value>, _>>()?;
    println!("{}", Value::Object(robots));
    Ok(())
}
