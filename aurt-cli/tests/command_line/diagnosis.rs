//! `aurt diagnose` on physics that was concealed, and on real recordings.

use serde_json::{Value, json};

use crate::support::{Folder, assert_has, column, numbers, real_recordings, with_cells, with_table};

/// The verdict on a case, and whether the exit status fits it.
#[track_caller]
fn verdict(folder: &Folder, case: &str, more: &[&str]) -> Value {
    let experiment = format!("cases/{case}/experiment.toml");
    let mut arguments = vec!["diagnose", &experiment, "--out", case, "--quiet"];
    arguments.extend(more);
    let run = folder.aurt(arguments);
    let verdict = folder.json(&format!("{case}/verdict.json"));
    let is_nothing = |word: &Value| word.is_null() || word == "no_mismatch";
    let findings = !(is_nothing(&verdict["verdict"]) && is_nothing(&verdict["structure"]));
    assert_eq!(run.status(), i32::from(findings), "{}", run.stderr());
    verdict
}

fn truth(folder: &Folder, case: &str) -> Value {
    folder.json(&format!("sealed/{case}.json"))
}

/// Effects that the simulator makes from states of a machine and the diagnosis finds as columns of a regressor:
/// each is named first, on its joints. Without its candidate the case is unexplained or another's, and is not
/// named so.
#[test]
fn concealed_effects_are_named_and_are_not_named_without_their_candidates() {
    let plan = "[recordings]\nduration_s = 10.0\n[singles]\nrobots = ['ur10e']\n\
                effects = ['rotor_inertia', 'joint_coupling_friction', 'viscous_asymmetry']\n\
                strengths = ['medium']\ntrials = 1\n";
    let folder = Folder::new().with_concealed(plan, 2024);
    for case in ["case_0001", "case_0002", "case_0003"] {
        let hidden = &truth(&folder, case)["effects"][0];
        let found = verdict(&folder, case, &[]);
        assert_eq!(found["verdict"], "named", "{case}: {hidden} {found}");
        assert_eq!(found["effects"][0]["effect"], hidden["effect"], "{case}");
        assert_eq!(found["effects"][0]["joints"], hidden["joints"], "{case}");
        let (before, after) =
            (numbers(&found["held_out"]["rms_before"]), numbers(&found["held_out"]["rms_after"]));
        let halved = |j: &Value| j.as_u64().is_some_and(|j| after[j as usize] < 0.5 * before[j as usize]);
        assert!(hidden["joints"].as_array().unwrap().iter().any(halved), "{case}: {before:?} {after:?}");

        let name = hidden["effect"].as_str().unwrap();
        let without = verdict(&folder, case, &["--without", name]);
        let effects = without["effects"].as_array().unwrap();
        assert!(effects.iter().all(|e| e["effect"] != hidden["effect"]), "{case}: {without}");
        assert_ne!(without["verdict"], "no_mismatch", "{case}");
        if name == "rotor_inertia" {
            // Its torque is also that of a motor that turns with two joints; but that one's friction is not there.
            assert!(effects.iter().all(|e| e["effect"] != "joint_coupling_friction"), "{case}: {without}");
            let left = ["unexplained", "partly_explained"].contains(&without["verdict"].as_str().unwrap());
            assert!(left, "{case}: {without}");
        }
    }
}

/// The simulator's Stribeck friction falls by 1/(1 + |q̇/v|^δ): a fit of exponentials alone finds half its fall a fifth too slow, and half
/// the exponent.
#[test]
fn the_law_of_stribeck_friction_is_that_of_the_robot() {
    let plan = "[recordings]\nduration_s = 10.0\n[singles]\nrobots = ['ur10e']\neffects = ['stribeck']\n\
                strengths = ['strong']\ntrials = 1\n";
    let folder = Folder::new().with_concealed(plan, 4);
    let hidden = &truth(&folder, "case_0001")["effects"][0];
    let found = verdict(&folder, "case_0001", &[]);
    assert_eq!(found["verdict"], "named", "{hidden} {found}");
    let effect = &found["effects"][0];
    assert_eq!([&effect["effect"], &effect["joints"]], [&hidden["effect"], &hidden["joints"]]);
    let speed = effect["parameters"]["half_speed_rad_s"]["value"].as_f64().unwrap();
    let simulated = hidden["fields"]["stribeck_velocity_rad_s"].as_f64().unwrap();
    assert!((speed / simulated - 1.0).abs() < 0.1, "{speed}, is {simulated}");
    assert!(folder.read("case_0001/improved.toml").contains("law = \"rational\""));
}

