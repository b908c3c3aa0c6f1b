//! Geometry and bodies of the robots as JSON, for programs that compute reference values:
//! `cargo run -p aurt-simulation --example robots`.

use aurt_simulation::Robot;
use serde_json::json;

fn main() {
    let robots: serde_json::Map<String, serde_json::Value> = Robot::all()
        .into_iter()
        .map(|robot| {
            let rows: Vec<[f64; 3]> = robot.mdh.iter().map(|r| [r.alpha_rad, r.a_m, r.d_m]).collect();
            let bodies: Vec<_> = robot
                .links
                .iter()
                .map(|link| {
                    json!({
                        "mass_kg": link.mass_kg,
                        "com_m": link.com_m,
                        "inertia_at_com_kg_m2": link.inertia_at_com_kg_m2,
                    })
                })
                .collect();
            let rotors: Vec<f64> = robot.drives.iter().map(|d| d.rotor_inertia_kg_m2).collect();
            let value = json!({
                "mdh": rows,
                "gravity_m_s2": robot.gravity_m_s2,
                "bodies": bodies,
                "rotor_inertia_kg_m2": rotors,
            });
            (robot.name, value)
        })
        .collect();
    println!("{}", serde_json::Value::Object(robots));
}
