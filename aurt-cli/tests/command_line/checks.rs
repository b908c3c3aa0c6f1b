//! `aurt check`.

use serde_json::Value;

use crate::support::{Folder, numbers, with_cell};

#[test]
fn a_good_recording_has_no_findings() {
    let folder = Folder::new().with_demo(&["exciting_motion.csv", "mdh.csv"]);
    let run = folder.aurt("check exciting_motion.csv --mdh mdh.csv --json".split(' ')).succeeded();
    let report: Value = serde_json::from_str(&run.stdout()).unwrap();
    assert_eq!(report["findings"].as_array().unwrap().len(), 0, "{}", report["findings"]);
    assert_eq!(report["excitation"]["rank"], 48);
    // The demo's motion has harmonics up to 1 Hz.
    let f_dyn_hz = report["suitable_f_dyn_hz"].as_f64().unwrap();
    assert!((2.0..=5.0).contains(&f_dyn_hz), "{f_dyn_hz}");
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
    let positions: String = folder
        .read("other_motion.csv")
        .lines()
        .map(|line| line.split(',').take(4).collect::<Vec<_>>().join(",") + "\n")
        .collect();
    folder.write("positions.csv", &positions);
    let report = folder.aurt("check positions.csv".split(' ')).succeeded().stdout();
    assert!(report.contains("3 joints, without measurement"), "{report}");
}

#[test]
fn what_should_be_heeded_gives_status_1() {
    let folder = Folder::new().with_demo(&["other_motion.csv"]);
    // Joint 2 holds its first angle.
    let text = folder.read("other_motion.csv");
    let angle = text.lines().nth(1).unwrap().split(',').nth(3).unwrap().to_owned();
    let held: String = text
        .lines()
        .enumerate()
        .map(|(k, line)| if k == 0 { line.to_owned() } else { with_cell(line, 4, &angle) } + "\n")
        .collect();
    folder.write("held.csv", &held);
    let run = folder.aurt("check held.csv".split(' '));
    assert_eq!(run.status(), 1, "{}", run.stderr());
    let said = run.stdout().split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        said.contains("only joints 0, 1, 3, 4 and 5 move; the friction of joint 2 is out of reach"),
        "{said}"
    );
    folder.aurt("check nowhere.csv".split(' ')).refused(&["nowhere.csv", "no such file"]);
}

#[test]
fn several_recordings_count_together() {
    let folder = Folder::new().with_demo(&["exciting_motion.csv", "other_motion.csv", "mdh.csv"]);
    // Joint 0 holds its first angle in one recording and moves in the other.
    let text = folder.read("exciting_motion.csv");
    let angle = text.lines().nth(1).unwrap().split(',').nth(1).unwrap().to_owned();
    let held: String = text
        .lines()
        .enumerate()
        .map(|(k, line)| if k == 0 { line.to_owned() } else { with_cell(line, 2, &angle) } + "\n")
        .collect();
    folder.write("held.csv", &held);
    let alone = folder.aurt("check held.csv --mdh mdh.csv".split(' '));
    assert_eq!(alone.status(), 1);
    assert!(alone.stdout().contains("out of reach"), "{}", alone.stdout());

    let run = folder.aurt("check held.csv other_motion.csv --mdh mdh.csv --json --out pages".split(' '));
    let report: Value = serde_json::from_str(&run.stdout()).unwrap();
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
    let rate_hz = 1.0 / {
        let stamps: Vec<f64> =
            text.lines().skip(1).take(2).map(|l| l.split(',').next().unwrap().parse().unwrap()).collect();
        stamps[1] - stamps[0]
    };
    let short: String = text.lines().take(1 + (5.0 * rate_hz) as usize).map(|l| format!("{l}\n")).collect();
    folder.write("short.csv", &short);
    folder
        .aurt("compile-rbd --mdh mdh.csv --gravity 0 0 -9.81 --out rbd.json --quiet".split(' '))
        .succeeded();
    let line = "compile-rd --model-rbd rbd.json --friction-torque-model none --friction-viscous-powers 1 --out rd.json --quiet";
    folder.aurt(line.split(' ')).succeeded();
    let line = "calibrate --model rd.json --data short.csv --gravity 0 0 -9.81 --f-dyn-hz 5 --out-params p.csv \
                --out-calibrated-model m.json --json";
    let calibrated: Value = serde_json::from_str(&folder.aurt(line.split(' ')).succeeded().stdout()).unwrap();
    let check = folder.aurt("check short.csv --mdh mdh.csv --f-dyn-hz 5 --json".split(' '));
    let checked: Value = serde_json::from_str(&check.stdout()).unwrap();
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
    let run = folder.aurt("check own.csv".split(' '));
    assert_eq!(run.status(), 1);
    let said = run.stdout().split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("nothing measured was recognised; if i0 … i"), "{said}");
    // What the message proposes is accepted as it stands.
    let start = said.find("{ file").unwrap();
    let proposed = said[start..].split(" (or unit").next().unwrap();
    let experiment = folder.read("experiment.toml");
    let start = experiment.find("[recordings]").unwrap();
    let end = start + 1 + experiment[start + 1..].find("\n[").unwrap();
    folder.write(
        "own.toml",
        &format!("{}[recordings]\ncalibration = [{proposed}]\n{}", &experiment[..start], &experiment[end..]),
    );
    folder.aurt("run own.toml --out own".split(' ')).succeeded();
}

