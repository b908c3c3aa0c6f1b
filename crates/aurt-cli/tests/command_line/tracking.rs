//! `aurt track`: a machine that stays as it is, one that gets a load, one whose friction grows.

use crate::support::Folder;

const LATER: [&str; 2] = ["later_motion.csv", "later_other_motion.csv"];

fn calibrated() -> Folder {
    let folder = Folder::new().with_whole_demo().with_demo(&LATER);
    folder.aurt(["run", "experiment.toml", "--out", "results"]).succeeded();
    folder
}

fn track(folder: &Folder, recordings: &[&str], out: &str) -> (i32, serde_json::Value) {
    let start = ["track", "experiment.toml", "--model", "results/rd_calibrated.json", "--out", out];
    let run = folder.aurt(start.iter().chain(recordings));
    assert!(run.status() < 2, "{}", run.stderr());
    (run.status(), folder.json(&format!("{out}/track.json")))
}

fn drift<'a>(found: &'a serde_json::Value, recording: usize, name: &str) -> &'a serde_json::Value {
    let parameters = found["parameters"].as_array().unwrap();
    let k = parameters.iter().position(|p| p["name"] == name).unwrap();
    &found["recordings"][recording]["drift"][k]
}

/// The demo's later recordings carry 2 kg; the charts say that it is the load and since when.
#[test]
fn a_load_is_noticed_and_an_unchanged_machine_is_not() {
    let folder = calibrated();
    let (status, found) = track(&folder, &["other_motion.csv", "exciting_motion.csv"], "unchanged");
    assert_eq!((status, found["alarms"].as_array().map(Vec::len)), (0, Some(0)), "{found}");
    let (status, found) = track(&folder, &["other_motion.csv", LATER[0], LATER[1]], "loaded");
    assert_eq!(status, 1);
    let alarm = found["alarms"].as_array().unwrap().iter().find(|a| a["group"] == "load").unwrap();
    assert_eq!((&alarm["since_recording"], &alarm["rose"]), (&LATER[0].into(), &true.into()), "{alarm}");
    let mass = drift(&found, 1, "payload.m_5");
    assert!((mass["value"].as_f64().unwrap() - 2.0).abs() < 0.2, "{mass}");
    let page = folder.read("loaded/report.html");
    assert!(page.contains("the load on the last link rose") && page.contains("<svg"));
}

#[test]
fn what_cannot_be_tracked_is_refused() {
    let folder = calibrated();
    let start = ["track", "experiment.toml", "--model", "results/rd_calibrated.json", "--out", "out"];
    let refused = |arguments: &[&str], words: &[&str]| {
        folder.aurt(start.iter().chain(arguments)).refused(words);
    };
    refused(&["results"], &["results", "no file that ends in .csv"]);
    refused(&["nowhere.csv"], &["nowhere.csv"]);
    refused(&["other_motion.csv", "--window-s", "15"], &["whole windows", "--window-s"]);
    assert!(!folder.names().contains(&"out".to_owned()));
}

/// The demo's robot with more friction in joint 4, as another logger recorded it.
const RUBBING: &str = r#"
robot = "ur10e"
seed = 21

[motion]
kind = "multi_sine"
duration_s = 20.0
harmonics = 8
top_hz = 1.0
share = 0.6

[logger]
rate_hz = 125

[[drive]]
joint = 1
load_coefficient = 0.08

[[drive]]
joint = 2
load_coefficient = 0.08

[[effect]]
name = "friction_level_changed"
joints = [4]
coulomb_change = [0.4]
viscous_change = [0.4]
"#;

#[test]
fn friction_that_grows_is_named_with_its_joint_and_size() {
    let folder = calibrated();
    folder.write("scenario.toml", RUBBING);
    folder.aurt(["simulate", "--scenario", "scenario.toml", "--out", "rubbing.csv"]).succeeded();
    let (status, found) = track(&folder, &["other_motion.csv", "rubbing.csv"], "rubbing");
    assert_eq!(status, 1);
    let alarms = found["alarms"].as_array().unwrap();
    assert_eq!(alarms[0]["parameter"], "friction_4", "{alarms:?}");
    let grown = drift(&found, 1, "friction_4");
    let ends: Vec<f64> = crate::support::numbers(&grown["interval_95"]);
    assert!(ends[0] < 0.4 && 0.4 < ends[1] && ends[0] > 0.2, "{grown}");
}
