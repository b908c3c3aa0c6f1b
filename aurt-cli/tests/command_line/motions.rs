//! Planned motions in every format: what AURT and parsers of others read of them.

use std::process::Command;

use aurt::simulation::Motion;
use aurt_recording::{ReadOptions, Recording, read_recording};
use serde_json::Value;

use crate::support::Folder;

const PLANNED: &str = "excite --robot ur10e --kind sweeps --duration-s 12 --seed 3 --rate-hz 50";

fn read(folder: &Folder, name: &str) -> Recording {
    let options = ReadOptions { needs_measurement: false, accepts_plan: true, ..ReadOptions::default() };
    read_recording(&folder.path(name), &options).unwrap()
}

fn written() -> (Folder, aurt_recording::PlannedMotion) {
    let folder = Folder::new();
    for name in ["motion.csv", "motion.yaml", "motion.script", "motion.mcap", "motion.lerobot"] {
        folder.run(format!("{PLANNED} --out {name}")).succeeded();
    }
    let motion = Motion::Sweeps { duration_s: 12.0, share: 0.8 };
    let robot = aurt::simulation::robots::ur10e();
    let names = read(&folder, "motion.mcap").joints.names().to_vec();
    let planned = motion.plan(&robot, 3).unwrap().planned(50.0, &names).unwrap();
    (folder, planned)
}

#[test]
fn a_bag_and_a_data_set_are_followed_and_not_taken_for_a_recording() {
    let (folder, _) = written();
    for name in ["motion.mcap", "motion.lerobot"] {
        let scenario =
            format!("robot = \"ur10e\"\nseed = 1\n[motion]\nkind = \"recorded\"\nfile = \"{name}\"\n");
        folder.write("scenario.toml", &scenario);
        folder.run("simulate --scenario scenario.toml --out recorded.csv").succeeded();
    }
    // A bag with a plan has nothing measured.
    folder.run("init --robot ur10e motion.mcap --out experiment.toml").refused(&["JointState"]);
}

#[test]
fn a_data_set_is_replaced_but_no_other_one() {
    let folder = Folder::new();
    let line = format!("{PLANNED} --out motion.lerobot");
    folder.run(&line).succeeded();
    folder.run(&line).succeeded();
    folder.run(line.replace("50", "12.5")).refused(&["--rate-hz", "12.5", "whole"]);
    folder.write("motion.lerobot/data/chunk-000/file-001.parquet", "another episode");
    folder.run(line).refused(&["--out", "data/chunk-000/file-001.parquet", "new folder"]);
}

#[test]
fn a_motion_has_a_known_ending_or_none() {
    let folder = Folder::new();
    for name in ["motion.cvs", "motion.CSV", "motion.json"] {
        let words = ["--out", name, ".csv, .yaml, .script, .mcap or .lerobot"];
        folder.run(format!("{PLANNED} --out {name}")).refused(&words);
    }
    assert!(folder.names().is_empty());
    folder.run(format!("{PLANNED} --out motion")).succeeded();
    assert!(folder.read("motion").starts_with("time,q_0"));
}

#[test]
fn parsers_of_others_read_the_same_numbers() {
    let python = std::env::var("AURT_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has = Command::new(&python).args(["-c", "import mcap_ros2, pandas, pyarrow, yaml"]).output();
    if !has.is_ok_and(|output| output.status.success()) {
        println!("skipped: {python} lacks mcap-ros2-support, pandas, pyarrow or pyyaml");
        return;
    }
    let (folder, planned) = written();
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/command_line/read_motions.py");
    let run = Command::new(python).arg(script).arg(folder.path("")).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let found: Value = serde_json::from_slice(&run.stdout).unwrap();
    let bits = |value: f64| Value::from(format!("{:016x}", value.to_bits()));
    let row = |series: &[Vec<f64>], k: usize| series.iter().map(|s| bits(s[k])).collect::<Value>();
    let [bag, data_set, goal, script] = ["bag", "data_set", "goal", "script"].map(|key| &found[key]);
    for read in [bag, goal] {
        assert_eq!(read["names"], planned.joint_names.iter().cloned().collect::<Value>());
    }
    let motors = planned.joint_names.iter().map(|name| format!("{name}.pos")).collect::<Value>();
    assert_eq!((&data_set["names"], &data_set["fps"]), (&motors, &Value::from(50)));
    assert_eq!(bag["points"].as_array().unwrap().len(), planned.time_s.len());
    assert_eq!(data_set["points"].as_array().unwrap().len(), planned.time_s.len());
    assert_eq!(script["positions"].as_array().unwrap().len(), planned.time_s.len());
    assert_eq!((&script["start"], &script["period_s"]), (&script["positions"][0], &Value::from(0.02)));
    for (k, time_s) in planned.time_s.iter().enumerate() {
        let time_ns = Value::from((time_s * 1e9).round() as u64);
        let series = [&planned.position_rad, &planned.velocity_rad_s, &planned.acceleration_rad_s2];
        let [q, qd, qdd] = series.map(|series| row(series, k));
        assert_eq!(bag["points"][k], Value::from(vec![time_ns.clone(), q, qd, qdd]));
        let q = planned.position_rad.iter().map(|s| bits(f64::from(s[k] as f32))).collect::<Value>();
        assert_eq!(data_set["points"][k], Value::from(vec![bits(f64::from(*time_s as f32)), q]));
        assert_eq!(goal["times_ns"][k], time_ns);
        for (joint, series) in planned.position_rad.iter().enumerate() {
            for read in [goal, script] {
                assert!((read["positions"][k][joint].as_f64().unwrap() - series[k]).abs() < 1e-9);
            }
        }
    }
}
