//! Recordings that the clock cuts in the middle of a motion, and recordings with gaps: what the filters do not know does not count.
//!
//! With `count_ends = true`, which counts it, each of these fails.

use serde_json::Value;

use crate::support::{Folder, assert_has, numbers, one_line, rows};

/// The demo with rows of one recording in files of their own, validated on these.
fn cut(pieces: &[(&str, &dyn Fn(f64) -> bool)], count_ends: bool) -> Folder {
    let folder = Folder::new().with_whole_demo();
    let whole = folder.read("other_motion.csv");
    let (header, rows) = whole.split_once('\n').unwrap();
    let mut listed = "\"other_motion.csv\"".to_owned();
    for (name, is_kept) in pieces {
        let stamp_s = |row: &&str| row.split(',').next().unwrap().parse().unwrap();
        let kept: Vec<&str> = rows.lines().filter(|row| is_kept(stamp_s(row))).collect();
        folder.write(name, &format!("{header}\n{}\n", kept.join("\n")));
        listed.push_str(&format!(", \"{name}\""));
    }
    let text = folder.read("experiment.toml");
    let asked = text
        .replace(r#"["other_motion.csv", "point_to_point.csv"]"#, &format!("[{listed}]"))
        .replace("[preprocess]", &format!("[preprocess]\ncount_ends = {count_ends}"));
    folder.write("experiment.toml", &asked);
    folder.run("run experiment.toml --out results --quiet").succeeded();
    folder
}

/// Errors of a file's joints, root mean squares.
fn errors(folder: &Folder, file: &str) -> Vec<f64> {
    let metrics = folder.json("results/metrics.json");
    let recordings = metrics["recordings"].as_array().unwrap();
    let found: &Value = recordings.iter().find(|r| r["file"] == file).unwrap();
    numbers(&found["mse"]).iter().map(|mse| mse.sqrt()).collect()
}

/// How many times larger the error of a file is than that of the whole recording, on the worst joint.
fn worse(folder: &Folder, file: &str) -> f64 {
    let whole = errors(folder, "other_motion.csv");
    errors(folder, file).iter().zip(whole).map(|(part, whole)| part / whole).fold(0.0, f64::max)
}

/// 0.5 % were once 8.1 %.
#[test]
fn the_error_of_a_log_that_begins_and_ends_in_motion_is_that_of_the_motion() {
    let log: (&str, &dyn Fn(f64) -> bool) = ("log.csv", &|t| t > 5.1 && t < 7.6);
    let [right, counted] = [false, true].map(|count_ends| worse(&cut(&[log], count_ends), "log.csv"));
    assert!(right < 1.2 && counted > 2.0, "{right} {counted}");
}

/// Five gaps of 0.3 s made 4.8 % of 0.38 %.
#[test]
fn gaps_do_not_raise_the_error() {
    let gaps: (&str, &dyn Fn(f64) -> bool) =
        ("gaps.csv", &|t| (0..5).all(|k| !(0.0..0.3).contains(&(t - 3.0 * f64::from(k + 1)))));
    let [right, counted] = [false, true].map(|count_ends| worse(&cut(&[gaps], count_ends), "gaps.csv"));
    assert!(right < 1.2 && counted > 2.0, "{right} {counted}");
}

/// Predictions of the last 20 ms were once off by 73 Nm. `aurt predict` has a row for each of the log's: those within the filters'
/// memory are told, the others are what the whole recording gives.
#[test]
fn predictions_near_the_ends_of_a_log_are_told_and_the_others_exact() {
    let folder = cut(&[("log.csv", &|t| t > 3.013 && t < 8.55)], false);
    let predicted = |file: &str| -> Vec<Vec<f64>> {
        let predict = ["predict", "--model", "results/rd_calibrated.json", "--out", "p.csv", "--data", file];
        let said = one_line(&folder.aurt(predict).succeeded().stdout());
        assert_has(&said, &["the robot moves at an end or gap less than 0.352 s away"]);
        rows(&folder.read("p.csv"))
    };
    let (whole, log) = (predicted("other_motion.csv"), predicted("log.csv"));
    let first = whole.iter().position(|row| row[0] == log[0][0]).unwrap();
    let ends_s = [log[0][0] + 0.352, log[log.len() - 1][0] - 0.352];
    let (mut near, mut inside, mut largest) = (0.0_f64, 0.0_f64, 0.0_f64);
    for (row, of_whole) in log.iter().zip(&whole[first..]) {
        assert_eq!(row[0], of_whole[0]);
        let off = row.iter().zip(of_whole).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let is_inside = ends_s[0] < row[0] && row[0] < ends_s[1];
        let most = if is_inside { &mut inside } else { &mut near };
        *most = most.max(off);
        largest = of_whole[1..].iter().fold(largest, |most, v| most.max(v.abs()));
    }
    assert!(inside < 1e-3 && near < 0.05 * largest, "{inside} {near} {largest}");
}
