//! Model files: what they say, that they read back, and what people read when one is wrong.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;
use std::path::Path;

use aurt_experiment::Experiment;
use aurt_plugins::Registry;
use aurt_plugins::model::{Error, RigidBodyDynamics, model_file};
use aurt_rbd::{MdhRows, MdhTable};
use aurt_traits::RobotModel;
use serde_json::Value;
use tempfile::TempDir;

fn rigid_body() -> RigidBodyDynamics {
    let table = MdhTable::parse("alpha,a,d\n0,0.5,0\n0,0.4,0\n", "mdh.csv", MdhRows::Next).unwrap();
    RigidBodyDynamics::from_mdh(&table, [0.0, -9.81, 0.0], 0).unwrap()
}

fn robot(folder: &Path) -> RobotModel {
    fs::write(folder.join("mdh.csv"), "alpha,a,d\n0,0.5,0\n0,0.4,0\n").unwrap();
    fs::write(folder.join("a.csv"), "").unwrap();
    let text = r#"
        schema = 1
        robot = { mdh = "mdh.csv", gravity_m_s2 = [0.0, -9.81, 0.0] }
        joint_dynamics.coulomb.model = "square"
        joint_dynamics.viscous = { model = "polynomial", powers = [1, 3] }
        joint_dynamics.override = [{ joints = [1], coulomb.model = "constant" }]
        recordings.calibration = "a.csv"
    "#;
    let mut registry = Registry::linked().unwrap();
    Experiment::parse(text, &folder.join("e.toml"), &mut registry).unwrap().robot_model().unwrap()
}

#[test]
fn rigid_bodies_read_back_as_they_were() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("rbd.json");
    let written = rigid_body();
    let saved = model_file::rigid_body_to_json(&written).unwrap();
    fs::write(&path, saved.to_string()).unwrap();
    let read = model_file::read_rigid_body(&path).unwrap();
    assert_eq!(read.base, written.base);
    assert_eq!(format!("{:?}", read.rigid_body), format!("{:?}", written.rigid_body));
    assert_eq!(model_file::rigid_body_to_json(&read).unwrap(), saved);
}

#[test]
fn base_parameters_stand_in_the_file_as_sums() {
    let value = model_file::rigid_body_to_json(&rigid_body()).unwrap();
    let parameters = value["base_parameters"]["parameters"].as_array().unwrap();
    let sums: Vec<&str> = parameters.iter().map(|p| p["stands_for"].as_str().unwrap()).collect();
    // A planar two-link arm: m_1 is felt by joint 0 at the end of link 0, so 0.5² m_1 joins ZZ_0 and 0.5 m_1 joins mX_0.
    assert_eq!(sums, ["ZZ_0 + 0.25 m_1", "mX_0 + 0.5 m_1", "mY_0", "ZZ_1", "mX_1", "mY_1"]);
    assert_eq!(parameters[1]["terms"]["m_1"], 0.5);
}

#[test]
fn a_robot_model_reads_back_as_it_was() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("rd.json");
    let written = robot(folder.path());
    fs::write(&path, model_file::robot_model_to_json(&written).unwrap().to_string()).unwrap();
    let read = model_file::read_robot_model(&path, &Registry::linked().unwrap()).unwrap();
    assert_eq!(read.parameters(), written.parameters());
    assert_eq!(format!("{read:?}"), format!("{written:?}"));
}

/// What people read of a robot model's file after a change of its text.
fn complaint(change: impl Fn(&str) -> String) -> String {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("rd.json");
    let saved = model_file::robot_model_to_json(&robot(folder.path())).unwrap();
    let text = serde_json::to_string_pretty(&saved).unwrap();
    let changed = change(&text);
    assert_ne!(text, changed);
    fs::write(&path, changed).unwrap();
    let error = model_file::read_robot_model(&path, &Registry::linked().unwrap()).unwrap_err();
    assert!(matches!(error, Error::ModelFile { .. }), "{error}");
    error.to_string().replace(&format!("{}/", folder.path().display()), "")
}

#[test]
fn wrong_files_are_refused_with_the_place() {
    assert_eq!(
        complaint(|t| t.replacen("\"schema\": 1", "\"schema\": 7", 1)),
        "rd.json:2:13: `schema` is 7, another version of the file; this program reads version 1; \
         make the file anew, or use the program that made it"
    );
    assert_eq!(
        complaint(|t| t.replacen("robot_dynamics", "rigid_body_dynamics", 1)),
        "rd.json:3:11: `kind` is `rigid_body_dynamics`, but a file of kind `robot_dynamics` is needed"
    );
    let cut = complaint(|t| t[..t.len() / 2].to_owned());
    assert!(cut.starts_with("rd.json:") && cut.contains("this is not JSON: EOF while parsing"), "{cut}");
    let unknown = complaint(|t| t.replacen("\"model\": \"square\"", "\"model\": \"squire\"", 1));
    assert!(
        unknown.contains(
            "`joint_dynamics[0].coulomb` does not describe a model of its slot: there is no coulomb model `squire`; \
             did you mean `square`?"
        ),
        "{unknown}"
    );
    let joints = complaint(|t| t.replacen("\"joint\": 1", "\"joint\": 4", 1));
    assert!(
        joints.ends_with("`joint_dynamics[1].joint` is 4, but joints follow one another from 0"),
        "{joints}"
    );
    let parameters = complaint(|t| t.replacen("\"name\": \"F_v1_0\"", "\"name\": \"old\"", 1));
    assert!(parameters.contains("`parameters` lists `old` where the models have"), "{parameters}");
}

#[test]
fn another_joint_count_is_refused() {
    let mut value = model_file::robot_model_to_json(&robot(TempDir::new().unwrap().path())).unwrap();
    value["joint_dynamics"].as_array_mut().unwrap().pop();
    let error = model_file::robot_model_from_json(&value, &Registry::linked().unwrap()).unwrap_err();
    assert_eq!(error.to_string(), "`joint_dynamics` has 1 entries, but the rigid bodies have 2 joints");
}

#[test]
fn errors_inside_a_larger_file_have_its_lines() {
    let mut value = model_file::robot_model_to_json(&robot(TempDir::new().unwrap().path())).unwrap();
    value["rigid_body_dynamics"]["joints"] = Value::from(3);
    let text = serde_json::to_string_pretty(&serde_json::json!({ "model": value })).unwrap();
    let error = model_file::robot_model_from_json(&value, &Registry::linked().unwrap()).unwrap_err();
    let shown = error.in_file(Path::new("calibrated.json"), &text, &["model"]).to_string();
    assert_eq!(
        shown,
        "calibrated.json:8:17: `model.rigid_body_dynamics.joints` is 3, but `rigid_body` has 2 joints"
    );
}