/// Dry friction on a joint that turns often, beside a load: both are missing while the noise is estimated, and neither is
/// noise.
#[test]
fn friction_beside_a_load_is_no_noise() {
    const MORE_NM: f64 = 4.0;
    const NM_PER_A: f64 = 9.839;
    let changed_files = ["later_motion.csv", "later_other_motion.csv"];
    let folder =
        Folder::new().with_demo(&["mdh.csv", "later.toml", "exciting_motion.csv"]).with_demo(&changed_files);
    for name in changed_files {
        let q_rad = column(&folder.read(name), "actual_q_2");
        let more = |k: usize, current: &str| {
            let ahead = q_rad[(k + 10).min(q_rad.len() - 1)];
            let sign = (ahead - q_rad[k.saturating_sub(10)]).signum();
            (current.parse::<f64>().unwrap() + MORE_NM / NM_PER_A * sign).to_string()
        };
        // Positions stand after the stamp, currents after these.
        folder
            .edit(name, |text| with_cells(text, |k, column, cell| (column == 7 + 2).then(|| more(k, cell))));
    }
    // Noise grows with the band; the levels below are those of this one.
    folder.edit("later.toml", |text| format!("{text}\n[diagnosis]\nf_dyn_hz = 5.0\n"));
    folder.run("diagnose later.toml --out out --quiet").found();
    let verdict = folder.json("out/verdict.json");
    let effects = verdict["effects"].as_array().unwrap();
    assert_eq!(effects[0]["effect"], "payload", "{verdict}");
    let on_it = |e: &&Value| e["joints"] == serde_json::json!([2]) && e["present_in"] == json!(["target"]);
    assert!(effects.iter().any(|e| on_it(&e)), "{verdict}");
    let joint = &verdict["residual"][2];
    let [floor, left, was] =
        ["floor_rms", "unexplained_rms", "baseline_rms"].map(|k| joint[k].as_f64().unwrap());
    assert!(floor < 0.7 && left < 0.7 && was > 10.0 * left, "{joint}");
}

/// Physics that no candidate describes is not given a name, and nothing is nothing.
#[test]
fn unknown_effects_stay_unexplained_and_nulls_are_null() {
    let plan = "[recordings]\nduration_s = 10.0\n[unknown_effects]\nrobots = ['ur10e']\neffects = ['cross_drag']\nstrengths = ['medium']\ntrials = 1\n\
                [nulls]\nrobots = ['ur10e']\ncount = 1\n";
    let folder = Folder::new().with_concealed(plan, 2025);
    for case in ["case_0001", "case_0002"] {
        let null = truth(&folder, case)["effects"].as_array().unwrap().is_empty();
        let expected = if null { "no_mismatch" } else { "unexplained" };
        let found = verdict(&folder, case, &[]);
        assert_eq!(found["verdict"], expected, "{case}: {found}");
        // The answer is about the robot, not about the band that somebody asks for.
        let text = folder.read(&format!("cases/{case}/experiment.toml"));
        for f_dyn_hz in ["2.5", "20.0"] {
            let other = format!("{text}\n[diagnosis]\nf_dyn_hz = {f_dyn_hz}\n");
            folder.write(&format!("cases/{case}/experiment.toml"), &other);
            std::fs::remove_dir_all(folder.path(case)).unwrap();
            let found = verdict(&folder, case, &["--series", "mcap"]);
            assert_eq!(found["verdict"], expected, "{case} at {f_dyn_hz} Hz: {found}");
            // Another cut-off of the position filter leaves other rows at the ends.
            let bag = std::fs::read(folder.path(&format!("{case}/series_recording_1.mcap"))).unwrap();
            assert!(bag.windows(9).any(|name| name == b"/measured"), "{case} at {f_dyn_hz} Hz");
        }
    }
}

