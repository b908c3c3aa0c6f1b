//! `aurt check`.

use serde_json::Value;

use crate::support::{Folder, assert_has, column, first_columns, numbers, one_line, with_cells, with_table};

#[test]
fn a_good_recording_has_no_findings() {
    let folder = Folder::new().with_demo(&["exciting_motion.csv", "mdh.csv"]);
    let run = folder.run("check exciting_motion.csv --mdh mdh.csv --json").succeeded();
    let report = run.json();
    assert_eq!(report["findings"].as_array().unwrap().len(), 0, "{}", report["findings"]);
    assert_eq!(report["excitation"]["rank"], 48);
    // The demo's motion has harmonics up to 1 Hz, and friction odd ones of these.
    let f_dyn_hz = report["suitable_f_dyn_hz"].as_f64().unwrap();
    assert!((4.0..=6.0).contains(&f_dyn_hz), "{f_dyn_hz}");
    for joint in report["joints"].as_array().unwrap() {
        // The simulated logger writes angles with seven decimals.
        let [low, high] = numbers(&joint["position_rad"])[..] else { panic!("{joint}") };
        assert!(low < high);
        assert!(joint["moving_share"].as_f64().unwrap() > 0.5, "{joint}");
        assert!(joint["bandwidth_hz"].as_f64().unwrap() < 5.0, "{joint}");
    }
}

#[test]
fn a_recording_needs_neither_geometry_nor_measurement() {
    let folder = Folder::new().with_demo(&["other_motion.csv"]);
    folder.write("positions.csv", &first_columns(&folder.read("other_motion.csv"), 4));
    folder.run("check positions.csv").says(&["3 joints, without measurement"]);
}

/// A recording with a column that holds its first value.
fn held(table: &str, column: usize) -> String {
    let first = table.lines().nth(1).unwrap().split(',').nth(column).unwrap();
    with_cells(table, |_, at, _| (at == column).then(|| first.to_owned()))
}

#[test]
fn what_should_be_heeded_gives_status_1() {
    let folder = Folder::new().with_demo(&["other_motion.csv"]);
    // Joint 2 holds its first angle.
    folder.write("held.csv", &held(&folder.read("other_motion.csv"), 3));
    let run = folder.run("check held.csv");
    assert_eq!(run.status(), 1, "{}", run.stderr());
    let words = ["only joints 0, 1, 3, 4 and 5 move; the friction of joint 2 is out of reach"];
    assert_has(&one_line(&run.stdout()), &words);
    folder.run("check nowhere.csv").refused(&["nowhere.csv", "no such file"]);
}

#[test]
fn several_recordings_count_together() {
    let folder = Folder::new().with_demo(&["exciting_motion.csv", "other_motion.csv", "mdh.csv"]);
    // Joint 0 holds its first angle in one recording and moves in the other.
    folder.write("held.csv", &held(&folder.read("exciting_motion.csv"), 1));
    let alone = folder.run("check held.csv --mdh mdh.csv");
    assert_eq!(alone.status(), 1);
    assert!(alone.stdout().contains("out of reach"), "{}", alone.stdout());

    let run = folder.run("check held.csv other_motion.csv --mdh mdh.csv --json --out pages");
    let report = run.json();
    let findings = report["findings"].to_string();
    assert!(!findings.contains("out of reach"), "{findings}");
    assert_eq!(report["together"]["excitation"]["rank"], 48);
    assert!(
        report["recordings"][0]["findings"].to_string().contains("only joints 1, 2, 3, 4 and 5 move"),
        "{report}"
    );
    let f_dyn_hz = report["suitable_f_dyn_hz"].as_f64().unwrap();
    let each =
        report["recordings"].as_array().unwrap().iter().map(|r| r["suitable_f_dyn_hz"].as_f64().unwrap());
    assert!(each.clone().all(|f| f <= f_dyn_hz) && each.into_iter().any(|f| f == f_dyn_hz), "{report}");
    assert!(folder.read("pages/held/report.html").contains("held.csv"));
    assert!(folder.read("pages/other_motion/report.html").contains("other_motion.csv"));
}

/// A warning that a calibration gives is a finding of the check before it, in the same words.
#[test]
fn check_and_calibration_mean_the_same_by_badly_excited() {
    let folder = Folder::new().with_demo(&["exciting_motion.csv", "mdh.csv"]);
    // Two seconds of the motion do not tell the parameters apart.
    let text = folder.read("exciting_motion.csv");
    let stamps = column(&text, "timestamp");
    let rate_hz = 1.0 / (stamps[1] - stamps[0]);
    let short: String = text.lines().take(1 + (5.0 * rate_hz) as usize).map(|l| format!("{l}\n")).collect();
    folder.write("short.csv", &short);
    folder.run("compile-rbd --mdh mdh.csv --gravity 0 0 -9.81 --out rbd.json --quiet").succeeded();
    let line = "compile-rd --model-rbd rbd.json --friction-torque-model none --friction-viscous-powers 1 --out rd.json --quiet";
    folder.run(line).succeeded();
    let line = "calibrate --model rd.json --data short.csv --gravity 0 0 -9.81 --f-dyn-hz 5 --out-params p.csv \
                --out-calibrated-model m.json --json";
    let calibrated = folder.run(line).succeeded().json();
    let checked = folder.run("check short.csv --mdh mdh.csv --f-dyn-hz 5 --json").json();
    let of = |list: &Value| -> Vec<String> {
        let all = list.as_array().unwrap().iter().map(|w| w.as_str().unwrap().to_owned());
        all.filter(|w| w.contains("badly excited") || w.contains("condition number")).collect()
    };
    let warned = of(&calibrated["warnings"]);
    assert!(!warned.is_empty(), "{calibrated}");
    assert_eq!(of(&checked["findings"]), warned);
}

