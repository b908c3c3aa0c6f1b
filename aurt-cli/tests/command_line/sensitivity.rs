//! `aurt sensitivity`: effects added to the recordings of an experiment.

use crate::support::Folder;

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
