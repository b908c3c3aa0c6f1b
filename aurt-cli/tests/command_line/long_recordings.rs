//! Recordings that are read in stretches, against the same read whole.

use serde_json::Value;

use crate::support::{DEMO, Folder, column, numbers, with_cell, with_line};

const CALIBRATE: &str = "calibrate --model rd.json --data exciting_motion.csv other_motion.csv --f-dyn-hz 5 \
                         --torque-constants 11.976 11.976 9.839 10.763 10.763 10.763 --out-params p.csv \
                         --out-calibrated-model c.json --json";

/// A folder with the demo's recordings and a robot with a hysteresis model.
fn folder(hysteresis: &str) -> Folder {
    let folder = Folder::new().with_whole_demo();
    let experiment = folder.read("experiment.toml").replace("\"sign\"", &format!("\"{hysteresis}\""));
    folder.write("experiment.toml", &experiment);
    folder.run("compile-rbd --mdh mdh.csv --gravity 0 0 -9.81 --out rbd.json").succeeded();
    folder.run("compile-rd --model-rbd rbd.json --experiment experiment.toml --out rd.json").succeeded();
    folder
}

fn report(folder: &Folder, more: &[&str]) -> Value {
    folder.aurt(CALIBRATE.split_whitespace().chain(more.iter().copied())).succeeded().json()
}

/// Value and standard deviation of every parameter.
fn parameters(folder: &Folder) -> Vec<[f64; 2]> {
    let [values, deviations] = ["value", "std_dev"].map(|name| column(&folder.read("p.csv"), name));
    values.into_iter().zip(deviations).map(|(value, std_dev)| [value, std_dev]).collect()
}

fn assert_near(a: &[f64], b: &[f64]) {
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(b) {
        assert!((a - b).abs() <= 1e-9 * b.abs(), "{a} {b}");
    }
}

#[test]
fn stretches_give_the_model_and_the_errors_of_whole_recordings() {
    let folder = folder("sign");
    for more in [&[][..], &["--rest", "exclude", "--load-torque", "literal"]] {
        let whole = report(&folder, more);
        let expected = parameters(&folder);
        let model = folder.json("c.json");
        let stretches = report(&folder, &[more, &["--stream-above", "1kB"]].concat());
        for ([value, _], [by_whole, std_dev]) in parameters(&folder).iter().zip(&expected) {
            assert!((value - by_whole).abs() <= 1e-6 * std_dev, "{value} {by_whole} ± {std_dev}");
        }
        let ours = folder.json("c.json");
        for key in ["rigid_body_dynamics", "joint_dynamics", "preprocessing", "instrument"] {
            assert_eq!(ours[key], model[key], "{key}");
        }
        assert_eq!(stretches["samples_per_joint"], whole["samples_per_joint"]);
        for (ours, expected) in
            stretches["recordings"].as_array().unwrap().iter().zip(whole["recordings"].as_array().unwrap())
        {
            for key in ["file", "role", "samples", "unit", "warnings"] {
                assert_eq!(ours[key], expected[key], "{key}");
            }
            assert_eq!(ours["moving"]["samples"], expected["moving"]["samples"]);
            for key in ["mse", "nmse", "nrmse"] {
                assert_near(&numbers(&ours[key]), &numbers(&expected[key]));
                assert_near(&numbers(&ours["moving"][key]), &numbers(&expected["moving"][key]));
            }
            let (last, notes) = ours["notes"].as_array().unwrap().split_last().unwrap();
            assert!(last.as_str().unwrap().contains("in stretches"), "{last}");
            assert_eq!(notes, expected["notes"].as_array().unwrap().as_slice());
        }
    }
    // The model of the stretches is one that the other commands take.
    folder.run("predict --model c.json --data other_motion.csv --out predicted.csv").succeeded();
}

#[test]
fn what_stretches_cannot_do_is_refused_with_the_way_out() {
    let folder = folder("lugre");
    let line =
        || CALIBRATE.split_whitespace().filter(|word| *word != "--json").chain(["--stream-above", "0"]);
    folder.aurt(line()).refused(&["lugre", "searched", "more than 0B", "--stream-above 4"]);
    assert!(!folder.names().contains(&"p.csv".to_owned()));

    let folder = self::folder("sign");
    folder.aurt(line().chain(["--sample-rate-hz", "100"])).refused(&[
        "exciting_motion.csv",
        "125.000000 Hz, another was asked for",
        "uniform clock",
        "--stream-above",
    ]);
    // A stamp half a period late is no uniform clock; a corrupt row leaves a hole in one.
    let text = DEMO.read("demo/exciting_motion.csv");
    let late = |line: &str| {
        let stamp: f64 = line.split(',').next().unwrap().parse().unwrap();
        with_cell(line, 1, &(stamp + 0.004).to_string())
    };
    folder.write("exciting_motion.csv", &with_line(&text, 1000, late));
    folder.aurt(line()).refused(&["exciting_motion.csv", "off a grid of 0.008", "uniform clock"]);
    folder.write("exciting_motion.csv", &with_line(&text, 1000, |line| with_cell(line, 3, "1e9")));
    folder.aurt(line()).refused(&["exciting_motion.csv", "1 corrupt rows were dropped"]);
    // What is wrong with a file is told as it is of whole recordings.
    folder.write("exciting_motion.csv", &with_line(&text, 1000, |line| with_cell(line, 3, "x")));
    folder.aurt(line()).refused(&["exciting_motion.csv", "1000", "`x`"]);
    folder.aurt(line().map(|word| if word == "0" { "much" } else { word })).refused(&["500MB"]);
}

#[test]
fn a_whole_experiment_runs_in_stretches() {
    let folder = folder("sign");
    let run = |more: &[&str], out: &str| {
        let line = ["run", "experiment.toml", "--out", out].into_iter().chain(more.iter().copied());
        folder.aurt(line).succeeded();
        folder.json(&format!("{out}/metrics.json"))
    };
    let whole = run(&[], "whole");
    let stretches = run(&["--stream-above", "1kB"], "stretches");
    let values = |out: &str| column(&folder.read(&format!("{out}/calibrated_parameters.csv")), "value");
    let (ours, expected) = (values("stretches"), values("whole"));
    assert_eq!(ours.len(), expected.len());
    for (a, b) in ours.iter().zip(&expected) {
        assert!((a - b).abs() <= 1e-6 * (1.0 + b.abs()), "{a} {b}");
    }
    let recordings = |metrics: &Value| metrics["recordings"].as_array().unwrap().clone();
    for (ours, expected) in recordings(&stretches).iter().zip(recordings(&whole)) {
        for key in ["file", "role", "unit"] {
            assert_eq!(ours[key], expected[key]);
        }
        // Rows at rest at the ends of a held-out recording count here, and do not there.
        for (a, b) in numbers(&ours["moving"]["nrmse"]).iter().zip(numbers(&expected["moving"]["nrmse"])) {
            assert!((a - b).abs() <= 1e-4 * b, "{a} {b}");
        }
    }
    assert!(folder.read("stretches/report.html").contains("in stretches"));
    assert!(folder.json("stretches/rd_calibrated.json")["model"].is_object());

    let text = folder.read("experiment.toml");
    let windowed =
        text.replace("\"other_motion.csv\"", "{ file = \"other_motion.csv\", window_s = [0.0, 5.0] }");
    assert_ne!(text, windowed);
    folder.write("windowed.toml", &windowed);
    folder.run("run windowed.toml --out w --stream-above 0").refused(&[
        "other_motion.csv",
        "a part of the recording",
        "--stream-above",
    ]);
}