#[test]
fn columns_that_are_not_recognised_are_asked_about() {
    let folder =
        Folder::new().with_demo(&["other_motion.csv", "mdh.csv", "experiment.toml", "exciting_motion.csv"]);
    let text = folder.read("other_motion.csv");
    let (header, rows) = text.split_once('\n').unwrap();
    let renamed = header.replace("actual_current_", "i");
    assert_ne!(renamed, header);
    folder.write("own.csv", &format!("{renamed}\n{rows}"));
    let run = folder.run("check own.csv");
    assert_eq!(run.status(), 1);
    let said = one_line(&run.stdout());
    assert!(said.contains("nothing measured was recognised; if i0 … i"), "{said}");
    // What the message proposes is accepted as it stands.
    let start = said.find("{ file").unwrap();
    let proposed = said[start..].split(" (or unit").next().unwrap();
    let recordings = format!("[recordings]\ncalibration = [{proposed}]\n");
    folder.write("own.toml", &with_table(&folder.read("experiment.toml"), "[recordings]", &recordings));
    folder.run("run own.toml --out own").succeeded();
}

/// Stamps in ms are told with the key that says so, written by `--fixed` and by `init`; what they propose runs.
#[test]
fn stamps_in_milliseconds_are_told_with_the_fix() {
    let folder = Folder::new().with_whole_demo();
    for name in ["exciting_motion.csv", "other_motion.csv", "point_to_point.csv"] {
        let stamp = |cell: &str| format!("{:.3}", 1e3 * cell.parse::<f64>().unwrap());
        folder.edit(name, |text| with_cells(text, |_, column, cell| (column == 0).then(|| stamp(cell))));
    }
    let run = folder.run("check experiment.toml --fixed fixed.toml");
    let said = one_line(&run.stdout());
    assert_eq!(run.status(), 1, "{said}");
    assert!(said.contains("seem to be in ms") && said.contains("time = \"ms\""), "{said}");
    assert!(!said.contains("no joint moves"), "{said}");
    folder.run("run fixed.toml --out fixed").succeeded();
    let drafted =
        "init exciting_motion.csv other_motion.csv --robot mdh.csv --gravity 0 0 -9.81 --out first.toml";
    folder.run(drafted);
    assert!(folder.read("first.toml").contains("time = \"ms\""));
}

#[test]
fn remarks_are_no_findings() {
    let folder = Folder::new().with_demo(&["exciting_motion.csv", "mdh.csv"]);
    let turned = |cell: &str| (cell.parse::<f64>().unwrap() + std::f64::consts::TAU).to_string();
    folder.edit("exciting_motion.csv", |text| {
        with_cells(text, |row, column, cell| (row >= 400 && column == 1).then(|| turned(cell)))
    });
    folder.run("check exciting_motion.csv --mdh mdh.csv").says(&["was unwrapped"]);
}

/// The same recording under two names, or in two roles, is refused by every command.
#[test]
fn a_sample_counts_once() {
    let folder = Folder::new().with_whole_demo();
    let toml = folder.read("experiment.toml");
    folder.write("copy.csv", &folder.read("exciting_motion.csv"));
    let twice = toml.replace("[\"exciting_motion.csv\"]", "[\"exciting_motion.csv\", \"copy.csv\"]");
    folder.write("twice.toml", &twice);
    let question = "target = [\"other_motion.csv\"]\nvalidation = [\"other_motion.csv\"]";
    let asked = toml.replace("validation = [\"other_motion.csv\", \"point_to_point.csv\"]", question);
    folder.write("asked.toml", &asked);
    for line in ["run twice.toml --out out", "diagnose twice.toml --out out", "check twice.toml"] {
        folder.run(line).refused(&["copy.csv", "exciting_motion.csv", "each sample counts once"]);
    }
    let many = vec!["\"other_motion.csv\""; 1000].join(", ");
    folder.write("many.toml", &toml.replace("\"other_motion.csv\", \"point_to_point.csv\"", &many));
    for line in ["run many.toml --out out", "check many.toml"] {
        folder.run(line).refused(&["other_motion.csv", "validation", "each sample counts once"]);
    }
    folder.run("diagnose asked.toml --out out").refused(&["other_motion.csv", "not held-out"]);
    folder.run("check copy.csv exciting_motion.csv").refused(&["the same samples"]);
    // Every second row under another clock is a copy.
    let text = folder.read("exciting_motion.csv");
    let (header, rows) = text.split_once('\n').unwrap();
    let thinned = rows.lines().step_by(2).map(|row| {
        let (stamp, rest) = row.split_once(',').unwrap();
        format!("{:.4},{rest}\n", stamp.parse::<f64>().unwrap() + 7.3)
    });
    folder.write("copy.csv", &format!("{header}\n{}", thinned.collect::<String>()));
    let found = ["copy.csv", "holds every 2nd row of exciting_motion.csv"];
    folder.run("run twice.toml --out out").refused(&found);
    folder.write("held_out.toml", &toml.replace("\"other_motion.csv\", ", "\"copy.csv\", "));
    folder.run("run held_out.toml --out out").refused(&found);
    folder.run("diagnose held_out.toml --out out").refused(&found);
}
