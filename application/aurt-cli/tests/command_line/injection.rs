//! Effects added to the recordings of an experiment: `conceal --into` and `sensitivity`.

use serde_json::Value;

use crate::support::Folder;

const PLAN: &str =
    "[singles]\neffects = [\"coulomb\", \"payload\"]\nstrengths = [\"strong\"]\n[nulls]\ncount = 1\n";

fn concealed() -> Folder {
    let folder = Folder::new().with_whole_demo();
    folder.write("plan.toml", PLAN);
    let into = ["conceal", "--into", "experiment.toml", "--plan", "plan.toml", "--seed", "5"];
    let places = ["--cases", "injected/cases", "--sealed", "injected/sealed"];
    folder.aurt(into.into_iter().chain(places)).succeeded();
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

/// Limits are sizes in physical units, as a table for people, a page and a file.
#[test]
fn sensitivity_says_sizes_per_joint() {
    let folder = Folder::new().with_whole_demo();
    let narrow = ["--effects", "current_offset", "--joints", "2", "--out", "sensitivity"];
    folder.aurt(["sensitivity", "experiment.toml"].into_iter().chain(narrow)).succeeded();
    let found = folder.json("sensitivity/sensitivity.json");
    let row = &found["limits"][0];
    assert_eq!((row["effect"].as_str(), row["joint"].as_u64()), (Some("current_offset"), Some(2)));
    assert_eq!(row["unit"], "Nm");
    if row["status"] == "named" {
        let named = row["named_from"]["size"].as_f64().unwrap();
        let noticed = row["noticed_from"]["size"].as_f64().unwrap();
        assert!(0.0 < noticed && noticed <= named, "{row}");
    }
    let page = folder.read("sensitivity/report.html");
    assert!(page.contains("current_offset") && page.contains("<svg"));
}

/// A whole diagnosis names what is twice as large as the trials say, and not what is half as large.
#[test]
fn whole_diagnoses_agree_with_a_limit() {
    let later = ["later.toml", "later_motion.csv", "later_other_motion.csv"];
    let folder = Folder::new().with_whole_demo().with_demo(&later);
    let narrow = ["--effects", "spring", "--joints", "2", "--out", "sensitivity", "--check=1"];
    let run = folder.aurt(["sensitivity", "later.toml"].into_iter().chain(narrow));
    assert!(run.status() == 0, "{}", run.stderr());
    let found = folder.json("sensitivity/sensitivity.json");
    assert_eq!(found["limits"][0]["status"], "named", "{found}");
    assert_eq!(found["limits"][0]["draws"].as_array().map(Vec::len), Some(5));
    let check = &found["checks"][0];
    assert_eq!(
        (&check["named_at_double"], &check["named_at_half"]),
        (&true.into(), &false.into()),
        "{check}"
    );
}

#[test]
fn wrong_effects_joints_and_experiments_are_refused() {
    let folder = Folder::new().with_whole_demo();
    let start = ["sensitivity", "experiment.toml", "--out", "out"];
    let refused = |arguments: &[&str], words: &[&str]| {
        folder.aurt(start.iter().chain(arguments)).refused(words);
    };
    refused(&["--effects", "sprign"], &["sprign", "did you mean `spring`"]);
    refused(&["--effects", "backlash"], &["backlash", "known are coulomb"]);
    refused(&["--joints", "6"], &["no joint 6", "0 to 5"]);
    assert!(!folder.names().contains(&"out".to_owned()));
}