/// However far off it is: a term that is linear in the angle leaves what a load is then claimed for.
#[test]
fn an_encoder_that_has_lost_its_zero_is_found_with_its_offset() {
    const OFFSET_RAD: f64 = 0.3;
    let folder = Folder::new().with_whole_demo();
    for name in ["other_motion.csv", "point_to_point.csv"] {
        let shifted = |cell: &str| format!("{:.9}", cell.parse::<f64>().unwrap() + OFFSET_RAD);
        // The stamp, then joint after joint.
        folder.edit(name, |text| with_cells(text, |_, column, cell| (column == 3).then(|| shifted(cell))));
    }
    let listed = "validation = [\"other_motion.csv\", \"point_to_point.csv\"]";
    let toml = folder.read("experiment.toml");
    assert!(toml.contains(listed));
    let asked = "target = [\"other_motion.csv\"]\nvalidation = [\"point_to_point.csv\"]";
    folder.write("shifted.toml", &toml.replace(listed, asked));
    assert_eq!(folder.run("diagnose shifted.toml --out out").status(), 1);
    let verdict = folder.json("out/verdict.json");
    let changes: Vec<&Value> = verdict["effects"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|e| e["present_in"] == json!(["target"]))
        .collect();
    assert_eq!(changes.len(), 1, "{verdict}");
    assert_eq!([&changes[0]["effect"], &changes[0]["joints"]], [&json!("encoder_offset"), &json!([2])]);
    let offset = &changes[0]["parameters"]["offset_rad"];
    let [value, std] = ["value", "std"].map(|key| offset[key].as_f64().unwrap());
    assert!((value - OFFSET_RAD).abs() < 3.0 * std && std < 0.003, "{offset}");
    assert!(folder.read("out/improved.toml").contains("around_rad"));
    // Beside a given model the law is as exact.
    folder.write("reference.toml", &toml.replace(listed, ""));
    folder.run("run reference.toml --out reference").succeeded();
    let later = toml.replace("\"exciting_motion.csv\"", "\"other_motion.csv\"");
    folder.write("given.toml", &later.replace(listed, "validation = [\"point_to_point.csv\"]"));
    folder.run("diagnose given.toml --model reference/rd_calibrated.json --out given");
    let verdict = folder.json("given/verdict.json");
    assert_eq!(verdict["effects"].as_array().map(Vec::len), Some(1), "{verdict}");
    let offset = &verdict["effects"][0]["parameters"]["offset_rad"];
    let [value, std] = ["value", "std"].map(|key| offset[key].as_f64().unwrap());
    assert!((value - OFFSET_RAD).abs() < 3.0 * std && std < 0.005, "{verdict}");
}

/// A load that the held-out recording alone shows: the fitted recordings lack nothing, and no part of the answer says so of all.
#[test]
fn a_load_in_the_held_out_recording_is_no_all_clear() {
    let folder = Folder::new().with_whole_demo().with_demo(&["later_motion.csv"]);
    let listed = "validation = [\"other_motion.csv\", \"point_to_point.csv\"]";
    let toml = folder.read("experiment.toml");
    assert!(toml.contains(listed));
    for (out, recordings) in [
        ("alone", "validation = [\"later_motion.csv\"]"),
        ("beside", "target = [\"other_motion.csv\"]\nvalidation = [\"later_motion.csv\"]"),
    ] {
        folder.write("loaded.toml", &toml.replace(listed, recordings));
        let run = folder.run(format!("diagnose loaded.toml --out {out}"));
        let verdict = folder.json(&format!("{out}/verdict.json"));
        assert_eq!(run.status(), 1, "{verdict}");
        assert_eq!(verdict["verdict"], "held_out_differs", "{verdict}");
        let differing = verdict["held_out_differs"].as_array().unwrap();
        assert!(!differing.is_empty());
        for joint in differing {
            assert!(
                joint["rms"].as_f64().unwrap() > 1.65 * joint["expected_rms"].as_f64().unwrap(),
                "{joint}"
            );
        }
        let said = run.stdout();
        assert!(
            said.contains("differ from the fitted ones on") && !said.contains("the residual is noise"),
            "{said}"
        );
    }
}

