//! Saved models remember their library.

use std::fs;

use aurt_experiment::Experiment;
use aurt_plugins::Registry;
use aurt_plugins::model::model_file;
use aurt_traits::{HysteresisModel, ViscousBasis};
use serde_json::json;

use crate::built;
use crate::inner::parse;

const EXPERIMENT: &str = r#"
schema = 1
robot = { mdh = "mdh.csv", gravity_m_s2 = [0.0, -9.81, 0.0] }
plugins.libraries = ["LIBRARY"]
joint_dynamics.viscous = { model = "eyring", transition_velocity_rad_s = 0.5 }
arm_terms = [{ model = "dress_pack", joints = [0, 1] }]
recordings.calibration = "a.csv"
"#;

fn experiment(folder: &std::path::Path, registry: &mut Registry) -> Experiment {
    parse(folder, EXPERIMENT, registry).unwrap()
}

#[test]
fn an_experiment_loads_its_libraries_and_the_model_reads_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut registry = built::trusting();
    let model = experiment(folder.path(), &mut registry).robot_model().unwrap();
    let path = folder.path().join("rd.json");
    let saved = model_file::robot_model_to_json(&model).unwrap();
    fs::write(&path, saved.to_string()).unwrap();
    let read = model_file::read_robot_model(&path, &registry).unwrap();
    assert_eq!(read.parameters(), model.parameters());
    assert_eq!(model_file::robot_model_to_json(&read).unwrap(), saved);
}

#[test]
fn a_model_of_a_library_asks_for_it() {
    let folder = tempfile::tempdir().unwrap();
    let model = experiment(folder.path(), &mut built::trusting()).robot_model().unwrap();
    let path = folder.path().join("rd.json");
    fs::write(&path, model_file::robot_model_to_json(&model).unwrap().to_string()).unwrap();
    let error = model_file::read_robot_model(&path, &built::trusting()).unwrap_err().to_string();
    let library = built::rust_example().canonicalize().unwrap();
    let expected = format!(
        "`joint_dynamics[0].viscous` does not describe a model of its slot: the viscous model `eyring` is from the \
         library aurt-plugin-example 0.1.0, which is not loaded; load it with `--plugin {}`, or under `libraries` of \
         [plugins] in the experiment",
        library.display()
    );
    assert!(error.starts_with(&format!("{}:", path.display())) && error.ends_with(&expected), "{error}");
}

#[test]
fn a_model_of_another_library_or_version_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mut registry = built::trusting();
    let model = experiment(folder.path(), &mut registry).robot_model().unwrap();
    let saved = model_file::robot_model_to_json(&model).unwrap();
    let path = folder.path().join("rd.json");
    let read_with = |key: &str, value: &str| {
        let mut changed = saved.clone();
        let viscous = &mut changed["joint_dynamics"][1]["viscous"];
        viscous["plugin"][key] = json!(value);
        // Keys that only that version knew do not distract from what is wrong.
        viscous["added_later"] = json!(1);
        fs::write(&path, changed.to_string()).unwrap();
        model_file::read_robot_model(&path, &registry).unwrap_err().to_string()
    };
    let error = read_with("version", "0.2.0");
    let expected = [
        "`joint_dynamics[1].viscous`",
        "the viscous model `eyring` was saved from the library aurt-plugin-example 0.2.0, but the one here is from \
         library aurt-plugin-example 0.1.0",
        "load version 0.2.0 in its place",
    ];
    assert!(expected.iter().all(|e| error.contains(e)), "{error}");
    assert!(read_with("name", "other").contains("was saved from the library other 0.1.0, but the one here"));
    assert!(read_with("version", "0.1.7").contains("unknown key"));
}

#[test]
fn shape_parameters_are_saved_as_they_are_now() {
    let registry = built::with(&built::rust_example());
    let config = json!({ "model": "stop", "distance_rad": 0.3 });
    let mut model = registry.build_from_json::<dyn HysteresisModel>(&config).unwrap();
    model.set_shape(&[0.07]).unwrap();
    let saved = serde_json::to_value(&*model).unwrap();
    assert_eq!((&saved["model"], &saved["distance_rad"]), (&json!("stop"), &json!(0.07)));
    assert_eq!(saved["plugin"]["name"], "aurt-plugin-example");
    let again = registry.build_from_json::<dyn HysteresisModel>(&saved).unwrap();
    assert_eq!(again.shape_parameters(), model.shape_parameters());
}

#[test]
fn numbers_booleans_strings_and_lists_arrive() {
    let registry = built::with(&built::rust_example());
    let config = json!({ "model": "dress_pack", "joints": [1, 0], "opposed": true, "label": "cable" });
    let term = registry.build_from_json::<dyn aurt_traits::ArmTerm>(&config).unwrap();
    assert_eq!(term.columns(2)[0].name, "cable_damping");
    let saved = serde_json::to_value(&*term).unwrap();
    assert_eq!((&saved["joints"], &saved["opposed"]), (&json!([1, 0]), &json!(true)));
    let viscous = json!({ "model": "eyring", "transition_velocity_rad_s": 0.5 });
    let viscous = registry.build_from_json::<dyn ViscousBasis>(&viscous).unwrap();
    assert_eq!(viscous.name(), "eyring");
}
