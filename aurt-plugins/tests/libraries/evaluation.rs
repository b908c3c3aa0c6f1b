//! Models of libraries do what their equations say, as a part of a robot too.

use std::sync::Arc;

use aurt_plugins::model::RigidBodyDynamics;
use aurt_plugins::{Origin, Registry};
use aurt_rbd::{MdhRows, MdhTable};
use aurt_traits::{
    ArmTerm, Columns, CoulombModel, HysteresisModel, JointModel, JointSeries, JointStack, LoadTorque, Motion,
    RobotModel, RobotState, RobotTile, Slot, ViscousBasis,
};
use serde_json::json;

use crate::built;

fn motion(samples: usize, joints: usize) -> Motion {
    let time: Vec<f64> = (0..samples).map(|i| i as f64 * 0.01).collect();
    let of = |f: &dyn Fn(f64, f64) -> f64| {
        (0..joints).flat_map(|j| time.iter().map(move |t| f(*t, 1.0 + j as f64))).collect::<Vec<f64>>()
    };
    let (q, v, a) =
        (of(&|t, w| (w * t).sin()), of(&|t, w| w * (w * t).cos()), of(&|t, w| -w * w * (w * t).sin()));
    Motion::new(joints, time, q, v, a).unwrap()
}

fn series(motion: &Motion) -> JointSeries<'_> {
    let view = motion.view();
    JointSeries::of(view, 0, view.acceleration_rad_s2(0))
}

fn columns(model: &dyn JointModel, series: &JointSeries<'_>) -> Vec<Vec<f64>> {
    let (n, k) = (series.samples(), model.columns().len());
    let mut data = vec![0.0; n * k];
    let mut state = model.initial_state(&series.slice(0..1));
    model.evaluate(series, &mut state, &mut Columns::new(&mut data, k, n, n)).unwrap();
    data.chunks(n).map(<[f64]>::to_vec).collect()
}

#[test]
fn a_rust_library_lists_its_models() {
    let registry = built::with(&built::rust_example());
    for (slot, name) in [
        (Slot::Coulomb, "smooth_load"),
        (Slot::Hysteresis, "stop"),
        (Slot::Viscous, "eyring"),
        (Slot::ArmTerm, "dress_pack"),
    ] {
        let listing = registry.model(slot, name).unwrap();
        assert!(matches!(&listing.origin, Origin::Library(l) if l.name == "aurt-plugin-example"));
        assert!(listing.example.contains(name) && !listing.equation.is_empty());
    }
    assert_eq!(registry.libraries().len(), 1);
    // Only its own: other crates that are linked into the library do not count as the library's.
    assert_eq!(registry.models().filter(|m| matches!(m.origin, Origin::Library(_))).count(), 4);
}

#[test]
fn loading_a_library_again_changes_nothing() {
    let mut registry = built::with(&built::rust_example());
    let models = registry.models().count();
    registry.load_library(built::rust_example()).unwrap();
    assert_eq!((registry.models().count(), registry.libraries().len()), (models, 1));
}

#[test]
fn models_of_a_rust_library_follow_their_equations() {
    let registry = built::with(&built::rust_example());
    let motion = motion(300, 1);
    let series = series(&motion);

    let config = json!({ "model": "eyring", "transition_velocity_rad_s": 0.5 });
    let mut viscous = registry.build_from_json::<dyn ViscousBasis>(&config).unwrap();
    let expected =
        |v_0: f64| series.velocity_rad_s.iter().map(|v| v_0 * (v / v_0).asinh()).collect::<Vec<_>>();
    assert_eq!(columns(&*viscous, &series), [expected(0.5)]);
    let before = viscous.clone();
    viscous.set_shape(&[2.0]).unwrap();
    assert_eq!(viscous.shape_parameters()[0].value, 2.0);
    assert_eq!(columns(&*viscous, &series), [expected(2.0)]);
    // What was cloned before keeps its own shape.
    assert_eq!(columns(&*before, &series), [expected(0.5)]);

    let config = json!({ "model": "smooth_load", "rounding": 2 });
    let coulomb = registry.build_from_json::<dyn CoulombModel>(&config).unwrap();
    let found = columns(&*coulomb, &series);
    assert!(found[0].iter().all(|c| *c == 1.0));
    assert_eq!(found[1], series.load_torque.iter().map(|l| l.hypot(2.0) - 2.0).collect::<Vec<_>>());
}

