//! Scenarios with numbers that no robot has: each is simulated or refused, and what is recorded is finite.

use aurt_simulation::effects::{Draw, Shapes, catalogue};
use aurt_simulation::{Random, Robot, ScenarioFile, simulate};
use toml::Value;

const SCENARIO: &str = include_str!("absurd.toml");

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
