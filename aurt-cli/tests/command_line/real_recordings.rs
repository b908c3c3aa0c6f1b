//! Published recordings of real robots through the command, against what other programs make of them.

use serde_json::Value;

use crate::support::{Folder, numbers, real_recordings, text, with_table};

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
         [preprocess]\nf_dyn_hz = 10.0\ncount_ends = true\n\
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
    for coulomb in ["constant", "square", "absolute"] {
        for powers in ["[1]", "[1, 2, 3]"] {
            // The paper calls a constant level "none".
            let name = format!("{} {powers}", if coulomb == "constant" { "none" } else { coulomb });
            let folder = Folder::new();
            folder.write("experiment.toml", &as_in_the_paper(&data, coulomb, powers));
            folder.run("run experiment.toml --out out").succeeded();
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

/// Runs an experiment of the folder `examples` and hands over its metrics.
fn example(folder: &Folder, name: &str) -> Value {
    let experiment = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/").to_owned() + name + ".toml";
    folder.run(format!("run {experiment} --out {name}")).succeeded();
    folder.json(&format!("{name}/metrics.json"))
}

/// A parameter of a calibration by its name: value and 95 % interval.
fn parameter(folder: &Folder, example: &str, name: &str) -> (f64, [f64; 2]) {
    let csv = folder.read(&format!("{example}/calibrated_parameters.csv"));
    let row = csv.lines().find(|l| l.starts_with(&format!("{name},"))).unwrap();
    let cells: Vec<&str> = row.split(',').collect();
    let number = |k: usize| cells[k].parse::<f64>().unwrap();
    (number(1), [number(5), number(6)])
}

/// The UR10e as it was logged. The expected errors are those of an independent study in Python on the same
/// recordings, with its own resampling and filters; hence the tolerance of 0.2 percentage points.
#[test]
fn a_ur10e_as_it_was_logged() {
    let Some(_) = real_recordings("a_ur10e_as_it_was_logged") else { return };
    let folder = Folder::new();
    let metrics = example(&folder, "ur10e");
    assert_eq!(metrics["base_parameters"], 36);
    let held_out = &metrics["recordings"][3];
    assert!(held_out["file"].as_str().unwrap().ends_with("excitation_20s.csv"), "{held_out}");
    assert_eq!(held_out["role"], "validation");
    let expected = [10.4, 4.0, 5.0, 10.6, 17.3, 16.0];
    for (joint, (found, expected)) in numbers(&held_out["nrmse"]).iter().zip(expected).enumerate() {
        assert!((100.0 * found - expected).abs() < 0.2, "joint {joint}: {found} instead of {expected} %");
    }
    let rows = |text: String| text.lines().count();
    let data = real_recordings("").unwrap();
    let recorded = std::fs::read_to_string(data.join("ur10e/excitation_20s.csv")).unwrap();
    assert_eq!(rows(folder.read("ur10e/predicted_excitation_20s.csv")), rows(recorded));
}

/// A Stäubli TX40 with its wrist coupling. Reference: Gautier, Janot, Vandanjon, on another recording of the same
/// robot: 0.00964 kg m², 0.616 Nm s/rad, 1.95 Nm.
#[test]
fn a_tx40_with_its_coupled_wrist() {
    let Some(_) = real_recordings("a_tx40_with_its_coupled_wrist") else { return };
    let folder = Folder::new();
    let metrics = example(&folder, "tx40");
    assert_eq!(metrics["base_parameters"], 36);
    for (name, reference, within) in
        [("inertia", 0.009_64, 0.005), ("viscous", 0.616, 0.05), ("coulomb", 1.95, 0.1)]
    {
        let (value, _) = parameter(&folder, "tx40", &format!("coupling.{name}_5_4"));
        assert!((value - reference).abs() < within, "{name}: {value} instead of {reference}");
    }
    let fitted = numbers(&metrics["recordings"][0]["nrmse"]);
    assert!(fitted[4] < 0.13 && fitted[5] < 0.11, "{fitted:?}");
}

/// A Franka Emika Panda: seven joints, torques measured behind the gears.
#[test]
fn a_panda_with_link_side_torques() {
    let Some(_) = real_recordings("a_panda_with_link_side_torques") else { return };
    let folder = Folder::new();
    let metrics = example(&folder, "panda");
    assert_eq!(metrics["base_parameters"], 43);
    assert_eq!(metrics["recordings"][0]["unit"], "Nm");
    let (friction, _) = parameter(&folder, "panda", "F_C0_6");
    assert!((0.1..0.7).contains(&friction), "hidden friction of joint 6: {friction} Nm");
}

/// A file without header, read by the numbers of its columns, is the same recording as the one with names.
#[test]
fn a_headerless_log_is_read_by_column_numbers() {
    let Some(data) = real_recordings("a_headerless_log_is_read_by_column_numbers") else { return };
    let folder = Folder::new();
    let data = text(&data);
    let toml =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/ur10e.toml")).unwrap();
    let validated = |name: &str, recording: &str| {
        let recordings = format!(
            "[recordings]\ncalibration = ['{data}/ur10e/unloaded_50s.csv']\nvalidation = [{recording}]\n"
        );
        let experiment = format!("{name}.toml");
        folder.write(&experiment, &with_table(&toml, "[recordings]", &recordings));
        folder.run(format!("run {experiment} --out {name}")).succeeded();
        numbers(&folder.json(&format!("{name}/metrics.json"))["recordings"][1]["nrmse"])
    };
    let named = validated("named", &format!("'{data}/ur10e/excitation_20s.csv'"));
    let columns = "columns = { time = 0, position = [1, 6], measurement = [13, 18] }";
    let file = format!("{{ file = '{data}/ur10e/as_recorded_headerless.csv', unit = 'A', {columns} }}");
    let headerless = validated("headerless", &file);
    assert_near("headerless", &headerless, &named, 1e-3);
}

/// One joint of a UR3e moves: a check says so, and which parameters that leaves out of reach.
#[test]
fn a_check_tells_what_a_motion_leaves_out() {
    let Some(data) = real_recordings("a_check_tells_what_a_motion_leaves_out") else { return };
    let folder = Folder::new();
    let (recording, mdh) = (text(&data.join("ur3e/wave_joint_1.csv")), text(&data.join("ur3e/mdh.csv")));
    let run = folder.run(format!("check {recording} --mdh {mdh} --json")).found();
    let report = run.json();
    let findings = report["findings"].to_string();
    assert!(findings.contains("only joint 1 moves"), "{findings}");
    let parameters = report["excitation"]["parameters"].as_array().unwrap();
    let is = |name: &str| parameters.iter().find(|p| p["name"] == name).unwrap()["is"].clone();
    assert_eq!(report["excitation"]["base_parameters"], 36);
    for joint in [0, 2, 3, 4, 5] {
        assert_eq!(is(&format!("F_C0_{joint}")), "out_of_reach");
        assert_eq!(is(&format!("F_v1_{joint}")), "out_of_reach");
    }
    for name in ["F_C0_1", "F_v1_1", "mX_1", "mY_1"] {
        assert_eq!(is(name), "determined", "{name}");
    }
    // An exciting motion of all joints leaves nothing out, and nothing to heed at the f_dyn that the check recommends; at
    // 10 Hz noise covers what is small.
    let (recording, mdh) = (text(&data.join("ur10e/excitation_20s.csv")), text(&data.join("ur10e/mdh.csv")));
    let report = folder.run(format!("check {recording} --mdh {mdh} --f-dyn-hz 4")).succeeded().stdout();
    assert!(report.contains("48 determined, 0 only in combinations, 0 out of"), "{report}");
    assert!(report.contains("f_dyn_hz = 4 under [preprocess]"), "{report}");
}

/// A trajectory that ran twice, once with a load, is two recordings; one at 500 Hz made from 100 Hz is a copy.
#[test]
fn repetitions_are_told_from_copies() {
    let Some(data) = real_recordings("repetitions_are_told_from_copies") else { return };
    let folder = Folder::new();
    let check = |names: [&str; 2]| {
        folder.aurt(["check".to_owned()].into_iter().chain(names.map(|name| text(&data.join(name)))))
    };
    let repeated = check(["ur10e/unloaded_50s.csv", "ur10e/payload_50s.csv"]);
    assert!(repeated.status() < 2, "{}", repeated.stderr());
    check(["ur10e/excitation_20s.csv", "ur10e_500hz/validation_8harm.csv"]).refused(&[
        "excitation_20s.csv",
        "as every 5th row, the samples of",
        "validation_8harm.csv",
    ]);
}