/// Stamps in ms are told with the key that says so, written by `--fixed` and by `init`; what they propose runs.
#[test]
fn stamps_in_milliseconds_are_told_with_the_fix() {
    let folder = Folder::new().with_whole_demo();
    for name in ["exciting_motion.csv", "other_motion.csv", "point_to_point.csv"] {
        let text = folder.read(name);
        let stamp = |line: &str| match line.split_once(',') {
            Some((t, rest)) if t.parse::<f64>().is_ok() => {
                format!("{:.3},{rest}\n", 1e3 * t.parse::<f64>().unwrap())
            }
            _ => format!("{line}\n"),
        };
        folder.write(name, &text.lines().map(stamp).collect::<String>());
    }
    let run = folder.aurt("check experiment.toml --fixed fixed.toml".split(' '));
    let said = run.stdout().split_whitespace().collect::<Vec<_>>().join(" ");
    assert_eq!(run.status(), 1, "{said}");
    assert!(said.contains("seem to be in ms") && said.contains("time = \"ms\""), "{said}");
    assert!(!said.contains("no joint moves"), "{said}");
    folder.aurt("run fixed.toml --out fixed".split(' ')).succeeded();
    let drafted =
        "init exciting_motion.csv other_motion.csv --robot mdh.csv --gravity 0 0 -9.81 --out first.toml";
    folder.aurt(drafted.split(' '));
    assert!(folder.read("first.toml").contains("time = \"ms\""));
}

#[test]
fn remarks_are_no_findings() {
    let folder = Folder::new().with_demo(&["exciting_motion.csv", "mdh.csv"]);
    let text = folder.read("exciting_motion.csv");
    let turned: String = text
        .lines()
        .enumerate()
        .map(|(k, line)| {
            let cells: Vec<&str> = line.split(',').collect();
            let turn = if k > 400 { std::f64::consts::TAU } else { 0.0 };
            let cell = cells[1].parse::<f64>().map_or(cells[1].to_owned(), |q| (q + turn).to_string());
            with_cell(line, 2, &cell) + "\n"
        })
        .collect();
    folder.write("turned.csv", &turned);
    let run = folder.aurt("check turned.csv --mdh mdh.csv".split(' ')).succeeded();
    assert!(run.stdout().contains("was unwrapped"), "{}", run.stdout());
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
        folder.aurt(line.split(' ')).refused(&["copy.csv", "exciting_motion.csv", "each sample counts once"]);
    }
    let many = vec!["\"other_motion.csv\""; 1000].join(", ");
    folder.write("many.toml", &toml.replace("\"other_motion.csv\", \"point_to_point.csv\"", &many));
    for line in ["run many.toml --out out", "check many.toml"] {
        folder.aurt(line.split(' ')).refused(&["other_motion.csv", "validation", "each sample counts once"]);
    }
    folder.aurt("diagnose asked.toml --out out".split(' ')).refused(&["other_motion.csv", "not held-out"]);
    folder.aurt("check copy.csv exciting_motion.csv".split(' ')).refused(&["the same samples"]);
    // Every second row under another clock is a copy.
    let text = folder.read("exciting_motion.csv");
    let (header, rows) = text.split_once('\n').unwrap();
    let thinned = rows.lines().step_by(2).map(|row| {
        let (stamp, rest) = row.split_once(',').unwrap();
        format!("{:.4},{rest}\n", stamp.parse::<f64>().unwrap() + 7.3)
    });
    folder.write("copy.csv", &format!("{header}\n{}", thinned.collect::<String>()));
    let found = ["copy.csv", "holds every 2nd row of exciting_motion.csv"];
    folder.aurt("run twice.toml --out out".split(' ')).refused(&found);
    folder.write("held_out.toml", &toml.replace("\"other_motion.csv\", ", "\"copy.csv\", "));
    folder.aurt("run held_out.toml --out out".split(' ')).refused(&found);
    folder.aurt("diagnose held_out.toml --out out".split(' ')).refused(&found);
}
