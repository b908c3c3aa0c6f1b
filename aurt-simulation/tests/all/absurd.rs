//! Scenarios with numbers that no robot has: each is simulated or refused, and what is recorded is finite.

use aurt_simulation::effects::{Draw, Shapes, catalogue};
use aurt_simulation::{Random, Robot, ScenarioFile, simulate};
use toml::Value;

const SCENARIO: &str = r#"
robot = "two_link"
seed = 7
[motion]
kind = "multi_sine"
duration_s = 3.0
harmonics = 2
top_hz = 0.8
share = 0.5
[controller]
bandwidth_hz = 25.0
damping_ratio = 0.9
feed_forward = 1.0
friction_feed_forward = 1.0
friction_width_rad_s = 5e-4
[logger]
rate_hz = 100.0
clock_jitter_s = 1e-4
[[link]]
index = 1
mass_kg = 2.0
com_m = [0.2, 0.0, 0.1]
inertia_at_com_kg_m2 = [0.1, 0.0, 0.0, 0.1, 0.0, 0.1]
[[drive]]
joint = 1
rotor_inertia_kg_m2 = 0.1
torque_constant_nm_per_a = 10.0
coulomb_nm = 2.0
viscous_nm_s = 3.0
load_coefficient = 0.05
home_rad = 0.1
encoder_resolution_rad = 1e-5
encoder_noise_rad = 1e-5
torque_noise_nm = 0.1
"#;

/// Beyond what products, squares and quotients of numbers can be.
const ABSURD: [f64; 5] = [1e308, -1e308, 1e160, 1e-308, 5e-324];

/// The number at a place in the order of a walk through a value, if there are as many.
fn number<'v>(value: &'v mut Value, place: &mut usize) -> Option<&'v mut f64> {
    match value {
        Value::Float(number) if *place == 0 => Some(number),
        Value::Float(_) => {
            *place -= 1;
            None
        }
        Value::Array(values) => values.iter_mut().find_map(|value| number(value, place)),
        Value::Table(table) => table.iter_mut().find_map(|(_, value)| number(value, place)),
        _ => None,
    }
}

/// Simulates with each of the numbers of a part of the scenario replaced by absurd ones.
fn each_replaced(scenario: &toml::Table, part: &str) {
    for place in 0.. {
        for absurd in ABSURD {
            let mut changed = scenario.clone();
            let Some(found) = number(&mut changed[part], &mut { place }) else { return };
            *found = absurd;
            let text = toml::to_string(&changed).unwrap();
            let planned = ScenarioFile::parse(&text, "absurd.toml").and_then(|file| file.scenario());
            let Ok(recording) = planned.and_then(|scenario| simulate(&scenario)) else { continue };
            let mut values = recording.position_rad.iter().chain(&recording.measurement);
            assert!(values.all(|value| value.is_finite()), "{part}, number {place}: {absurd:e}");
        }
    }
}

#[test]
fn absurd_robots_motions_and_loggers_are_refused_or_simulated() {
    let scenario: toml::Table = SCENARIO.parse().unwrap();
    for part in ["motion", "controller", "logger", "link", "drive"] {
        each_replaced(&scenario, part);
    }
}

#[test]
fn absurd_effects_are_refused_or_simulated() {
    let mut scenario: toml::Table = SCENARIO.parse().unwrap();
    let robot = Robot::named("two_link").unwrap();
    for kind in catalogue() {
        let random = &mut Random::new(5);
        let draw = Draw {
            robot: &robot,
            joints: &kind.choose_joints(&robot, random),
            peak_torque_nm: &[50.0; 2],
            duration_s: 3.0,
            shapes: Shapes::Usual,
        };
        let mut effect = Value::try_from(kind.draw(&draw, random).fields()).unwrap();
        effect.as_table_mut().unwrap().insert("name".into(), kind.identifier.into());
        scenario.insert("effect".into(), Value::Array(vec![effect]));
        each_replaced(&scenario, "effect");
    }
}