/// The demo's structure is complete; with two of its terms left out these are found, and the improved
/// experiment runs as it is.
#[test]
fn the_improved_experiment_has_what_was_left_out() {
    let folder = Folder::new().with_whole_demo();
    let whole = folder.read("experiment.toml");
    let complete = folder.run("diagnose experiment.toml --out complete --quiet");
    assert_eq!(complete.status(), 0, "{}", complete.stderr());
    assert_eq!(folder.json("complete/verdict.json")["verdict"], "no_mismatch");

    folder.write("lacking.toml", &with_table(&whole, "[[arm_terms]]", ""));
    assert_eq!(folder.run("diagnose lacking.toml --out lacking").status(), 1);
    let verdict = folder.json("lacking/verdict.json");
    assert_eq!(verdict["effects"][0]["effect"], "rotor_inertia", "{verdict}");
    assert_eq!(verdict["effects"][0]["joints"], serde_json::json!([2, 3, 4, 5]));
    // The band is that of the motion: the experiment's f_dyn, of the calibration, changes nothing.
    assert!(whole.contains("f_dyn_hz = 5.0"));
    folder.edit("lacking.toml", |text| text.replace("f_dyn_hz = 5.0", "f_dyn_hz = 2.0"));
    folder.run("diagnose lacking.toml --out slower --verdict-only");
    assert_eq!(folder.json("slower/verdict.json"), verdict);
    folder.edit("lacking.toml", |text| format!("{text}\n[diagnosis]\nf_dyn_hz = 4.5\n"));
    folder.run("diagnose lacking.toml --out asked --verdict-only");
    assert_eq!(folder.json("asked/verdict.json")["settings"]["f_dyn_hz"], 4.5);
    folder.run("run lacking/improved.toml --out again --quiet").succeeded();
    let again = folder.json("again/rd_calibrated.json");
    assert_eq!(
        again["calibration"]["parameters"],
        folder.json("lacking/rd_improved.json")["calibration"]["parameters"]
    );
}

/// The demo's experiment without its arm terms, with another recording of the same robot as target.
fn unchanged_target() -> Folder {
    let folder = Folder::new().with_whole_demo();
    let without_terms = with_table(&folder.read("experiment.toml"), "[[arm_terms]]", "");
    let asked = "[recordings]\ncalibration = [\"exciting_motion.csv\"]\ntarget = [\"other_motion.csv\"]\n\
                 validation = [{ file = \"point_to_point.csv\", window_s = [1.0, 60.0] }]\n";
    folder.write("asked.toml", &with_table(&without_terms, "[recordings]", asked));
    folder
}

