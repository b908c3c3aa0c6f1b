//! Every effect, of the vocabulary and outside of it: what is drawn is valid, acts, and is refused where it cannot be.

use aurt_lab::effects::{all_kinds, kind, read_effect};
use aurt_simulation::effects::{Draw, Effect, EffectKind, Factor, Shapes};
use aurt_simulation::{Motion, Random, Robot, Rotors, Scenario, robots, simulate};
use serde_json::Value;

fn drawn(kind: &EffectKind, robot: &Robot, seed: u64) -> Box<dyn Effect> {
    drawn_of(kind, robot, seed, Shapes::Usual)
}

fn drawn_of(kind: &EffectKind, robot: &Robot, seed: u64, shapes: Shapes) -> Box<dyn Effect> {
    let mut random = Random::labelled(seed, kind.identifier);
    let joints = kind.choose_joints(robot, &mut random);
    let peak: Vec<f64> = robot.drives.iter().map(|d| 0.3 * d.torque_limit_nm).collect();
    let draw = Draw { robot, joints: &joints, peak_torque_nm: &peak, duration_s: 10.0, shapes };
    kind.draw(&draw, &mut random)
}

fn robot_for(kind: &EffectKind) -> Robot {
    robots::ur10e().with_rotors(kind.rotors.unwrap_or(Rotors::Geared))
}

/// Every effect that is drawn is valid, names itself as its kind does, survives its fields and scaling.
#[test]
fn every_kind_draws_valid_effects() {
    for kind in all_kinds() {
        for seed in 0..24 {
            let robot = robot_for(kind);
            let shapes = if seed % 2 == 0 { Shapes::Usual } else { Shapes::Continuum };
            let mut effect = drawn_of(kind, &robot, seed, shapes);
            assert_eq!(effect.identifier(), kind.identifier);
            effect.validate(&robot).unwrap();
            let copy = read_effect(kind.identifier, effect.fields()).unwrap();
            assert_eq!(copy.fields(), effect.fields());
            for factor in [0.1, 1e3, 1e-6, 1e9] {
                effect.scale(Factor::Uniform(factor), &robot);
                effect.validate(&robot).unwrap_or_else(|e| panic!("{} × {factor}: {e}", kind.identifier));
            }
        }
    }
}

#[test]
fn every_kind_can_be_simulated_and_changes_the_recording() {
    let motion = Motion::MultiSine { duration_s: 6.0, harmonics: 5, top_hz: 1.0, share: 0.5 };
    for kind in all_kinds() {
        let robot = robot_for(kind);
        let trajectory = motion.plan(&robot, 1).unwrap();
        let mut scenario = Scenario::new(robot.clone(), trajectory, 1);
        let without = simulate(&scenario).unwrap();
        scenario.effects.push(drawn(kind, &robot, 5));
        let with = simulate(&scenario).unwrap_or_else(|e| panic!("{}: {e}", kind.identifier));
        assert_ne!(with.csv(), without.csv(), "{}", kind.identifier);
        assert!(with.measurement.iter().all(|m| m.is_finite()));
    }
}

#[test]
fn joints_that_are_not_there_are_refused() {
    for kind in all_kinds() {
        let robot = robot_for(kind);
        let mut fields = drawn(kind, &robot, 5).fields();
        let Some(object) = fields.as_object_mut() else { panic!("no object") };
        let mut changed = false;
        for key in ["joints", "joint", "partner", "link", "other"] {
            if let Some(value) = object.get_mut(key) {
                changed = true;
                if let Some(first) = value.as_array_mut().and_then(|a| a.first_mut()) {
                    *first = 9.into();
                } else {
                    *value = 9.into();
                }
                break;
            }
        }
        if changed {
            let effect = read_effect(kind.identifier, fields).unwrap();
            let text = effect.validate(&robot).unwrap_err().to_string();
            assert!(text.contains(" 9"), "{text}");
        }
    }
}

/// Shapes of the continuum lie on no grid, and fill their ranges.
#[test]
fn continuous_shapes_are_off_every_grid() {
    let robot = robots::ur10e();
    let shapes = |identifier: &str, field: &str| -> Vec<f64> {
        let kind = kind(identifier).unwrap();
        (0..60)
            .filter_map(|seed| drawn_of(kind, &robot, seed, Shapes::Continuum).fields()[field].as_f64())
            .collect()
    };
    for (identifier, field, [low, high]) in [
        ("stribeck", "exponent", [0.5, 2.0]),
        ("stribeck", "stribeck_velocity_rad_s", [0.01, 0.15]),
        ("joint_coupling_friction", "ratio", [-3.0, 3.0]),
        ("torque_ripple", "order", [1.0, 250.0]),
        ("viscous_nonlinear", "onset", [0.03, 0.6]),
    ] {
        let mut values = shapes(identifier, field);
        assert_eq!(values.len(), 60);
        assert!(values.iter().all(|v| (low..=high).contains(v)), "{identifier} {field}: {values:?}");
        values.sort_by(f64::total_cmp);
        values.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        assert!(values.len() >= 40, "{identifier} {field} comes from a grid: {values:?}");
        assert!(values[values.len() - 1] - values[0] > 0.5 * (high - low), "{identifier} {field}");
    }
    assert!(shapes("joint_coupling_friction", "ratio").iter().all(|r| r.abs() >= 0.2));
    let orders = shapes("torque_ripple", "order");
    let whole = orders.iter().filter(|o| o.fract() == 0.0).count();
    assert!((10..50).contains(&whole), "{whole} of 60 orders are whole");
}

#[test]
fn unknown_effects_and_fields_are_refused() {
    let text = read_effect("stribek", Value::Null).unwrap_err().to_string();
    assert!(text.contains("did you mean `stribeck`"), "{text}");
    let wrong = serde_json::json!({ "joints": [1], "offset_nm": [1.0], "offsett": 1 });
    assert!(read_effect("current_offset", wrong).unwrap_err().to_string().contains("offsett"));
}
