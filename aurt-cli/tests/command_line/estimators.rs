//! Estimators beyond least squares, as an experiment asks for them.

use crate::support::Folder;

/// The demo with powers of the velocity that its machine does not have.
fn demo(estimator: &str) -> Folder {
    let folder = Folder::new().with_whole_demo();
    let text = folder.read("experiment.toml").replace("powers = [1]", "powers = [1, 2, 3]");
    folder.write("experiment.toml", &format!("{text}\n[calibration]\nestimator = \"{estimator}\"\n"));
    folder
}

/// Mean over the joints of the error on the recording that took no part.
fn held_out(folder: &Folder) -> f64 {
    let metrics = folder.json("results/metrics.json");
    let recordings = metrics["recordings"].as_array().unwrap();
    let other = recordings.iter().find(|r| r["file"] == "other_motion.csv").unwrap();
    let errors = crate::support::numbers(&other["mse"]);
    errors.iter().sum::<f64>() / errors.len() as f64
}

#[test]
fn the_essential_parameters_are_those_that_the_machine_has() {
    let (all, few) = (demo("wls"), demo("essential"));
    all.aurt(["run", "experiment.toml", "--out", "results"]).succeeded();
    let said = few.aurt(["run", "experiment.toml", "--out", "results"]).succeeded().stdout();
    let report = few.json("results/metrics.json")["essential"].clone();
    let steps = report["steps"].as_array().unwrap();
    let eliminated: Vec<&str> =
        steps.iter().filter(|s| s["eliminated"] == true).map(|s| s["parameter"].as_str().unwrap()).collect();
    let superfluous = |joint: usize| [format!("F_v2_{joint}"), format!("F_v3_{joint}")];
    let gone = (0..6).flat_map(superfluous).filter(|name| eliminated.contains(&name.as_str())).count();
    assert!(gone >= 10, "only {gone} of the 12 that do not exist were found: {eliminated:?}");
    for real in ["F_C0_0", "F_v1_0", "F_C0_1", "F_v1_5", "rotor_inertia.I_a_2"] {
        assert!(!eliminated.contains(&real), "{real} exists: {eliminated:?}");
    }
    let count = |what: &str| report[what].as_u64().unwrap() as usize;
    assert_eq!(count("kept") + eliminated.len(), count("parameters"));
    assert!(held_out(&few) < 1.02 * held_out(&all), "{} {}", held_out(&few), held_out(&all));
    assert!(said.contains("essential: ") && said.contains("eliminated"), "{said}");
    assert!(few.read("results/report.html").contains("Essential parameters"));
    // Predicting again from the model's file gives the same.
    let predict = ["predict", "--model", "results/rd_calibrated.json", "--data", "other_motion.csv"];
    few.aurt(predict.iter().chain(&["--out", "again.csv"])).succeeded();
    assert!(few.read("again.csv").lines().count() > 1000);
}

#[test]
fn what_holds_nothing_out_is_refused() {
    let folder = demo("essential");
    let text = folder.read("experiment.toml");
    let short = text.replace(
        "calibration = [\"exciting_motion.csv\"]",
        "calibration = [{ file = \"exciting_motion.csv\", window_s = [2.0, 12.5] }]",
    );
    assert_ne!(short, text);
    folder.write("experiment.toml", &short);
    folder.aurt(["run", "experiment.toml", "--out", "short"]).refused(&["essential", "blocks", "recordings"]);
}

