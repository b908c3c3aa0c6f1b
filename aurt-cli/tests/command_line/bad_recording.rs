//! Recordings with faults: the message names file, line, column and remedy, and nothing is left behind. What is wrong with cells and
//! rows is tested where they are read.

use crate::support::{Folder, assert_has, column, one_line, with_cell, with_line, without_constants};

const RECORDING: &str = "exciting_motion.csv";

fn experiment() -> Folder {
    let folder = Folder::new().with_demo(&["mdh.csv", "experiment.toml", RECORDING]);
    let validation = "validation = [\"other_motion.csv\", \"point_to_point.csv\"]";
    folder.edit("experiment.toml", |text| text.replace(validation, ""));
    folder
}

/// What `run` says of a changed recording; nothing may be left behind.
#[track_caller]
fn refusal(change: impl Fn(&str) -> String, words: &[&str]) -> String {
    let folder = experiment();
    folder.write(RECORDING, &change(&folder.read(RECORDING)));
    let said = folder.run("run experiment.toml --out out").refused(words);
    assert!(said.contains(RECORDING), "the file is not named in:\n{said}");
    assert_eq!(folder.names(), [RECORDING, "experiment.toml", "mdh.csv"]);
    said
}

fn at(line: usize, change: impl Fn(&str) -> String) -> impl Fn(&str) -> String {
    move |text| with_line(text, line, &change)
}

#[test]
fn a_missing_file() {
    let folder = experiment();
    std::fs::remove_file(folder.path(RECORDING)).unwrap();
    // The experiment's line and column are named.
    folder.run("run experiment.toml --out out").refused(&[
        "experiment.toml:25:16",
        RECORDING,
        "does not exist",
    ]);
    folder
        .run("predict --model m.json --data nowhere.csv --out p.csv")
        .refused(&["m.json", "there is no such file"]);
}

#[test]
fn the_place_is_underlined() {
    let said = refusal(at(100, |l| with_cell(l, 9, "oops")), &["line 100, column 9", "oops"]);
    let lines: Vec<&str> = said.lines().collect();
    let shown = lines.iter().position(|l| l.contains("100 │")).unwrap_or_else(|| panic!("{said}"));
    let column = |line: &str, what: &str| line.split(what).next().unwrap().chars().count();
    assert_eq!(column(lines[shown], "oops"), column(lines[shown + 1], "──"), "{said}");
}

#[test]
fn a_few_corrupt_rows_are_dropped_and_told_and_the_prediction_keeps_all_rows() {
    let folder = experiment();
    let text = folder.read(RECORDING);
    let corrupt =
        with_line(&with_line(&text, 500, |l| with_cell(l, 4, "1e150")), 900, |l| with_cell(l, 9, "-1e150"));
    folder.write(RECORDING, &corrupt);
    let report = one_line(&folder.run("run experiment.toml --out out").succeeded().stdout());
    assert_has(&report, &["dropped 2 corrupt rows (0.08 %): line 500"]);
    let predicted = folder.read("out/predicted_exciting_motion.csv");
    let [found, expected] = [&predicted, &text].map(|table| column(table, "timestamp"));
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-9, "{found} instead of {expected}");
    }
    let notes = folder.json("out/metrics.json")["recordings"][0]["notes"].to_string();
    assert!(notes.contains("dropped 2 corrupt rows"), "{notes}");
}

#[test]
fn too_few_samples() {
    let first =
        |rows: usize| move |text: &str| text.lines().take(1 + rows).collect::<Vec<_>>().join("\n") + "\n";
    refusal(first(1), &["too few"]);
    refusal(first(12), &["too few"]);
    let folder = experiment();
    folder.write(RECORDING, &first(300)(&folder.read(RECORDING)));
    folder.run("run experiment.toml --out out").refused(&[
        "samples per joint remain",
        "parameters",
        "record longer",
    ]);
    assert!(!folder.path("out").exists());
}

#[test]
fn a_recording_in_which_nothing_moves() {
    let still = |text: &str| {
        let row = text.lines().nth(1).unwrap();
        let rows: String =
            (0..500).map(|k| with_cell(row, 1, &format!("{:.4}", 0.008 * f64::from(k))) + "\n").collect();
        format!("{}\n{rows}", text.lines().next().unwrap())
    };
    refusal(still, &["no joint moves faster than 0.03 rad/s"]);
}

#[test]
fn a_recording_of_another_robot() {
    let five = |text: &str| {
        let without = |line: &str| {
            let cells = line.split(',').enumerate().filter(|(k, _)| *k != 6 && *k != 12);
            cells.map(|(_, cell)| cell).collect::<Vec<_>>().join(",") + "\n"
        };
        text.lines().map(without).collect::<String>()
    };
    refusal(five, &["5", "6"]);
}

#[test]
fn a_frequency_that_the_recording_cannot_hold() {
    let folder = experiment();
    folder.edit("experiment.toml", |text| text.replace("f_dyn_hz = 5.0", "f_dyn_hz = 20.0"));
    folder.run("run experiment.toml --out out").refused(&[
        RECORDING,
        "100 Hz",
        "125",
        "f_dyn_hz can be at most 12.4;",
    ]);
}

#[test]
fn units_that_differ() {
    let folder = Folder::new().with_whole_demo();
    folder.edit("other_motion.csv", |text| text.replace("actual_current_", "torque_"));
    folder.edit("experiment.toml", without_constants);
    folder.run("run experiment.toml --out out").refused(&[
        "exciting_motion.csv is in A",
        "other_motion.csv is in Nm",
        "torque_constants_nm_per_a",
    ]);
}

#[test]
fn a_table_of_another_robot_or_with_an_unreadable_angle() {
    let folder = experiment();
    let mdh = folder.read("mdh.csv");
    folder.write("mdh.csv", &mdh.lines().take(6).map(|l| format!("{l}\n")).collect::<String>());
    folder.run("run experiment.toml --out out").refused(&["experiment.toml", "5"]);
    folder.write("mdh.csv", &with_line(&mdh, 2, |l| with_cell(l, 1, "pi/x")));
    let line = "compile-rbd --mdh mdh.csv --gravity 0 0 -9.81 --out rbd.json";
    folder.run(line).refused(&["mdh.csv:2", "pi/x", "column 1 (alpha)"]);
    folder.write("mdh.csv", &mdh.replace("alpha,a,d", "alpha,a,e"));
    folder.run(line).refused(&["mdh.csv:1", "`e`", "alpha, a, d"]);
    assert!(!folder.path("rbd.json").exists());
}
