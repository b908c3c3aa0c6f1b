//! Registered friction models as candidates of a diagnosis.
//!
//! The simulator makes friction that is not in the vocabulary; a library in C, which shares nothing with it, has the
//! law. Without the library the case is unexplained, with it the model predicts the rest.

use std::path::PathBuf;

use serde_json::Value;

use crate::support::{Folder, numbers, text};

/// The library of laws that no effect has.
fn strange_friction(folder: &Folder) -> Option<PathBuf> {
    folder.library("strange_friction", "aurt-cli/tests/fixtures/strange_friction.c", &["-std=c99", "-O2"])
}

fn verdict(folder: &Folder, out: &str) -> Value {
    folder.json(&format!("{out}/verdict.json"))
}

/// Whether a verdict says that something is missing that no known effect explains.
fn leaves_something(verdict: &Value) -> bool {
    verdict["verdict"] == "unexplained" || verdict["verdict"] == "partly_explained"
}

#[test]
fn a_law_that_only_a_library_has_is_found_and_modelled() {
    let folder = Folder::new().with_concealed(
        "[recordings]\nduration_s = 10.0\nrate_hz = 125.0\n[unknown_effects]\nrobots = ['ur10e']\neffects = ['acceleration_friction', 'position_damper']\n\
         strengths = ['strong']\ntrials = 1\n",
        31,
    );
    let Some(library) = strange_friction(&folder) else { return };
    let library = text(&library);
    for case in ["case_0001", "case_0002"] {
        let hidden = &folder.json(&format!("sealed/{case}.json"))["effects"][0];
        let model = match hidden["effect"].as_str() {
            Some("acceleration_friction") => "swelling_seal",
            Some("position_damper") => "opening_damper",
            other => panic!("{other:?} was not asked for"),
        };
        let experiment = format!("cases/{case}/experiment.toml");
        let without = format!("{case}_without");
        assert_eq!(folder.run(format!("diagnose {experiment} --out {without} --verdict-only")).status(), 1);
        let unknown = verdict(&folder, &without);
        assert!(leaves_something(&unknown), "{case}: {hidden} {unknown}");
        assert_eq!(unknown.get("registered_models"), None);

        let run = folder.run(format!("--plugin {library} diagnose {experiment} --out {case}")).found();
        let found = verdict(&folder, case);
        assert!(leaves_something(&found), "no word of the vocabulary: {found}");
        let first = &found["registered_models"][0];
        assert_eq!(
            (&first["model"], &first["joints"]),
            (&model.into(), &hidden["joints"]),
            "{case}: {found}"
        );
        let sentence = first["sentence"].as_str().unwrap();
        assert!(
            sentence.contains(model) && run.stdout().contains(&format!("model `{model}` predicts")),
            "{}",
            run.stdout()
        );
        assert!(folder.read(&format!("{case}/report.html")).contains(model));

        let joint = hidden["joints"][0].as_u64().unwrap() as usize;
        let error = |verdict: &Value| numbers(&verdict["held_out"]["rms_after"])[joint];
        let before = numbers(&found["held_out"]["rms_before"])[joint];
        assert!(error(&found) < 0.5 * before && error(&found) < 0.8 * error(&unknown), "{case}: {found}");

        // The improved experiment names the library itself and needs no option.
        let improved = folder.read(&format!("{case}/improved.toml"));
        assert!(improved.contains(model) && improved.contains("[plugins]"), "{improved}");
        let again = format!("{case}_again");
        folder.aurt(["run", &format!("{case}/improved.toml"), "--out", &again, "--quiet"]).succeeded();
        assert_eq!(
            folder.json(&format!("{again}/rd_calibrated.json"))["calibration"]["parameters"],
            folder.json(&format!("{case}/rd_improved.json"))["calibration"]["parameters"]
        );
        // What is in the model is not missing any more.
        let rest = format!("{case}_rest");
        folder.aurt(["diagnose", &format!("{case}/improved.toml"), "--out", &rest, "--verdict-only"]);
        assert_eq!(verdict(&folder, &rest).get("registered_models"), None);

        let barred = format!("{case}_barred");
        let arguments = ["--plugin", &library, "diagnose", &experiment, "--out", &barred, "--verdict-only"];
        folder.aurt([&arguments[..], &["--without", model]].concat());
        let barred = verdict(&folder, &barred);
        let others = barred["registered_models"].as_array().into_iter().flatten();
        assert!(others.into_iter().all(|m| m["model"] != model), "{barred}");
    }
}

#[test]
fn a_library_changes_nothing_where_its_laws_are_not() {
    let folder = Folder::new().with_concealed(
        "[recordings]\nduration_s = 10.0\nrate_hz = 125.0\n[singles]\nrobots = ['ur10e']\neffects = ['presliding_hysteresis', 'viscous_nonlinear', 'rotor_inertia']\n\
         strengths = ['medium']\ntrials = 1\n[nulls]\nrobots = ['ur10e']\ncount = 2\n",
        32,
    );
    let Some(library) = strange_friction(&folder) else { return };
    let library = text(&library);
    for case in ["case_0001", "case_0002", "case_0003", "case_0004", "case_0005"] {
        let experiment = format!("cases/{case}/experiment.toml");
        let (plain, loaded) = (format!("{case}_plain"), format!("{case}_loaded"));
        folder.run(format!("diagnose {experiment} --out {plain} --verdict-only --quiet"));
        let arguments = ["--plugin", &library, "diagnose", &experiment, "--out", &loaded, "--verdict-only"];
        folder.aurt(arguments);
        let (plain, loaded) = (verdict(&folder, &plain), verdict(&folder, &loaded));
        assert_eq!(loaded.get("registered_models"), None, "{case}: {loaded}");
        assert_eq!(plain["verdict"], loaded["verdict"], "{case}");
        assert_eq!(plain["effects"][0]["effect"], loaded["effects"][0]["effect"], "{case}");
    }
}

#[test]
fn a_library_that_fails_is_a_note_and_not_the_end() {
    let folder = Folder::new().with_whole_demo();
    for (fault, reason) in [("PANICS", "it panicked"), ("NOT_FINITE", "is NaN at sample")] {
        let Some(library) = folder.faulty(fault) else { return };
        let library = text(&library);
        let arguments =
            ["--plugin", &library, "diagnose", "experiment.toml", "--out", fault, "--verdict-only"];
        let run = folder.aurt(arguments);
        assert_eq!(run.status(), 0, "{}", run.stderr());
        let notes = verdict(&folder, fault)["notes"].to_string();
        assert!(notes.contains("`faulty` could not be tried") && notes.contains(reason), "{notes}");
    }
}
