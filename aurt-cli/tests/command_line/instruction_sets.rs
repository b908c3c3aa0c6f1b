//! Which instruction set and how many threads a run uses does not show in its results.

use aurt_traits::Dispatch;

use crate::support::{DEMO, Folder};

const RUN: [&str; 5] = ["run", "experiment.toml", "--out", "out", "--quiet"];

/// Names and values of the parameters that a run found, and the text of all its results.
fn results(level: &str, threads: &str) -> (Vec<(String, f64)>, Vec<String>) {
    let folder = Folder::new().with_whole_demo();
    folder.aurt_with([("AURT_SIMD", level), ("RAYON_NUM_THREADS", threads)], RUN).succeeded();
    let csv = folder.read("out/calibrated_parameters.csv");
    let values = csv.lines().skip(1).map(|line| {
        let mut cells = line.split(',');
        (cells.next().unwrap().to_owned(), cells.next().unwrap().parse().unwrap())
    });
    let others = ["out/rd_calibrated.json", "out/metrics.json", "out/predicted_other_motion.csv"];
    (values.collect(), [csv.clone()].into_iter().chain(others.map(|name| folder.read(name))).collect())
}

#[test]
fn threads_and_instruction_sets_do_not_show() {
    let (reference, texts) = results("baseline", "1");
    assert_eq!(results("baseline", "3").1, texts);
    for level in Dispatch::available() {
        let (values, texts) = results(level.name(), "1");
        assert_eq!(results(level.name(), "2").1, texts, "{level}");
        for ((name, value), (_, expected)) in values.iter().zip(&reference) {
            // The files give ten digits and more; small parameters are differences of large ones.
            assert!(
                (value - expected).abs() <= 1e-7 * expected.abs().max(1e-3),
                "{level}, {name}: {value} {expected}"
            );
        }
    }
}

#[test]
fn an_instruction_set_that_is_not_there_is_refused() {
    let said =
        DEMO.aurt_with([("AURT_SIMD", "sse9")], ["models"]).refused(&["`sse9` is not known", "baseline"]);
    assert!(said.contains("available here"), "{said}");
    DEMO.aurt_with([("AURT_SIMD", "")], ["models"]).succeeded();
}
