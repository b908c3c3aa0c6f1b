//! Models of libraries inside an arm term of equation (6).

use std::fs;

use aurt_experiment::Experiment;
use aurt_plugins::Registry;
use aurt_plugins::model::model_file;
use aurt_traits::ArmTerm;
use serde_json::json;

use crate::built;

const EXPERIMENT: &str = include_str!("inner.toml");

/// An experiment in a folder, with the example for LIBRARY.
pub fn parse(folder: &std::path::Path, text: &str, registry: &mut Registry) -> Result<Experiment, String> {
    fs::write(folder.join("mdh.csv"), "alpha,a,d\n0,0.5,0\n0,0.4,0\n").unwrap();
    fs::write(folder.join("a.csv"), "").unwrap();
    let text = text.replace("LIBRARY", &built::rust_example().to_string_lossy());
    Experiment::parse(&text, &folder.join("e.toml"), registry).map_err(|e| e.to_string())
}

#[test]
fn an_experiment_names_them_and_a_saved_model_reads_back() {
    let folder = tempfile::tempdir().unwrap();
    let mut registry = built::trusting();
    let mut model = parse(folder.path(), EXPERIMENT, &mut registry).unwrap().robot_model().unwrap();
    let names: Vec<String> = model.parameters().iter().map(|p| p.name.clone()).collect();
    assert!(names.iter().any(|n| n.contains("F_v_1")), "{names:?}");
    let shapes: Vec<String> = model.arm_terms()[1].shape_parameters().into_iter().map(|s| s.name).collect();
    assert_eq!(shapes, ["distance_rad"]);

    // What was fitted is what is read, with the library that it is from.
    let mut terms = model.arm_terms().to_vec();
    terms[0].set_shape(&[0.7]).unwrap();
    model = aurt_traits::RobotModel::new(
        model.rigid_body().clone(),
        model.base().clone(),
        model.stacks().to_vec(),
        terms,
    )
    .unwrap();
    let path = folder.path().join("rd.json");
    let saved = model_file::robot_model_to_json(&model).unwrap();
    fs::write(&path, saved.to_string()).unwrap();
    let inner = &saved["arm_terms"][0]["viscous"];
    assert_eq!(inner["transition_velocity_rad_s"], 0.7);
    assert_eq!(inner["plugin"]["name"], "aurt-plugin-example");
    let read = model_file::read_robot_model(&path, &registry).unwrap();
    assert_eq!(model_file::robot_model_to_json(&read).unwrap(), saved);

    let error = model_file::read_robot_model(&path, &built::trusting()).unwrap_err().to_string();
    let said = ["the viscous model `eyring` is from the library aurt-plugin-example", "--plugin"];
    assert!(said.iter().all(|s| error.contains(s)), "{error}");
}

#[test]
fn a_model_of_a_library_evaluates_as_it_does_in_the_joint_dynamics() {
    let registry = built::with(&built::rust_example());
    let viscous = json!({ "model": "eyring", "transition_velocity_rad_s": 0.5 });
    let term = json!({
        "model": "joint_friction", "joints": [0], "coulomb": { "model": "absent" }, "viscous": viscous,
    });
    let term = registry.build_from_json::<dyn ArmTerm>(&term).unwrap();
    assert_eq!(term.columns(1).len(), 1);
    assert_eq!(term.columns(1)[0].unit, "Nm s/rad");
    term.validate(1).unwrap();
    let again = serde_json::to_value(&*term).unwrap();
    assert_eq!(serde_json::to_value(&*term.boxed_clone()).unwrap(), again);
}

/// What people read of the problems of an experiment in which `from` is written as `to`.
fn problems(from: &str, to: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    assert!(EXPERIMENT.contains(from));
    let text = EXPERIMENT.replace(from, to);
    parse(folder.path(), &text, &mut built::trusting()).unwrap_err()
}

#[test]
fn errors_name_the_known_models_the_place_and_what_was_meant() {
    let said = problems("model = \"eyring\"", "model = \"eyrin\"");
    assert!(said.contains("there is no viscous model `eyrin`"), "{said}");
    assert!(said.contains("did you mean `eyring`?") && said.contains("e.toml:10:"), "{said}");

    let said = problems("model = \"eyring\"", "model = \"stop\"");
    assert!(said.contains("`stop` is a model for `hysteresis`"), "{said}");
    assert!(said.contains("`eyring`, `polynomial`, `power_law`, `saturating`"), "{said}");

    let said = problems("transition_velocity_rad_s = 0.5", "transition_velocity_rad_s = -1.0");
    assert!(said.contains("must be positive, is -1") && said.contains("e.toml:10:"), "{said}");

    let said = problems("viscous = {", "viscous = 3 #");
    assert!(said.contains("write viscous = { model"), "{said}");

    // All that is wrong with a term and with its models comes together.
    let said = problems(
        "joints = [1]\ncoulomb = { model = \"absent\" }",
        "joint = [1]\ncoulomb = { model = \"abs\" }",
    );
    assert!(said.contains("unknown key") && said.contains("`joint`"), "{said}");
    assert!(said.contains("there is no coulomb model `abs`"), "{said}");
}

#[test]
fn a_term_of_its_own_equation_has_no_such_keys() {
    let registry = built::with(&built::rust_example());
    let term = json!({ "model": "rotor_inertia", "joints": [0], "viscous": { "model": "eyring" } });
    let errors = registry.build_from_json::<dyn ArmTerm>(&term).unwrap_err();
    assert_eq!(errors.len(), 1);
    assert!(errors[0].to_string().contains("unknown key"), "{}", errors[0]);
}
