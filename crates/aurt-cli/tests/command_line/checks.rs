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
        said.contains("only joints 0, 1, 3, 4, 5 move; the friction of joint 2 is out of reach"),
        "{said}"
    );
    folder.aurt("check nowhere.csv".split(' ')).refused(&["nowhere.csv", "no such file"]);
}
