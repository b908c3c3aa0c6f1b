//! Published recordings of real robots through the command, against what other programs make of them.

use serde_json::Value;

use crate::support::{Folder, numbers, real_recordings, text};

/// An experiment on the recordings of a UR10e at 500 Hz, as the tool of the paper calibrates it.
fn as_in_the_paper(data: &std::path::Path, coulomb: &str, powers: &str) -> String {
    let data = text(data);
    format!(
        "schema = 1\n\
         [robot]\nmdh = '{data}/ur10e/mdh.csv'\ngravity_m_s2 = [0.0, 0.0, -9.81]\n\
         [joint_dynamics]\ncoulomb = {{ model = '{coulomb}' }}\nhysteresis = {{ model = 'sign' }}\n\
         viscous = {{ model = 'polynomial', powers = {powers} }}\n\
         [recordings]\ncalibration = ['{data}/ur10e_500hz/calibration.csv']\n\
         validation = ['{data}/ur10e_500hz/validation_8harm.csv', \
         '{data}/ur10e_500hz/validation_point_to_point.csv']\n\
         [preprocess]\nf_dyn_hz = 10.0\n\
         [calibration]\nestimator = 'wls'\nload_torque = 'literal'\n"
    )
}

#[track_caller]
fn assert_near(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (joint, (found, expected)) in found.iter().zip(expected).enumerate() {
        let off = (found / expected - 1.0).abs();
        assert!(off < tolerance, "{what}, joint {joint}: {found} instead of {expected}, off by {off:.1e}");
    }
}

/// All six friction configurations of the original tool, with the paper's weights (equation 13). Its numbers
/// were made with its own classes, see `docs/real-recordings.md`.
#[test]
fn the_original_tool_s_results_are_reproduced() {
    let Some(data) = real_recordings("the_original_tool_s_results_are_reproduced") else { return };
    let read = |name: &str| -> Value {
        let file = std::fs::read_to_string(data.join("ur10e_500hz").join(name)).unwrap();
        serde_json::from_str(&file).unwrap()
    };
    let whole = &read("original_aurt_results.json")["weights_1_over_sigma_squared"];
    let moving = read("original_aurt_results_moving.json");
    for coulomb in ["none", "square", "absolute"] {
        for powers in ["[1]", "[1, 2, 3]"] {
            let name = format!("{coulomb} {powers}");
            let folder = Folder::new();
            folder.write("experiment.toml", &as_in_the_paper(&data, coulomb, powers));
            folder.aurt(["run", "experiment.toml", "--out", "out"]).succeeded();
            let metrics = folder.json("out/metrics.json");
            let expected = &whole[&name];
            assert_eq!(metrics["base_parameters"], 36);
            assert_eq!(metrics["parameters"], expected["parameters"], "{name}");
            assert_eq!(metrics["load_torque"], "literal");
            let recordings = metrics["recordings"].as_array().unwrap();
            assert_eq!(recordings[0]["samples"], expected["samples_per_joint"], "{name}");
            let mse = numbers(&recordings[0]["mse"]);
            assert_near(&name, &mse, &numbers(&expected["calibration"]["mse"]), 1e-6);
            let nmse = numbers(&recordings[0]["nmse"]);
            assert_near(&name, &nmse, &numbers(&expected["calibration"]["nmse"]), 1e-6);
            for (recording, validation) in
                recordings[1..].iter().zip(["validation_8harm_moving", "validation_point_to_point_moving"])
            {
                let what = format!("{name}, {validation}");
                let mse = numbers(&recording["moving"]["mse"]);
                assert_near(&what, &mse, &numbers(&moving[&name][validation]["mse"]), 1e-4);
            }
        }
    }
}