/// A coarse encoder biases least squares, which says so, and says nothing where the encoder is fine.
#[test]
fn noise_of_the_positions_is_told() {
    let folder = Folder::new().with_whole_demo();
    let run = |out: &str| {
        let said = folder.aurt(["run", "experiment.toml", "--out", out]).succeeded().stdout();
        let bias = folder.json(&format!("{out}/metrics.json"))["position_bias"].clone();
        (said.split_whitespace().collect::<Vec<_>>().join(" "), bias)
    };
    let (said, _) = run("fine");
    assert!(
        said.contains("noise of the positions is at most") && !said.contains("position noise biases"),
        "{said}"
    );
    let rows: Vec<String> = folder
        .read("exciting_motion.csv")
        .lines()
        .enumerate()
        .map(|(k, line)| if k == 0 { line.to_owned() } else { coarse(line, 13) })
        .collect();
    folder.write("exciting_motion.csv", &(rows.join("\n") + "\n"));
    // What a user chooses who thinks of fast dynamics rather than of encoders.
    let text = folder.read("experiment.toml").replace("f_dyn_hz = 5.0", "f_dyn_hz = 8.0");
    folder.write("experiment.toml", &text);
    let (said, bias) = run("coarse");
    for words in
        ["position noise biases", "which suits the motion", "% of the power of the accelerations of joint"]
    {
        assert!(said.contains(words), "`{words}` is missing in {said}");
    }
    let step_rad = bias["joints"][1]["step_rad"].as_f64().unwrap();
    assert!((step_rad / (std::f64::consts::TAU / 8192.0) - 1.0).abs() < 1e-3, "{step_rad}");
    let worst =
        bias["parameters"].as_array().unwrap().iter().map(|p| p["deviations"].as_f64().unwrap().abs());
    assert!(worst.fold(0.0, f64::max) > 1.0, "{bias}");
}

/// The row as an encoder of so many bits shows it.
fn coarse(line: &str, bits: i32) -> String {
    let step = std::f64::consts::TAU / 2_f64.powi(bits);
    let cells: Vec<String> = line
        .split(',')
        .enumerate()
        .map(|(k, cell)| match (k, cell.parse::<f64>()) {
            (1..=6, Ok(q)) => format!("{:.9}", (q / step).round() * step),
            _ => cell.to_owned(),
        })
        .collect();
    cells.join(",")
}

/// Knocks of 5 A in one per cent of the rows spoil least squares and do not count with weights by row, by which a sweep
/// is done as well.
#[test]
fn impacts_have_no_weight_where_that_is_asked_for() {
    let [plain, robust] = ["wls", "irls"].map(|estimator| {
        let folder = demo(estimator);
        let text = folder.read("exciting_motion.csv");
        assert!(
            text.lines().next().unwrap().split(',').nth(7).unwrap().contains("current"),
            "{}",
            &text[..200]
        );
        let rows: Vec<String> = text
            .lines()
            .enumerate()
            .map(|(k, l)| if k > 0 && k % 700 < 7 { knocked(l) } else { l.to_owned() })
            .collect();
        folder.write("exciting_motion.csv", &(rows.join("\n") + "\n"));
        folder
    });
    plain.aurt(["run", "experiment.toml", "--out", "results"]).succeeded();
    let said = robust.aurt(["run", "experiment.toml", "--out", "results"]).succeeded().stdout();
    assert!(said.contains("weights by row: at most"), "{said}");
    assert!(plain.json("results/metrics.json")["robust"].is_null());
    let metrics = robust.json("results/metrics.json");
    assert_eq!(metrics["estimator"], "irls");
    let rejected = crate::support::numbers(&metrics["robust"]["rejected"]);
    assert!(rejected.len() == 6 && rejected.iter().all(|share| (0.003..0.2).contains(share)), "{rejected:?}");
    assert!(held_out(&robust) < 0.5 * held_out(&plain), "{} {}", held_out(&robust), held_out(&plain));

    let grid = "\n[sweep.grid]\n\"calibration.estimator\" = [\"wls\", \"irls\"]\n";
    let text = robust.read("experiment.toml");
    robust.write("sweep.toml", &format!("{}{grid}", text.split("[sweep").next().unwrap()));
    let said = robust.aurt(["sweep", "run", "sweep.toml", "--out", "swept"]).succeeded().stdout();
    assert!(said.contains("irls"), "{said}");
}

/// The row with 5 A more in each drive.
fn knocked(line: &str) -> String {
    let cells = line.split(',').enumerate().map(|(k, cell)| match (k, cell.parse::<f64>()) {
        (7..=12, Ok(current)) => format!("{:.5}", current + 5.0),
        _ => cell.to_owned(),
    });
    cells.collect::<Vec<_>>().join(",")
}
