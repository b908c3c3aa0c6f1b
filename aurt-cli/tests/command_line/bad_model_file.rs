//! Model files of another version, kind or robot, and broken ones.

use std::fs;

use crate::support::{DEMO, Folder, first_columns};

fn with_model(change: impl Fn(&str) -> String) -> Folder {
    let folder = Folder::new().with_demo(&["other_motion.csv"]);
    let model = fs::read_to_string(DEMO.path("demo/rd_calibrated.json")).unwrap();
    folder.write("c.json", &change(&model));
    folder
}

#[track_caller]
fn refusal(change: impl Fn(&str) -> String, words: &[&str]) {
    let folder = with_model(change);
    let said = folder.run("predict --model c.json --data other_motion.csv --out p.csv").refused(words);
    assert!(said.contains("c.json"), "{said}");
    assert_eq!(folder.names(), ["c.json", "other_motion.csv"]);
}

#[test]
fn another_version() {
    refusal(
        |m| m.replacen("\"schema\": 1", "\"schema\": 7", 1),
        &["`schema` is 7", "version 1", "calibrate again"],
    );
}

#[test]
fn another_kind() {
    refusal(
        |_| "{\"schema\": 1, \"kind\": \"robot_dynamics\"}".into(),
        &["robot_dynamics", "aurt calibrate"],
    );
    refusal(|_| "{}".into(), &["no model file", "kind"]);
    let folder = Folder::new().with_demo(&["mdh.csv", "rd_calibrated.json", "exciting_motion.csv"]);
    folder.run("compile-rbd --mdh mdh.csv --gravity 0 0 -9.81 --out rbd.json").succeeded();
    let calibrate = |model: &str| {
        let line = format!(
            "calibrate --model {model} --data exciting_motion.csv --out-params p --out-calibrated-model c"
        );
        folder.aurt(line.split(' ').map(str::to_owned))
    };
    calibrate("rbd.json").refused(&["rbd.json", "rigid_body_dynamics", "robot_dynamics"]);
    calibrate("rd_calibrated.json").refused(&["rd_calibrated.json", "calibrated_robot_dynamics"]);
    calibrate("mdh.csv").refused(&["mdh.csv", "JSON"]);
}

#[test]
fn a_broken_file() {
    refusal(|m| m[..m.len() / 2].to_owned(), &["c.json:", "JSON"]);
    refusal(|m| m.replacen("\"F_C0_3\"", "\"F_C9_3\"", 1), &["F_C9_3", "F_C0_3"]);
    refusal(|m| m.replacen("\"model\": \"absolute\"", "\"model\": \"absent_minded\"", 1), &["absent_minded"]);
    refusal(
        |m| m.replacen("\"unit\": \"Nm\",\n    \"options\"", "\"unit\": \"kg\",\n    \"options\"", 1),
        &["calibration", "kg"],
    );
    refusal(
        |m| m.replacen("\"gravity_m_s2\": [0.0, 0.0, -9.81]", "\"gravity_m_s2\": [0.0, -9.81]", 1),
        &["rigid_body", "length 2"],
    );
}

#[test]
fn a_model_of_another_joint_count() {
    let folder = with_model(str::to_owned);
    folder.edit("other_motion.csv", |text| first_columns(text, 5));
    folder.run("predict --model c.json --data other_motion.csv --out p.csv").refused(&[
        "other_motion.csv",
        "4",
        "6",
    ]);
    assert!(!folder.path("p.csv").exists());
}