#[test]
fn the_c_model_gives_what_the_rust_model_gives() {
    let Some(library) = built::c_example() else { return };
    let mut registry = built::with(&library);
    registry.load_library(built::rust_example()).unwrap();
    let motion = motion(500, 1);
    let series = series(&motion);
    let of = |name: &str| {
        let config = json!({ "model": name, "distance_rad": 0.3 });
        registry.build_from_json::<dyn HysteresisModel>(&config).unwrap()
    };
    let (c, rust) = (of("stop_c"), of("stop"));
    assert_eq!(columns(&*c, &series), columns(&*rust, &series));
    assert_eq!(c.shape_parameters(), rust.shape_parameters());
    assert_eq!((c.columns(), c.invariants(), c.state_len()), (rust.columns(), rust.invariants(), 2));
}

fn robot(registry: &Registry, joints: usize) -> RobotModel {
    let rows = "0,0.5,0\n".repeat(joints);
    let table = MdhTable::parse(&format!("alpha,a,d\n{rows}"), "mdh.csv", MdhRows::Next).unwrap();
    let bodies = RigidBodyDynamics::from_mdh(&table, [0.0, -9.81, 0.0], 0).unwrap();
    let [coulomb, hysteresis, viscous] = [
        json!({ "model": "smooth_load", "rounding": 2.0 }),
        json!({ "model": "stop", "distance_rad": 0.1 }),
        json!({ "model": "eyring", "transition_velocity_rad_s": 0.5 }),
    ];
    let stack = || {
        let coulomb = registry.build_from_json::<dyn CoulombModel>(&coulomb).unwrap();
        let hysteresis = registry.build_from_json::<dyn HysteresisModel>(&hysteresis).unwrap();
        let viscous = registry.build_from_json::<dyn ViscousBasis>(&viscous).unwrap();
        JointStack::new(coulomb, hysteresis, viscous).unwrap()
    };
    let term = json!({ "model": "dress_pack", "joints": [joints - 1, 0], "opposed": true, "label": "cable" });
    let terms = vec![registry.build_from_json::<dyn ArmTerm>(&term).unwrap()];
    bodies.with_joint_dynamics((0..joints).map(|_| stack()).collect(), terms).unwrap()
}

/// The whole regressor, evaluated in batches of the given sizes.
fn regressor(model: &RobotModel, motion: &Motion, batches: &[usize]) -> Vec<Vec<f64>> {
    let (mut state, mut tile, mut begin) = (RobotState::default(), RobotTile::default(), 0);
    let mut columns = vec![Vec::new(); model.slots()];
    for samples in batches {
        let view = motion.view().slice(begin..begin + samples);
        model.evaluate(view, &LoadTorque::Literal, &mut state, &mut tile).unwrap();
        columns.iter_mut().enumerate().for_each(|(slot, column)| column.extend_from_slice(tile.slot(slot)));
        begin += samples;
    }
    columns
}

#[test]
fn a_robot_of_library_models_may_be_evaluated_in_any_batches() {
    let registry = built::with(&built::rust_example());
    let model = robot(&registry, 3);
    let motion = motion(400, 3);
    let whole = regressor(&model, &motion, &[400]);
    assert_eq!(regressor(&model, &motion, &[1, 13, 186, 200]), whole);
    assert!(model.parameters().iter().any(|p| p.name == "dress_pack.cable_damping"));

    // τ_0 = D (q̇_0 + q̇_2) = τ_2 for a package between joints of opposite sense.
    let column = model.parameters().iter().position(|p| p.name == "dress_pack.cable_damping").unwrap();
    let row = |joint: usize| {
        let slot = model.row_columns(joint).iter().position(|c| *c == column);
        slot.map(|k| whole[model.row_slots(joint).start + k].clone())
    };
    let (v_0, v_2) = (motion.view().velocity_rad_s(0), motion.view().velocity_rad_s(2));
    let expected: Vec<f64> = v_0.iter().zip(v_2).map(|(a, b)| a + b).collect();
    assert_eq!((row(0).as_ref(), row(1), row(2).as_ref()), (Some(&expected), None, Some(&expected)));
}

#[test]
fn one_instance_serves_several_threads() {
    let registry = built::with(&built::rust_example());
    let model = Arc::new(robot(&registry, 2));
    let motion = Arc::new(motion(1000, 2));
    let alone = regressor(&model, &motion, &[1000]);
    let threads: Vec<_> = (0..4)
        .map(|_| {
            let (model, motion) = (model.clone(), motion.clone());
            std::thread::spawn(move || regressor(&model, &motion, &[100; 10]))
        })
        .collect();
    for thread in threads {
        assert_eq!(thread.join().unwrap(), alone);
    }
}
