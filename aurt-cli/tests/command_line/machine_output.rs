//! What scripts rely on: JSON and nothing else on standard output, silence when asked for, exit statuses.

use serde_json::Value;

use crate::support::{DEMO, Folder, numbers};

#[test]
fn the_metrics_file_is_as_documented() {
    let metrics = DEMO.json("demo/metrics.json");
    assert_eq!(metrics["base_parameters"], 36);
    assert_eq!(metrics["parameters"], 54);
    assert!(metrics["condition_number"].as_f64().unwrap() > 1.0);
    assert_eq!(metrics["load_torque"], "fitted");
    let recordings = metrics["recordings"].as_array().unwrap();
    let files: Vec<&str> = recordings.iter().map(|r| r["file"].as_str().unwrap()).collect();
    assert_eq!(files, ["exciting_motion.csv", "other_motion.csv", "point_to_point.csv"]);
    for recording in recordings {
        assert_eq!(recording["unit"], "Nm");
        assert!(["calibration", "validation"].contains(&recording["role"].as_str().unwrap()));
        let samples = recording["samples"].as_u64().unwrap();
        for place in [recording, &recording["moving"]] {
            for key in ["mse", "nmse", "nrmse"] {
                assert_eq!(numbers(&place[key]).len(), 6, "{key}");
            }
        }
        let moving = numbers(&recording["moving"]["samples"]);
        assert!(moving.iter().all(|m| *m > 0.0 && *m <= samples as f64), "{recording}");
        let prediction = recording["prediction"].as_str().unwrap();
        let rows = DEMO.read(&format!("demo/{prediction}")).lines().count();
        assert_eq!(rows, DEMO.read(&format!("demo/{}", recording["file"].as_str().unwrap())).lines().count());
    }
}

#[test]
fn every_command_answers_in_json() {
    let folder = Folder::new().with_demo(&["mdh.csv"]);
    let lines = [
        "demo --json --out demo",
        "--json run demo/experiment.toml --out again",
        "compile-rbd --json --mdh mdh.csv --gravity 0 0 -9.81 --out rbd.json",
        "compile-rd --json --model-rbd rbd.json --friction-torque-model none --friction-viscous-powers 1 --out rd.json",
        "calibrate --json --model rd.json --data demo/exciting_motion.csv --out-params p.csv \
         --out-calibrated-model c.json --f-dyn-hz 5",
        "predict --json --model c.json --data demo/other_motion.csv --out predicted.csv",
        "check --json demo/exciting_motion.csv",
        "calibrate-validate --json --model rd.json --data demo/exciting_motion.csv --calibration-data-rel 0.7 \
         --f-dyn-hz 5 --out-params p.csv --out-calibrated-model c.json --out-prediction y.csv",
        "export --json c demo/rd_calibrated.json --out exported",
        "completions --json bash",
        "man --json --out pages",
        "models --json",
        "explain --json square",
        "explain --json",
        "new-plugin --json my-model",
    ];
    for line in lines {
        let run = folder.run(line).succeeded();
        let document: Value =
            serde_json::from_str(&run.stdout()).unwrap_or_else(|e| panic!("{line}: {e}\n{}", run.stdout()));
        let name = line.split(' ').find(|word| !word.starts_with('-')).unwrap();
        assert_eq!(document["command"], name, "{line}");
        assert_eq!(run.stderr(), "", "{line}");
    }
    let same =
        |name: &str| assert_eq!(folder.read(&format!("demo/{name}")), folder.read(&format!("again/{name}")));
    same("calibrated_parameters.csv");
    same("predicted_point_to_point.csv");
    same("rd_calibrated.json");
}

#[test]
fn a_failure_is_json_too() {
    let folder = Folder::new();
    let run = folder.run("run nowhere.toml --out out --json");
    assert_eq!(run.status(), 2);
    let document = run.json();
    let problem = &document["error"]["problems"][0];
    assert_eq!(problem["file"], "nowhere.toml");
    assert!(problem["message"].as_str().unwrap().contains("there is no such file"), "{problem}");
    assert!(run.stderr().contains("nowhere.toml"));
}

#[test]
fn quiet_is_silent_but_for_errors() {
    let folder = Folder::new();
    let run = folder.run("demo --quiet --out demo").succeeded();
    assert_eq!(run.stdout() + &run.stderr(), "");
    folder.run("run --quiet nowhere.toml --out out").refused(&["nowhere.toml"]);
}

#[test]
fn reports_fit_a_terminal_of_80_columns_and_are_plain_where_nobody_looks() {
    let folder = Folder::new();
    let mut reports = folder.run("demo").succeeded().stdout();
    reports += &folder.run("models").succeeded().stdout();
    reports += &folder.run("explain gms").succeeded().stdout();
    reports += &folder.run("explain").succeeded().stdout();
    // Examples are there to be copied: they stay on one line.
    for line in reports.lines().filter(|l| !l.contains("= { model")) {
        assert!(line.chars().count() <= 80, "{line}");
        assert!(!line.contains('\u{1b}'), "{line:?}");
    }
}
