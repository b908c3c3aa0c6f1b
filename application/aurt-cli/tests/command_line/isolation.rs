//! Libraries in processes of their own: whatever they do wrong is an error of their model alone.

use crate::support::{Folder, text};

const EXPERIMENT: &str = r#"
schema = 1
[plugins]
libraries = ["LIBRARY"]
isolate = ISOLATE
[robot]
mdh = "mdh.csv"
gravity_m_s2 = [0.0, 0.0, -9.81]
torque_constants_nm_per_a = [11.976, 11.976, 9.839, 10.763, 10.763, 10.763]
[joint_dynamics]
coulomb = { model = "none" }
hysteresis = { model = "MODEL" }
viscous = { model = "polynomial", powers = [1] }
[recordings]
calibration = ["exciting_motion.csv"]
validation = ["other_motion.csv"]
[preprocess]
f_dyn_hz = 5.0
"#;
const SWEEP: &str = "[sweep.grid]\n\"joint_dynamics.hysteresis.model\" = [\"sign\", \"faulty\", \"tanh\"]\n";
const FIXTURE: &str = "aurt-plugins/tests/fixtures/faulty.c";

fn demo() -> Folder {
    Folder::new().with_demo(&["mdh.csv", "exciting_motion.csv", "other_motion.csv"])
}

fn experiment(library: &str, isolate: bool, model: &str) -> String {
    let text = EXPERIMENT.replace("LIBRARY", library).replace("MODEL", model);
    text.replace("ISOLATE", &isolate.to_string())
}

#[test]
fn what_a_library_does_wrong_fails_its_point_alone_and_names_the_library() {
    let folder = demo();
    for (fault, reason) in [
        ("CRASHES", "crashed (signal 11"),
        ("CRASHES_LATE", "crashed (signal 11"),
        ("LOOPS", "has not returned for 1.0 s and was ended"),
        ("EATS_MEMORY", "crashed (signal 11; it may ask for 1500 MiB of memory)"),
        ("WRITES_FAR", "crashed (signal 11"),
        ("EXITS", "ended itself with exit status 0"),
        ("OVERRUN", "writes 1 values too many into column 0"),
        ("OVERRUNS_LATE", "writes 1 values too many into column 0"),
        ("STATE_OVERRUN", "writes beyond its state"),
        ("BEYOND_BOUND", "declares that it is bounded by one in magnitude"),
        ("PANICS", "it panicked: index out of bounds"),
    ] {
        let Some(library) = folder.library(fault, FIXTURE, &[&format!("-D{fault}")]) else { return };
        folder.write("experiment.toml", &format!("{}{SWEEP}", experiment(&text(&library), true, "sign")));
        let seconds = if fault == "LOOPS" { "1" } else { "60" };
        let limits = [("AURT_LIBRARY_TIME_LIMIT_S", seconds), ("AURT_LIBRARY_MEMORY_LIMIT_MIB", "1500")];
        let run = folder.aurt_with(limits, ["sweep", "run", "experiment.toml", "--out", fault]);
        assert_eq!(run.status(), 1, "{fault}: {}", run.stderr());
        let table = folder.json(&format!("{fault}/table.json"));
        assert_eq!(table["ranked"].as_array().unwrap().len(), 2, "{fault}");
        let error = table["failed"][0]["error"].as_str().unwrap();
        assert!(error.contains("model `faulty` failed") && error.contains(reason), "{fault}: {error}");
    }
}

#[test]
fn a_right_library_gives_the_same_bytes_in_a_process_of_its_own() {
    let folder = demo();
    // What it prints reaches neither its socket nor the document on standard output.
    let Some(library) = folder.library("right", FIXTURE, &["-DPRINTS"]) else { return };
    for isolate in [false, true] {
        folder.write("experiment.toml", &experiment(&text(&library), isolate, "faulty"));
        let out = format!("isolated_{isolate}");
        let run = folder.aurt(["--json", "run", "experiment.toml", "--out", &out]).succeeded();
        if isolate {
            serde_json::from_str::<serde_json::Value>(&run.stdout()).unwrap();
            assert!(run.stderr().contains("a library that prints"), "{}", run.stderr());
        }
    }
    for name in ["rd_calibrated.json", "calibrated_parameters.csv"] {
        // The two experiments have hashes of their own.
        let of = |isolate: bool| -> String {
            let text = folder.read(&format!("isolated_{isolate}/{name}"));
            text.lines().filter(|l| !l.contains("\"experiment_blake3\"")).map(|l| format!("{l}\n")).collect()
        };
        assert_eq!(of(false), of(true), "{name}");
    }
}

#[test]
fn a_diagnosis_goes_on_without_a_library_that_crashes() {
    let folder = demo();
    let plain = experiment("", false, "sign").replace("libraries = [\"\"]\nisolate = false\n", "");
    folder.write("experiment.toml", &plain);
    let Some(library) = folder.library("crashes", FIXTURE, &["-DCRASHES"]) else { return };
    let diagnose = |plugin: &[&str], out: &str| {
        let command = ["diagnose", "experiment.toml", "--verdict-only", "--out", out];
        let run = folder.aurt(plugin.iter().copied().chain(command));
        assert!(run.status() < 2, "{}", run.stderr());
        (run.status(), folder.json(&format!("{out}/verdict.json")))
    };
    let (status, alone) = diagnose(&[], "alone");
    let (beside, with) = diagnose(&["--plugin", &text(&library)], "with");
    assert_eq!(status, beside);
    assert_eq!(alone["findings"], with["findings"]);
    let said = with.to_string();
    let reason = "the registered hysteresis model `faulty` could not be tried: model `faulty` failed: the process of its \
                  library";
    assert!(said.contains(reason) && said.contains("crashed (signal 11"), "{said}");
}

#[test]
fn libraries_that_cannot_be_loaded_are_refused_by_name() {
    let folder = demo();
    let refused = |library: &str, isolate: bool, words: &[&str]| {
        folder.write("experiment.toml", &experiment(library, isolate, "sign"));
        folder.aurt(["run", "experiment.toml", "--out", "out"]).refused(words);
        assert!(!folder.path("out").exists());
    };
    folder.write("none.so", "no library");
    refused("none.so", true, &["none.so", "is not a library that this system can load"]);
    refused("nowhere.so", true, &["nowhere.so", "does not exist"]);
    let Some(loading) = folder.library("loading", FIXTURE, &["-DCRASHES_LOADING"]) else { return };
    refused(&text(&loading), true, &["loading", "crashed (signal 11", "while it was being loaded"]);
    let Some(version) = folder.library("version", FIXTURE, &["-DOTHER_MAJOR"]) else { return };
    refused(&text(&version), true, &["was built for version 2.0"]);
    // Without a process of its own a library that ends the command is told too.
    let Some(exits) = folder.library("exits", FIXTURE, &["-DEXITS"]) else { return };
    folder.write("experiment.toml", &experiment(&text(&exits), false, "faulty"));
    let said = folder.aurt(["run", "experiment.toml", "--out", "out"]);
    assert_eq!(said.status(), 2);
    assert!(said.stderr().contains("ended the command with exit status 0"), "{}", said.stderr());
}

#[test]
fn a_process_of_a_library_serves_nobody_but_its_host() {
    let folder = Folder::new();
    let said = folder.aurt_fed("no socket".to_owned(), ["serve-library", "any.so"]);
    assert_eq!(said.status(), 2);
    assert!(said.stderr().contains("serves libraries to other processes alone"), "{}", said.stderr());
}
