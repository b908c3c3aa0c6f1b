//! `aurt-lab conceal`: cases of an experiment's own recordings, and plans that are refused.

use serde_json::Value;

use crate::lab::lab;
use crate::support::Folder;

const PLAN: &str =
    "[singles]\neffects = [\"coulomb\", \"payload\"]\nstrengths = [\"strong\"]\n[nulls]\ncount = 1\n";

fn concealed() -> Folder {
    let folder = Folder::new().with_whole_demo();
    folder.write("plan.toml", PLAN);
    let into = ["conceal", "--into", "experiment.toml", "--plan", "plan.toml", "--seed", "5"];
    let places = ["--cases", "injected/cases", "--sealed", "injected/sealed"];
    lab(&folder, into.into_iter().chain(places)).succeeded();
    folder
}

/// Gains are undone, references lie beside the cases, truths apart, and what is written is an experiment that runs.
#[test]
fn cases_of_an_experiments_own_recordings() {
    let folder = concealed();
    let names = |path: &str| -> Vec<String> {
        let entries = std::fs::read_dir(folder.path(path)).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    assert_eq!(names("injected/cases"), ["case_0001", "case_0002", "case_0003"]);
    assert_eq!(names("injected/sealed"), ["case_0001.json", "case_0002.json", "case_0003.json"]);
    let references = names("injected/references");
    for name in names("injected/sealed") {
        let truth: Value = folder.json(&format!("injected/sealed/{name}"));
        assert_eq!(truth["world"], "injected");
        assert!(references.iter().any(|r| *r == truth["reference"]), "{truth}");
    }
    let case = names("injected/cases/case_0001");
    assert_eq!(case, ["experiment.toml", "mdh.csv", "recording_1.csv", "recording_2.csv", "recording_3.csv"]);
    let experiment = folder.read("injected/cases/case_0001/experiment.toml");
    assert!(!experiment.contains("torque_constants") && experiment.contains("rotor_inertia"), "{experiment}");
    assert!(folder.read("injected/cases/case_0001/recording_1.csv").starts_with("t,q_0,"));
    let reference = format!("injected/references/{}/experiment.toml", references[0]);
    let run = folder.aurt(["diagnose", &reference, "--out", "as_it_is", "--verdict-only"]);
    assert!(run.status() < 2, "{}", run.stderr());
}

/// A recording of a servo arm has the columns of its case, and the same seed gives the same.
#[test]
fn a_concealed_servo_arm_records_one_more_motion() {
    let folder = Folder::new();
    folder.write("plan.toml", "[nulls]\ncount = 1\n");
    let conceal = "conceal --world servo --plan plan.toml --seed 5 --cases cases --sealed sealed";
    lab(&folder, conceal.split(' ')).succeeded();
    let header = folder.read("cases/case_0001/recording_1.csv").lines().next().unwrap().to_owned();
    let joints = header.matches("command_").count();
    let row = |k: u32| format!("{},{}\n", 0.1 * f64::from(k), vec!["0.1"; joints].join(","));
    let names: Vec<String> = (0..joints).map(|j| format!("q_{j}")).collect();
    folder
        .write("motion.csv", &format!("time,{}\n{}", names.join(","), (0..=20).map(row).collect::<String>()));
    let record = |truth: &str| {
        let line = format!("record --truth {truth} --motion motion.csv --seed 3 --out added.csv");
        lab(&folder, line.split(' '))
    };
    record("sealed/case_0001.json").succeeded();
    let added = folder.read("added.csv");
    assert!(added.starts_with(&header) && added.lines().count() > 90, "{added}");
    record("sealed/case_0001.json").succeeded();
    assert_eq!(folder.read("added.csv"), added);
    folder.edit("sealed/case_0001.json", |text| text.replace("\"servo\"", "\"clean\""));
    record("sealed/case_0001.json").refused(&["case_0001.json", "world `clean`"]);
}

#[test]
fn absurd_plans_are_refused_with_the_place() {
    let folder = Folder::new();
    let conceal = |plan: &str| {
        let options = ["conceal", "--seed", "1", "--cases", "c", "--sealed", "s", "--plan", plan];
        lab(&folder, options)
    };
    conceal("nowhere.toml").refused(&["nowhere.toml"]);
    folder.write("many.toml", "[singles]\ntrials = 9223372036854775807\n");
    conceal("many.toml").refused(&["many.toml", "at most 1000000"]);
    folder.write("nobody.toml", "[recordings]\n[nulls]\ncount = 1\nrobots = [\"nobody\"]\n");
    conceal("nobody.toml").refused(&["nobody.toml:4:", "unknown robot `nobody`"]);
    assert_eq!(folder.names(), ["many.toml", "nobody.toml"]);
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("/dev/zero", folder.path("zero")).unwrap();
        conceal("zero").refused(&["device"]);
    }
}

#[test]
fn every_command_has_help_with_an_example() {
    let folder = Folder::new();
    for command in ["prove", "conceal", "record", "score", "setups"] {
        let own = lab(&folder, [command, "--help"]).succeeded().stdout();
        assert!(own.contains("Example:\n  aurt-lab "), "{own}");
    }
}
