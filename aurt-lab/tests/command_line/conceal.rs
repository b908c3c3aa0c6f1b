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
    for command in ["prove", "conceal", "score", "setups"] {
        let own = lab(&folder, [command, "--help"]).succeeded().stdout();
        assert!(own.contains("Example:\n  aurt-lab "), "{own}");
    }
}
