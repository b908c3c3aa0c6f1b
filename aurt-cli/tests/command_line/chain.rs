//! The paper's commands one after the other, and the same from one experiment file.

use std::fs;

use crate::support::{DEMO, Folder, first_columns, numbers};

const OPTIONS: &str = "--torque-constants 11.976 11.976 9.839 10.763 10.763 10.763 --f-dyn-hz 5";

/// A folder with the demo's recordings and a compiled robot model.
fn compiled() -> Folder {
    let folder =
        Folder::new().with_demo(&["mdh.csv", "exciting_motion.csv", "other_motion.csv", "experiment.toml"]);
    folder.run("compile-rbd --mdh mdh.csv --gravity 0 0 -9.81 --out rbd.json").succeeded();
    folder
        .run("compile-rd --model-rbd rbd.json --experiment experiment.toml --out rd.json")
        .refused(&["point_to_point.csv", "does not exist"]);
    let folder = folder.with_demo(&["point_to_point.csv"]);
    folder.run("compile-rd --model-rbd rbd.json --experiment experiment.toml --out rd.json").succeeded();
    folder
}

fn calibrate(folder: &Folder) {
    let line = "calibrate --model rd.json --data exciting_motion.csv --gravity 0 0 -9.81 --out-params p.csv \
                --out-calibrated-model rd_calibrated.json";
    folder.run(format!("{line} {OPTIONS}")).succeeded();
}

#[test]
fn the_commands_and_an_experiment_give_the_same_model() {
    let folder = compiled();
    calibrate(&folder);
    let demo = fs::read_to_string(DEMO.path("demo/calibrated_parameters.csv")).unwrap();
    assert_eq!(folder.read("p.csv"), demo);
    let header = "name,value,unit,std_dev,relative_std_dev_percent,lower_95,upper_95\n";
    assert!(demo.starts_with(header), "{demo}");
    assert_eq!(demo.lines().count(), 1 + 54);
    let (mut ours, mut demo) = (folder.json("rd_calibrated.json"), DEMO.json("demo/rd_calibrated.json"));
    // The commands had no experiment and held nothing out, but calibrated on the same file.
    let (from, of_demo) = (ours["provenance"].take(), demo["provenance"].take());
    assert_eq!(ours, demo);
    assert!(from["calibration"][0]["blake3"].is_string(), "{from}");
    assert_eq!(from["calibration"], of_demo["calibration"]);
}

#[test]
fn a_prediction_needs_no_measurement_and_has_a_row_for_each() {
    let folder = compiled();
    calibrate(&folder);
    let positions = first_columns(&folder.read("other_motion.csv"), 7);
    folder.write("trajectory.csv", &positions);
    folder
        .run("predict --model rd_calibrated.json --data trajectory.csv --gravity 0 0 -9.81 --out predicted.csv")
        .succeeded();
    let predicted = folder.read("predicted.csv");
    let expected_header = "timestamp,predicted_torque_0,predicted_torque_1,predicted_torque_2,\
                           predicted_torque_3,predicted_torque_4,predicted_torque_5";
    assert_eq!(predicted.lines().next(), Some(expected_header));
    assert_eq!(predicted.lines().count(), positions.lines().count());
    let of_run = fs::read_to_string(DEMO.path("demo/predicted_other_motion.csv")).unwrap();
    assert_eq!(predicted, of_run);
}

#[test]
fn the_first_part_calibrates_and_the_rest_validates() {
    let folder = compiled();
    let line = "calibrate-validate --model rd.json --data exciting_motion.csv --gravity 0 0 -9.81 \
                --calibration-data-rel 0.7 --out-params p.csv --out-calibrated-model c.json \
                --out-prediction predicted.csv --json";
    let report = folder.run(format!("{line} {OPTIONS}")).succeeded().json();
    let recordings = report["recordings"].as_array().unwrap();
    assert_eq!(recordings.len(), 2);
    assert_eq!(recordings[0]["role"], "calibration");
    assert_eq!(recordings[1]["role"], "validation");
    // 2501 samples at 125 Hz: 1751 of them until 14.0 s.
    assert_eq!(numbers(&recordings[0]["window_s"]), [0.0, 14.0]);
    assert_eq!(numbers(&recordings[1]["window_s"]), [14.008, 20.0]);
    assert!(numbers(&recordings[1]["nrmse"]).iter().all(|e| *e < 0.1), "{}", recordings[1]);
    assert_eq!(folder.read("predicted.csv").lines().count(), 2502);
}

#[test]
fn another_friction_model_takes_the_compiled_rigid_bodies_as_they_are() {
    let folder = compiled();
    for (option, coulomb, parameters) in
        [("--friction-torque-model", "square", 36 + 6 * 5), ("--friction-load-model", "none", 36 + 6 * 4)]
    {
        let line = "compile-rd --model-rbd rbd.json --friction-viscous-powers 1 2 3 --out other.json";
        folder.run(format!("{line} {option} {coulomb}")).succeeded();
        let model = folder.json("other.json");
        let mut rigid_body = folder.json("rbd.json");
        rigid_body.as_object_mut().unwrap().remove("aurt_version");
        assert_eq!(model["rigid_body_dynamics"], rigid_body);
        assert_eq!(model["parameters"].as_array().unwrap().len(), parameters);
        let written = if coulomb == "none" { "constant" } else { coulomb };
        assert_eq!(model["joint_dynamics"][3]["coulomb"]["model"], written);
    }
}

#[test]
fn base_parameters_of_published_robots() {
    // The paper's UR5e on its slope has 38; under vertical gravity the first moments of link 0 go out of sight.
    let ur5e =
        "alpha,a,d\npi/2,0,0.1625\n0,-0.425,0\n0,-0.3922,0\npi/2,0,0.1333\n-pi/2,0,0.0997\n0,0,0.0996\n";
    let folder = Folder::new();
    folder.write("mdh.csv", ur5e);
    for (gravity, count) in [("0 6.937 -6.937", 38), ("0 0 -9.81", 36)] {
        let line = format!("compile-rbd --mdh mdh.csv --gravity {gravity} --out rbd.json --json");
        let report = folder.run(line).succeeded().json();
        assert_eq!(report["base_parameters"], count, "gravity {gravity}");
        let first = &report["parameters"][0];
        assert_eq!(first["name"], "ZZ_0");
        assert!(first["stands_for"].as_str().unwrap().starts_with("ZZ_0 + YY_1"), "{first}");
    }
}

#[test]
fn a_model_is_used_on_another_mounting_only_where_its_parameters_suffice() {
    let folder = compiled();
    calibrate(&folder);
    let line = "predict --model rd_calibrated.json --data other_motion.csv --out p2.csv --gravity";
    let predict = |gravity: &str| folder.run(format!("{line} {gravity}"));
    let words = ["--gravity", "36 base parameters", "38 of them", "mounted like that"];
    predict("0 6.937 -6.937").refused(&words);
    assert!(!folder.path("p2.csv").exists());
    // Upside down, the same parameters act.
    predict("0 0 9.81").succeeded();
    assert_ne!(folder.read("p2.csv"), DEMO.read("demo/predicted_other_motion.csv"));
}