/// What a structure lacks in all recordings is no change, and every place that gives the answer says so.
#[test]
fn a_target_in_which_nothing_changed_is_said_to_be_unchanged() {
    let folder = unchanged_target();
    let run = folder.run("diagnose asked.toml --out out").found();
    let verdict = folder.json("out/verdict.json");
    let everywhere = serde_json::json!(["calibration", "target"]);
    let effects = verdict["effects"].as_array().unwrap();
    assert!(!effects.is_empty() && effects.iter().all(|e| e["present_in"] == everywhere), "{verdict}");
    let said = run.stdout();
    let first = said.lines().next().unwrap();
    assert!(first.starts_with("nothing has changed; in all recordings the model lacks "), "{said}");
    assert!(said.contains("\nchanged in the target: nothing\nmissing in all recordings:\n  1. "), "{said}");
    let in_window = said.lines().any(|l| l.contains("held out: point_to_point.csv from 1 to 60 s"));
    assert!(in_window, "{said}");
    assert!(said.lines().take_while(|l| !l.starts_with("added")).all(|l| l.chars().count() <= 80), "{said}");
    let words = ["Nothing has changed; in all recordings the model lacks", "Changed in the target: nothing."];
    assert_has(&folder.read("out/report.html"), &[&words[..], &["Missing in all recordings:"]].concat());
}

/// The improved experiment names its files from where it lies, so that a project can be moved as a whole.
#[test]
fn the_improved_experiment_is_read_from_anywhere_and_moves_with_its_recordings() {
    let folder = unchanged_target();
    assert_eq!(folder.run("diagnose asked.toml --out out --quiet").status(), 1);
    let improved = folder.read("out/improved.toml");
    assert_has(&improved, &["\"../mdh.csv\"", "\"../exciting_motion.csv\"", "\"../other_motion.csv\""]);
    assert!(!improved.contains(folder.path("").to_str().unwrap()), "{improved}");

    let elsewhere = Folder::new();
    let path = folder.path("out/improved.toml");
    elsewhere.aurt(["run", path.to_str().unwrap(), "--out", "again", "--quiet"]).succeeded();
    assert_eq!(
        elsewhere.json("again/rd_calibrated.json")["calibration"]["parameters"],
        folder.json("out/rd_improved.json")["calibration"]["parameters"]
    );
    let moved = folder.path("project");
    std::fs::create_dir_all(moved.join("answer")).unwrap();
    for file in ["mdh.csv", "exciting_motion.csv", "other_motion.csv", "point_to_point.csv"] {
        std::fs::rename(folder.path(file), moved.join(file)).unwrap();
    }
    std::fs::rename(path, moved.join("answer/improved.toml")).unwrap();
    folder.run("run project/answer/improved.toml --out later --quiet").succeeded();
}

/// The example of a UR10e's structure with another calibration recording and a target.
fn ur10e(calibration: &str, target: &str) -> String {
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/diagnose_ur10e_structure.toml");
    let asked = |line: &str| match line.split_whitespace().next() {
        Some("calibration") => format!("calibration = [\"${{AURT_DATA}}/ur10e/{calibration}.csv\"]"),
        Some("validation") => format!("target = [\"${{AURT_DATA}}/ur10e/{target}.csv\"]"),
        _ => line.to_owned(),
    };
    std::fs::read_to_string(example).unwrap().lines().map(asked).collect::<Vec<_>>().join("\n")
}

