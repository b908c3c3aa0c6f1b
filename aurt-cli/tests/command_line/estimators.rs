//! Estimators beyond least squares, as an experiment asks for them.

use crate::support::{Folder, assert_has, numbers, one_line, with_cells};

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
    let errors = numbers(&other["mse"]);
    errors.iter().sum::<f64>() / errors.len() as f64
}

#[test]
fn the_essential_parameters_are_those_that_the_machine_has() {
    let (all, few) = (demo("wls"), demo("essential"));
    all.run("run experiment.toml --out results").succeeded();
    let said = few.run("run experiment.toml --out results").succeeded().stdout();
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
    folder.run("run experiment.toml --out short").refused(&["essential", "blocks", "recordings"]);
}

/// A coarse encoder biases least squares, which says so, and says nothing where the encoder is fine.
#[test]
fn noise_of_the_positions_is_told() {
    let folder = Folder::new().with_whole_demo();
    let run = |out: &str| {
        let said = folder.run(format!("run experiment.toml --out {out}")).succeeded().stdout();
        let bias = folder.json(&format!("{out}/metrics.json"))["position_bias"].clone();
        (one_line(&said), bias)
    };
    let (said, _) = run("fine");
    assert!(
        said.contains("noise of the positions is at most") && !said.contains("position noise biases"),
        "{said}"
    );
    let step = std::f64::consts::TAU / f64::from(1 << 13);
    let coarse = |q: &str| format!("{:.9}", (q.parse::<f64>().unwrap() / step).round() * step);
    folder.edit("exciting_motion.csv", |text| {
        with_cells(text, |_, column, cell| (1..=6).contains(&column).then(|| coarse(cell)))
    });
    // What a user chooses who thinks of fast dynamics rather than of encoders.
    folder.edit("experiment.toml", |text| text.replace("f_dyn_hz = 5.0", "f_dyn_hz = 8.0"));
    let (said, bias) = run("coarse");
    let suits = ["which suits the motion", "% of the power of the accelerations of joint"];
    assert_has(&said, &[&["position noise biases"][..], &suits].concat());
    let step_rad = bias["joints"][1]["step_rad"].as_f64().unwrap();
    assert!((step_rad / (std::f64::consts::TAU / 8192.0) - 1.0).abs() < 1e-3, "{step_rad}");
    let worst =
        bias["parameters"].as_array().unwrap().iter().map(|p| p["deviations"].as_f64().unwrap().abs());
    assert!(worst.fold(0.0, f64::max) > 1.0, "{bias}");
}

/// Knocks of 5 A in one per cent of the rows spoil least squares and do not count with weights by row, by which a sweep
/// is done as well.
#[test]
fn impacts_have_no_weight_where_that_is_asked_for() {
    let [plain, robust] = ["wls", "irls"].map(|estimator| {
        let folder = demo(estimator);
        let knocked = |current: &str| format!("{:.5}", current.parse::<f64>().unwrap() + 5.0);
        folder.edit("exciting_motion.csv", |text| {
            let is_knocked = |row: usize, column: usize| (row + 1) % 700 < 7 && (7..=12).contains(&column);
            with_cells(text, |row, column, cell| is_knocked(row, column).then(|| knocked(cell)))
        });
        folder
    });
    plain.run("run experiment.toml --out results").succeeded();
    let said = robust.run("run experiment.toml --out results").succeeded().stdout();
    assert!(said.contains("weights by row: at most"), "{said}");
    assert!(plain.json("results/metrics.json")["robust"].is_null());
    let metrics = robust.json("results/metrics.json");
    assert_eq!(metrics["estimator"], "irls");
    let rejected = numbers(&metrics["robust"]["rejected"]);
    assert!(rejected.len() == 6 && rejected.iter().all(|share| (0.003..0.2).contains(share)), "{rejected:?}");
    assert!(held_out(&robust) < 0.5 * held_out(&plain), "{} {}", held_out(&robust), held_out(&plain));

    let grid = "\n[sweep.grid]\n\"calibration.estimator\" = [\"wls\", \"irls\"]\n";
    let text = robust.read("experiment.toml");
    robust.write("sweep.toml", &format!("{}{grid}", text.split("[sweep").next().unwrap()));
    let said = robust.run("sweep run sweep.toml --out swept").succeeded().stdout();
    assert!(said.contains("irls"), "{said}");
}
