//! `report.html` and `--plots`.

use std::fs;

use serde_json::Value;

use crate::support::{DEMO, Folder, assert_has};

/// The document that a report carries for programs.
fn embedded(report: &str) -> Value {
    let begin = "<script type=\"application/json\" id=\"results\">";
    let (_, rest) = report.split_once(begin).unwrap();
    let (document, _) = rest.split_once("</script>").unwrap();
    serde_json::from_str(document).unwrap()
}

fn assert_self_contained(report: &str) {
    for forbidden in [" src=", "@import", "url(", "<link", "<iframe", "fetch(", "XMLHttpRequest"] {
        assert!(!report.contains(forbidden), "a report contains `{forbidden}`");
    }
    let links = report.split("href=\"").skip(1).filter(|rest| !rest.starts_with('#')).count();
    assert_eq!(links, 0);
    let places: Vec<&str> =
        report.split("http").skip(1).map(|rest| rest.split(['"', ' ', '<']).next().unwrap_or("")).collect();
    let namespace = |place: &&str| place.starts_with("://www.w3.org/2000/svg") || place.starts_with("-equiv");
    assert!(places.iter().all(namespace), "{places:?}");
}

#[test]
fn a_report_carries_what_metrics_json_holds() {
    let report = DEMO.read("demo/report.html");
    assert_self_contained(&report);
    assert!(report.len() < 3_000_000, "{} bytes", report.len());
    let metrics = DEMO.json("demo/metrics.json");
    assert_eq!(embedded(&report), metrics);
    for joint in 0..6 {
        assert!(report.contains(&format!(">joint {joint}<")), "joint {joint}");
    }
    assert_has(&report, &["F_C1_2", "rotor_inertia.I_a_5", "weights 1/σ²", "filters: positions", "Seed"]);
}

#[test]
fn names_of_files_and_what_they_hold_are_text() {
    let folder = Folder::new().with_whole_demo();
    let evil = "x<img src=a onerror=alert(1)>&amp;'.csv";
    fs::rename(folder.path("other_motion.csv"), folder.path(evil)).unwrap();
    let toml = folder.read("experiment.toml").replace("\"other_motion.csv\"", &format!("\"{evil}\""));
    folder.write("experiment.toml", &format!("{toml}# </script><script>alert(2)</script>\n"));
    folder.run("run experiment.toml --out out --plots out/plots").succeeded();
    let report = folder.read("out/report.html");
    assert!(!report.contains("<img"), "a file name became markup");
    assert!(!report.contains("<script>alert"), "an experiment became a script");
    assert!(report.contains("x&lt;img src=a onerror=alert(1)&gt;&amp;amp;&#39;.csv"));
    assert_eq!(report.matches("<script").count(), 2);
    assert_eq!(embedded(&report)["recordings"][1]["file"], evil);
    for entry in fs::read_dir(folder.path("out/plots")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let stem = name.strip_suffix(".svg").unwrap_or_else(|| panic!("{name}"));
        assert!(stem.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-'), "{name}");
    }
}

#[test]
fn every_figure_can_be_had_as_a_file() {
    let folder = Folder::new().with_demo(&["mdh.csv", "exciting_motion.csv"]);
    let line = "check exciting_motion.csv --mdh mdh.csv --out check --plots new/plots --json";
    let run = folder.run(line).succeeded();
    let outputs = run.json();
    let outputs = outputs["outputs"].as_array().unwrap();
    assert_self_contained(&folder.read("check/report.html"));
    let figures = folder.read("check/report.html").matches("<figure").count();
    assert_eq!(outputs.len(), 1 + figures);
    for path in outputs.iter().skip(1) {
        let svg = folder.read(path.as_str().unwrap());
        assert!(svg.starts_with("<svg xmlns=") && svg.ends_with("</svg>\n"), "{path}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{path}");
    }
}

#[test]
fn calibrating_and_validating_leaves_a_report_beside_the_model() {
    let folder = Folder::new().with_demo(&["mdh.csv", "exciting_motion.csv"]);
    let run = |line: &str| folder.run(line).succeeded();
    run("compile-rbd --mdh mdh.csv --gravity 0 0 -9.81 --out rbd.json");
    run(
        "compile-rd --model-rbd rbd.json --friction-torque-model none --friction-viscous-powers 1 --out rd.json",
    );
    let line = "calibrate-validate --model rd.json --data exciting_motion.csv --calibration-data-rel 0.7 \
                --f-dyn-hz 5 --out-params p.csv --out-calibrated-model c.json --out-prediction y.csv";
    run(line);
    let report = folder.read("report.html");
    assert_self_contained(&report);
    let roles: Vec<Value> =
        embedded(&report)["recordings"].as_array().unwrap().iter().map(|r| r["role"].clone()).collect();
    assert_eq!(roles, ["calibration", "validation"]);
    folder
        .run(format!("{line} --out-report p.csv"))
        .refused(&["--out-report", "is the file of --out-params too"]);
}
