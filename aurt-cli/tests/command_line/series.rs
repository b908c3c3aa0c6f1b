//! Predictions and residuals as Parquet and MCAP, read again by the program itself.

use crate::support::{Folder, column, first_columns, numbers, with_table, without_constants};

/// The columns of a quantity, as an experiment lists them.
fn names(quantity: &str) -> String {
    let list: Vec<String> = (0..6).map(|j| format!("\"{quantity}_{j}\"")).collect();
    format!("[{}]", list.join(", "))
}

#[test]
fn a_model_is_as_good_on_what_it_predicted() {
    let folder = Folder::new().with_whole_demo();
    folder.run("run experiment.toml --out results --series parquet").succeeded();
    folder.run("run experiment.toml --out bags --series mcap").succeeded();
    let model = "results/rd_calibrated.json";
    let columns = format!(
        "columns = {{ time = \"timestamp\", position = {}, measurement = {} }}, unit = \"Nm\"",
        names("q"),
        names("predicted_torque")
    );
    for (ending, options) in [("parquet", columns.as_str()), ("mcap", "topic = \"/predicted\"")] {
        // `predict` by the ending of its output, and `run` with `--series`, write the same series.
        let out = format!("predicted.{ending}");
        folder.run(format!("predict --model {model} --data other_motion.csv --out {out}")).succeeded();
        let of_run = match ending {
            "parquet" => "results/series_other_motion.parquet",
            _ => "bags/series_other_motion.mcap",
        };
        for file in [out.as_str(), of_run] {
            // A prediction is a torque already.
            let experiment = without_constants(&folder.read("experiment.toml"));
            let recordings = format!("[recordings]\ncalibration = [{{ file = \"{file}\", {options} }}]\n\n");
            folder.write("again.toml", &with_table(&experiment, "[recordings]", &recordings));
            folder.run("run again.toml --out again").succeeded();
            let metrics = folder.json("again/metrics.json");
            let errors = numbers(&metrics["recordings"][0]["nmse"]);
            assert!(errors.iter().all(|e| *e < 1e-3), "{file}: {errors:?}");
        }
    }
    let text = folder.read("results/predicted_other_motion.csv");
    assert!(column(&text, "predicted_torque_0").len() > 1000);
}

#[test]
fn series_without_measurement_and_in_stretches() {
    let folder = Folder::new().with_whole_demo();
    folder.run("run experiment.toml --out results").succeeded();
    folder.write("motion.csv", &first_columns(&folder.read("other_motion.csv"), 7));
    let predict = ["predict", "--model", "results/rd_calibrated.json", "--data", "motion.csv", "--out"];
    folder.aurt(predict.iter().chain(&["motion.mcap"])).succeeded();
    let bytes = std::fs::read(folder.path("motion.mcap")).unwrap();
    let has = |topic: &str| bytes.windows(topic.len()).any(|w| w == topic.as_bytes());
    assert!(has("/predicted") && !has("/measured") && !has("/residual"));
    folder.run("run experiment.toml --out long --series mcap --stream-above 1kB").refused(&[
        "--series",
        "in stretches",
        "--stream-above",
    ]);
    folder.run("run experiment.toml --out x --series csv").refused(&["parquet", "mcap"]);
}

/// What a diagnosis saw is a recording again; what it predicted has no values where rows do not count.
#[test]
fn a_diagnosis_writes_what_it_saw() {
    let folder = Folder::new().with_whole_demo().with_demo(&[
        "later.toml",
        "later_motion.csv",
        "later_other_motion.csv",
    ]);
    // Rows in which a joint rests have no prediction; between them all move.
    let moving = "{ file = \"later_motion.csv\", window_s = [1.0, 15.0] }";
    let experiment = folder.read("later.toml").replace("\"later_motion.csv\"", moving);
    folder.write("moving.toml", &experiment);
    for (format, out) in [("parquet", "table"), ("mcap", "bag")] {
        let run = ["diagnose", "moving.toml", "--out", out, "--verdict-only", "--series", format, "--quiet"];
        assert_eq!(folder.aurt(run).status(), 1);
    }
    let bag = std::fs::read(folder.path("bag/series_later_motion.mcap")).unwrap();
    for topic in
        ["/measured", "/predicted_before", "/predicted_after", "/residual_after", "/located", "/stands_out"]
    {
        assert!(bag.windows(topic.len()).any(|w| w == topic.as_bytes()), "{topic}");
    }
    // Rows of a diagnosis are as dense as its filter leaves anything to be seen: a lower one sees them.
    let experiment = folder.read("experiment.toml").replace("f_dyn_hz = 5.0", "f_dyn_hz = 2.0");
    let experiment = without_constants(&experiment);
    let run = |series: &str| {
        let columns =
            format!("{{ time = \"timestamp\", position = {}, measurement = {} }}", names("q"), names(series));
        let file = "table/series_later_motion.parquet";
        let recordings = format!(
            "[recordings]\ndrop = \"nan\"\ncalibration = [{{ file = \"{file}\", columns = {columns}, unit = \"Nm\" }}]\n"
        );
        folder.write("again.toml", &with_table(&experiment, "[recordings]", &recordings));
        folder.run(format!("run again.toml --out {series}"))
    };
    run("measured_torque").succeeded();
    // Rows at the ends of a recording do not count, and are no rows of the series; rows at reversals do not, and have no
    // prediction.
    run("predicted_after_torque").succeeded();
}
