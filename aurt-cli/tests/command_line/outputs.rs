//! Outputs appear whole or not at all.

use std::fs;

use crate::support::{DEMO, Folder, with_cell, with_line};

fn experiment() -> Folder {
    Folder::new().with_demo(&[
        "mdh.csv",
        "experiment.toml",
        "exciting_motion.csv",
        "other_motion.csv",
        "point_to_point.csv",
    ])
}

#[test]
fn impossible_outputs_are_refused_first() {
    let folder = experiment();
    let run = |line: &str| folder.aurt(line.split_whitespace());
    run("compile-rbd --mdh mdh.csv --gravity 0 0 -9.81 --out .").refused(&["--out", "is a folder"]);
    run("compile-rbd --mdh mdh.csv --gravity 0 0 -9.81 --out no/rbd.json").refused(&[
        "no/rbd.json",
        "not an existing folder",
        "create the folder first",
    ]);
    run("compile-rbd --mdh mdh.csv --gravity 0 0 -9.81 --out mdh.csv")
        .refused(&["is an input", "overwritten"]);
    run("run experiment.toml --out mdh.csv").refused(&["is a file", "a folder is needed"]);
    run("run experiment.toml --out no/where").refused(&["not an existing folder"]);
    run("demo --out experiment.toml").refused(&["is a file"]);
}

#[test]
fn a_failing_run_leaves_nothing() {
    let folder = experiment();
    let corrupt = with_line(&folder.read("point_to_point.csv"), 700, |l| with_cell(l, 9, "nan"));
    folder.write("point_to_point.csv", &corrupt);
    folder.aurt("run experiment.toml --out out".split(' ')).refused(&["point_to_point.csv", "700"]);
    assert!(!folder.path("out").exists());

    // What an earlier run left stays as it was.
    fs::create_dir(folder.path("out")).unwrap();
    folder.write("out/metrics.json", "earlier");
    folder.aurt("run experiment.toml --out out".split(' ')).refused(&["700"]);
    assert_eq!(folder.read("out/metrics.json"), "earlier");
    assert_eq!(fs::read_dir(folder.path("out")).unwrap().count(), 1);
}

#[test]
fn recordings_of_one_name_keep_their_predictions_apart() {
    let folder = experiment();
    fs::create_dir(folder.path("second")).unwrap();
    fs::rename(folder.path("other_motion.csv"), folder.path("second/exciting_motion.csv")).unwrap();
    let toml =
        folder.read("experiment.toml").replace("\"other_motion.csv\"", "\"second/exciting_motion.csv\"");
    folder.write("experiment.toml", &toml);
    folder.aurt("run experiment.toml --out out".split(' ')).succeeded();
    let demo = |name: &str| DEMO.read(&format!("demo/{name}"));
    assert_eq!(folder.read("out/predicted_exciting_motion.csv"), demo("predicted_exciting_motion.csv"));
    assert_eq!(folder.read("out/predicted_exciting_motion_2.csv"), demo("predicted_other_motion.csv"));
    let metrics = folder.json("out/metrics.json");
    assert_eq!(metrics["recordings"][1]["prediction"], "predicted_exciting_motion_2.csv");
}

#[test]
fn the_demo_does_not_overwrite_an_experiment_of_the_user() {
    let folder = Folder::new();
    folder.write("experiment.toml", "schema = 1 # mine\n");
    folder.aurt("demo --out .".split(' ')).refused(&["experiment.toml", "your own", "another folder"]);
    assert_eq!(folder.names(), ["experiment.toml"]);
}