/// The folder of a diagnosis of an example, and its output.
fn example(name: &str) -> (Folder, String) {
    let experiment = format!(concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/diagnose_{}.toml"), name);
    let folder = Folder::new();
    let said = folder.run(format!("diagnose {experiment} --out out")).stdout();
    (folder, said)
}

#[test]
fn a_load_on_a_ur10e_is_weighed() {
    let Some(_) = real_recordings("a_load_on_a_ur10e_is_weighed") else { return };
    let (folder, said) = example("ur10e_payload");
    let verdict = folder.json("out/verdict.json");
    let first = &verdict["effects"][0];
    assert_eq!((&first["effect"], &first["present_in"]), (&"payload".into(), &json!(["target"])));
    for page in ["README.md", "docs/tutorial-why.md"] {
        let text =
            std::fs::read_to_string(format!(concat!(env!("CARGO_MANIFEST_DIR"), "/../{}"), page)).unwrap();
        let quote =
            text.split("```text\n").find(|block| block.starts_with("changed since calibration")).unwrap();
        for line in quote.split("```").next().unwrap().lines().filter(|line| *line != "…") {
            assert!(
                said.lines().any(|own| own == line),
                "{page} quotes `{line}`, which is not said:\n{said}"
            );
        }
    }
    let mass = first["parameters"]["mass_kg"]["value"].as_f64().unwrap();
    assert!((mass / 2.805 - 1.0).abs() < 0.03, "{mass} kg of 2.805");
    let (before, after) =
        (numbers(&verdict["held_out"]["rms_before"]), numbers(&verdict["held_out"]["rms_after"]));
    for joint in 1..6 {
        assert!((after[joint] / before[joint]).powi(2) < 0.05, "joint {joint}: {before:?} {after:?}");
    }
}

/// The tutorial's load of the same recordings without torque constants.
#[test]
fn a_load_on_a_ur10e_is_found_in_currents() {
    let Some(_) = real_recordings("a_load_on_a_ur10e_is_found_in_currents") else { return };
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/diagnose_ur10e_payload.toml");
    let stated = std::fs::read_to_string(example).unwrap();
    let lines = stated.lines().filter(|line| !line.starts_with("torque_constants"));
    let folder = Folder::new();
    folder.write("asked.toml", &lines.collect::<Vec<_>>().join("\n"));
    let run = folder.run("diagnose asked.toml --out out --verdict-only");
    let page =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/tutorial-why.md")).unwrap();
    let (_, told) = page.split_once("here the load is ").unwrap();
    let (load, _) = told.split_once(',').unwrap();
    assert!(run.stdout().contains(load), "{load}:\n{}", run.stdout());
    let verdict = folder.json("out/verdict.json");
    let changed =
        verdict["effects"].as_array().unwrap().iter().filter(|e| e["present_in"] == json!(["target"]));
    assert_eq!(changed.map(|e| &e["effect"]).collect::<Vec<_>>(), ["payload"], "{verdict}");
    let mass_kg = 9.839 * verdict["effects"][0]["parameters"]["mass_kg"]["value"].as_f64().unwrap();
    assert!((mass_kg / 2.805 - 1.0).abs() < 0.03, "{mass_kg} kg of 2.805");
}

#[test]
fn the_wrist_of_a_tx40_is_coupled() {
    let Some(_) = real_recordings("the_wrist_of_a_tx40_is_coupled") else { return };
    let verdict = example("tx40_coupling").0.json("out/verdict.json");
    let first = &verdict["effects"][0];
    assert_eq!(first["effect"], "joint_coupling_friction", "{verdict}");
    assert_eq!(first["joints"], serde_json::json!([4, 5]));
    assert_eq!(first["parameters"]["ratio"]["value"], 1.0);
}

/// A recording in which one joint moves determines little of the model; that is said, and not taken for noise.
#[test]
fn a_calibration_recording_that_determines_little_is_no_excuse() {
    let Some(_) = real_recordings("a_calibration_recording_that_determines_little_is_no_excuse") else {
        return;
    };
    let folder = Folder::new();
    folder.write("asked.toml", &ur10e("joint_1_only", "excitation_20s"));
    folder.run("diagnose asked.toml --out out --verdict-only").found();
    let verdict = folder.json("out/verdict.json");
    assert_ne!(verdict["verdict"], "no_mismatch", "{verdict}");
    let notes: Vec<&str> = verdict["notes"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert!(notes.iter().any(|note| note.contains("do not determine")), "{notes:?}");
    for joint in verdict["residual"].as_array().unwrap() {
        assert!(joint["floor_rms"].as_f64() < joint["baseline_rms"].as_f64(), "{joint}");
    }
}

/// Recordings that say too little are refused, or it is said; none passes for a recording in which nothing is missing.
#[test]
fn short_and_empty_recordings_are_no_excuse() {
    let folder = Folder::new().with_whole_demo();
    let whole = folder.read("experiment.toml");
    let calibrated_on = |recordings: &str| {
        with_table(&whole, "[recordings]", &format!("[recordings]\ncalibration = [{recordings}]\n"))
    };
    folder.write("short.toml", &calibrated_on("{ file = \"exciting_motion.csv\", window_s = [2.0, 3.5] }"));
    folder.run("diagnose short.toml --out short").refused(&["exciting_motion.csv", "too short"]);
    let beside = "\"exciting_motion.csv\", { file = \"other_motion.csv\", window_s = [2.0, 3.2] }";
    folder.write("beside.toml", &calibrated_on(beside));
    let run = folder.run("diagnose beside.toml --out beside");
    assert!(run.status() <= 1, "{}", run.stderr());
    let beside = folder.json("beside/verdict.json");
    let noted = |of: &Value| of.to_string().contains("other_motion.csv is short");
    assert!(noted(&beside["notes"]) || noted(&beside["not_examined"]), "{beside}");

    // After the stamp and the positions of six joints come their currents.
    folder.edit("exciting_motion.csv", |text| {
        with_cells(text, |_, column, _| (7..13).contains(&column).then(|| "0".to_owned()))
    });
    std::fs::rename(folder.path("exciting_motion.csv"), folder.path("zero.csv")).unwrap();
    folder.write("zero.toml", &calibrated_on("\"zero.csv\""));
    folder.run("diagnose zero.toml --out zero").refused(&["zero.csv", "constant"]);
}

/// With an effect withheld its detector masks nothing.
#[test]
fn a_contact_that_may_not_be_named_is_not_masked_either() {
    let plan = "[recordings]\nduration_s = 10.0\n[singles]\nrobots = ['ur10e']\neffects = ['external_contact']\n\
                strengths = ['strong']\ntrials = 1\n";
    let folder = Folder::new().with_concealed(plan, 2026);
    let case = "case_0001";
    let joints = truth(&folder, case)["effects"][0]["joints"].clone();
    let found = verdict(&folder, case, &[]);
    assert_eq!(found["effects"][0]["effect"], "external_contact", "{found}");
    let without = verdict(&folder, case, &["--without", "external_contact"]);
    let effects = without["effects"].as_array().unwrap();
    assert!(effects.iter().all(|e| e["effect"] != "external_contact"), "{without}");
    // Torque that only the targets keep is not missing in all recordings.
    assert_eq!([&without["verdict"], &without["structure"]], ["unexplained", "no_mismatch"], "{without}");
    let rms = |of: &Value, joint: usize| of["residual"][joint]["unexplained_rms"].as_f64().unwrap();
    let larger = |joint: &Value| {
        let joint = joint.as_u64().unwrap() as usize;
        rms(&without, joint) > 1.02 * rms(&found, joint)
    };
    assert!(joints.as_array().unwrap().iter().any(larger), "{found} {without}");
}

/// A hand that pushes a standing arm is a contact, with or without the rest cut away.
#[test]
fn a_push_against_a_standing_arm_is_a_contact() {
    let Some(_) = real_recordings("a_push_against_a_standing_arm_is_a_contact") else { return };
    let asked = ur10e("unloaded_50s", "push_standing");
    let folder = Folder::new();
    for (name, more) in [("trimmed", ""), ("whole", "\ntrim_rest = false\n")] {
        folder.write(&format!("{name}.toml"), &format!("{asked}{more}"));
        folder.aurt(["diagnose", &format!("{name}.toml"), "--out", name, "--verdict-only"]).found();
        let verdict = folder.json(&format!("{name}/verdict.json"));
        assert_eq!(verdict["verdict"], "named", "{verdict}");
        let contacts: Vec<&Value> = verdict["effects"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|e| e["effect"] == "external_contact")
            .collect();
        let pushed = |at: f64| {
            contacts.iter().any(|c| {
                let window = numbers(&c["window_s"]);
                window[0] <= at && at <= window[1]
            })
        };
        assert!(pushed(5.2) && pushed(9.0) && !pushed(1.0) && !pushed(17.0), "{verdict}");
    }
}
