//! Recordings that lie in several files.

use crate::support::{Folder, column, real_recordings, with_cells};

/// The columns of a table of numbers whose names have one of these beginnings.
fn columns(text: &str, beginnings: &[&str]) -> String {
    let mut lines = text.lines().filter(|l| !l.trim().is_empty());
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let wanted: Vec<usize> =
        (0..header.len()).filter(|c| beginnings.iter().any(|b| header[*c].trim().starts_with(b))).collect();
    let cut = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        wanted.iter().map(|c| cells[*c]).collect::<Vec<_>>().join(",") + "\n"
    };
    std::iter::once(header.join(",").as_str()).chain(lines).map(cut).collect()
}

/// Cuts a recording in two, positions and currents, and gives it to the experiment that way.
fn split(folder: &Folder, name: &str) -> String {
    let text = folder.read(name);
    folder.write(&format!("q_{name}"), &columns(&text, &["timestamp", "actual_q_", "actual_qd_"]));
    folder.write(&format!("i_{name}"), &columns(&text, &["timestamp", "actual_current_"]));
    format!("{{ file = \"q_{name}\", joined = \"i_{name}\" }}")
}

/// What `run` calibrates, from the recordings as they are and from those cut in two.
fn assert_same_model(folder: &Folder, toml: &str, names: &[&str]) {
    folder.write("whole.toml", toml);
    let mut in_two = toml.to_owned();
    for name in names {
        in_two = in_two.replace(&format!("\"{name}\""), &split(folder, name));
    }
    assert_eq!(in_two.matches("joined").count(), names.len());
    folder.write("split.toml", &in_two);
    for which in ["whole", "split"] {
        folder.aurt(["run", &format!("{which}.toml"), "--out", which]).succeeded();
    }
    let model = |which: &str| folder.read(&format!("{which}/calibrated_parameters.csv"));
    assert_eq!(model("whole"), model("split"));
    let report = folder.read("split/metrics.json");
    assert!(report.contains("are joined by equal stamps"), "{report}");
}

#[test]
fn a_recording_in_two_files_gives_the_same_calibration() {
    let folder = Folder::new().with_whole_demo();
    let toml = folder.read("experiment.toml");
    assert_same_model(&folder, &toml, &["exciting_motion.csv", "other_motion.csv", "point_to_point.csv"]);
}

#[test]
fn a_real_recording_in_two_files_gives_the_same_calibration() {
    let Some(data) = real_recordings("a_real_recording_in_two_files_gives_the_same_calibration") else {
        return;
    };
    let folder = Folder::new();
    let names = ["excitation_30s.csv", "excitation_20s.csv"];
    for name in names.iter().chain(&["mdh.csv"]) {
        std::fs::copy(data.join("ur10e").join(name), folder.path(name)).unwrap();
    }
    let toml = "schema = 1\n[robot]\nmdh = \"mdh.csv\"\ngravity_m_s2 = [0.0, 0.0, -9.81]\n[recordings]\n\
                calibration = [\"excitation_30s.csv\"]\nvalidation = [\"excitation_20s.csv\"]\n[preprocess]\nf_dyn_hz = 2.5\n";
    assert_same_model(&folder, toml, &names);
}

#[test]
fn files_that_do_not_belong_together_are_refused_with_the_cure() {
    let folder = Folder::new().with_whole_demo();
    let toml = folder.read("experiment.toml");
    let entry = split(&folder, "exciting_motion.csv");
    let refused = |entry: &str, words: &[&str]| {
        folder.write("joined.toml", &toml.replace("\"exciting_motion.csv\"", entry));
        folder.run("run joined.toml --out out").refused(words);
        assert!(!folder.path("out").exists());
    };
    let later = |stamp: &str| format!("{:.4}", stamp.parse::<f64>().unwrap() + 5e3);
    folder.edit("i_exciting_motion.csv", |text| {
        with_cells(text, |_, column, cell| (column == 0).then(|| later(cell)))
    });
    refused(&entry, &["do not overlap", "clock_offset_s = -5000"]);
    refused(
        "{ file = \"exciting_motion.csv\", joined = [\"other_motion.csv\"] }",
        &["both have joint positions", "take = [\"measurement\"]"],
    );
    refused(
        "{ file = \"exciting_motion.csv\", take = [\"measurement\"] }",
        &["`take`", "leaves out the positions", "under `joined`"],
    );
    refused(
        "{ file = \"exciting_motion.csv\", joined = [{ file = \"other_motion.csv\", take = [\"mesurement\"] }] }",
        &["did you mean `measurement`?"],
    );
    refused("{ file = \"exciting_motion.csv\", joined = [\"none.csv\"] }", &["none.csv", "does not exist"]);
}

/// Units stated at any level hold for the quantity, in whichever file it lies.
#[test]
fn units_of_a_recording_in_two_files_are_those_of_its_quantities() {
    let folder = Folder::new().with_whole_demo();
    let toml = folder.read("experiment.toml");
    let entry = split(&folder, "exciting_motion.csv");
    let degrees = |cell: &str| cell.parse::<f64>().unwrap().to_degrees().to_string();
    folder.edit("q_exciting_motion.csv", |text| {
        with_cells(text, |_, column, cell| (column > 0).then(|| degrees(cell)))
    });
    let entry = entry.replace(" }", ", angle = \"deg\" }");
    folder.write("degrees.toml", &toml.replace("\"exciting_motion.csv\"", &entry));
    for (experiment, out) in [("experiment.toml", "whole"), ("degrees.toml", "degrees")] {
        folder.run(format!("run {experiment} --out {out}")).succeeded();
    }
    let values = |out: &str| column(&folder.read(&format!("{out}/calibrated_parameters.csv")), "value");
    for (one, two) in values("whole").iter().zip(values("degrees")) {
        assert!((one - two).abs() < 1e-4 * one.abs().max(1.0), "{one} {two}");
    }
}
