//! What the command says of itself.

use crate::support::Folder;

#[test]
fn help_names_every_command_and_each_has_an_example() {
    let folder = Folder::new();
    let help = folder.aurt(["--help"]).succeeded().stdout();
    for command in [
        "run",
        "check",
        "sweep",
        "diagnose",
        "simulate",
        "excite",
        "completions",
        "man",
        "demo",
        "compile-rbd",
        "compile-rd",
        "calibrate",
        "calibrate-validate",
        "predict",
        "models",
        "robots",
        "export",
        "explain",
        "new-plugin",
    ] {
        assert!(help.contains(&format!("  {command} ")), "{command} is missing in\n{help}");
        let own = folder.aurt([command, "--help"]).succeeded().stdout();
        assert!(own.contains("Example:\n  aurt "), "{own}");
    }
}

#[test]
fn models_are_explained_and_unknown_ones_suggested() {
    let folder = Folder::new();
    let square = folder.aurt(["explain", "square"]).succeeded().stdout();
    for word in ["F_C0 + F_C1 τ_J²", "1/Nm", "Madsen", "{ model = \"square\" }", "even in the load"] {
        assert!(square.contains(word), "`{word}` is missing in\n{square}");
    }
    let nmse = folder.aurt(["explain", "NMSE"]).succeeded().stdout();
    assert!(nmse.contains("mean of |measured|"), "{nmse}");
    folder.aurt(["explain", "sqare"]).refused(&["sqare", "did you mean `square`?", "lists what there is"]);
    // An effect of a diagnosis and the arm term of the same name are explained together.
    let payload = folder.aurt(["explain", "payload"]).succeeded().stdout();
    for word in ["What to record to be sure", "Easily confused with", "model = \"payload\""] {
        assert!(payload.contains(word), "`{word}` is missing in\n{payload}");
    }
    // Keys of drives stand beside the symbols of their equation.
    let servo = folder.aurt(["explain", "position_servo"]).succeeded().stdout();
    for word in
        ["K_p d(r + b − q)", "back_emf_nm_s_per_rad", "K_e: braking", "coulomb_nm", "command = \"hold\""]
    {
        assert!(servo.contains(word), "`{word}` is missing in\n{servo}");
    }
    for drive in ["current", "pd_law", "torque", "voltage"] {
        assert!(folder.aurt(["explain", drive]).succeeded().stdout().contains("delay_s"), "{drive}");
    }
    folder.aurt(["explain", "position_serv"]).refused(&["did you mean `position_servo`?"]);
    let all = folder.aurt(["explain"]).succeeded().stdout();
    for word in [
        "joint_elasticity",
        "position_servo",
        "maxwell_slip",
        "condition_number",
        "noise_floor",
        "out_of_reach",
        "unexplained",
    ] {
        assert!(all.contains(word), "`{word}` is missing in\n{all}");
    }
}

#[test]
fn wrong_arguments_leave_with_status_2() {
    let folder = Folder::new();
    folder.write("mdh.csv", "alpha,a,d\n0,0,0\n");
    let run = |line: &str| folder.aurt(line.split_whitespace());
    run("frobnicate").refused(&["frobnicate"]);
    run("compile-rbd --mdh mdh.csv --gravity 0 0 --out r.json").refused(&["three numbers", "found 2"]);
    run("compile-rbd --mdh mdh.csv --gravity 0 0 0 -9.81 --out r.json")
        .refused(&["three numbers", "found 4"]);
    run("compile-rbd --mdh mdh.csv --gravity 0 0 down --out r.json").refused(&["down"]);
    run("calibrate-validate --model m --data d --calibration-data-rel 1.5 --out-params p --out-calibrated-model c \
         --out-prediction q")
        .refused(&["between 0 and 1"]);
    run("compile-rd --model-rbd r.json --friction-torque-model cubic --friction-viscous-powers 1 --out rd.json")
        .refused(&["cubic", "constant, square, absolute"]);
    run("export fmu rd_calibrated.json --out exported").refused(&["--kind <KIND>"]);
    run("export fmu rd_calibrated.json --kind sideways --out exported").refused(&["inverse", "forward"]);
    run("export c rd_calibrated.json --fmi 2 --out exported")
        .refused(&["--fmi", "of the target `fmu` alone"]);
    assert_eq!(folder.names(), ["mdh.csv"]);
}

#[test]
fn a_library_that_is_no_plugin_is_refused() {
    let folder = Folder::new();
    folder.write("no.so", "not a library");
    folder.aurt(["--plugin", "no.so", "models"]).refused(&["no.so"]);
    folder.aurt(["--plugin", "nowhere.so", "models"]).refused(&["nowhere.so"]);
}

#[test]
fn wrong_arguments_are_json_for_scripts() {
    let folder = Folder::new();
    let run = folder.aurt(["compile-rbd", "--json", "--mdh", "mdh.csv"]);
    assert_eq!(run.status(), 2);
    let document: serde_json::Value = serde_json::from_str(&run.stdout()).unwrap();
    let message = document["error"]["problems"][0]["message"].as_str().unwrap();
    assert!(message.contains("--gravity") && message.contains("--out"), "{message}");
}

#[test]
fn shells_and_manual_readers_are_served() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish"] {
        let script = folder.aurt(["completions", shell]).succeeded().stdout();
        assert!(script.contains("compile-rbd") && script.contains("friction-torque-model"), "{shell}");
    }
    folder.aurt(["man", "--out", "man1"]).succeeded();
    let page = folder.read("man1/aurt-compile-rd.1");
    assert!(page.contains("friction") && page.starts_with(".ie"), "{page}");
}

/// Every section and key that the documentation of experiments lists is explained.
#[test]
fn keys_of_experiments_are_explained() {
    let folder = Folder::new();
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/experiment-file.md");
    let page = std::fs::read_to_string(page).unwrap();
    let sections = page.lines().filter_map(|l| l.strip_prefix("## `[")?.split(']').next());
    let keys = page.lines().filter_map(|l| l.strip_prefix("| `")?.split('`').next());
    let names: Vec<&str> = sections
        .chain(keys)
        .map(|n| n.trim_matches('['))
        .chain(["target", "validation", "simulated"])
        .collect();
    assert!(names.len() > 20, "{names:?}");
    for name in names {
        let said = folder.aurt(["explain", name]).succeeded().stdout();
        assert!(said.lines().count() > 2, "{name}: {said}");
    }
}

#[test]
fn an_experiment_that_is_not_there_is_looked_for() {
    let folder = Folder::new();
    let place = folder.path("").canonicalize().unwrap();
    let said = folder.aurt("run nope.toml --out out".split(' ')).refused(&[
        "nope.toml",
        "no such file",
        "aurt demo",
    ]);
    assert!(said.contains(place.to_str().unwrap().trim_end_matches('/')), "{said}");
    folder.write("experiment.toml", "");
    folder.aurt("run experimant.toml --out out".split(' ')).refused(&["did you mean experiment.toml?"]);
    folder.write("typo.toml", "");
    let unrelated = folder.aurt("run nope.toml --out out".split(' ')).stderr();
    assert!(!unrelated.contains("did you mean"), "{unrelated}");
    folder.aurt("diagnose no/where.toml --out out".split(' ')).refused(&["no folder no either"]);
}
