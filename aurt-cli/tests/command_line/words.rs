//! What the command says of itself.

use crate::support::Folder;

#[test]
fn help_names_every_command_and_each_has_an_example() {
    let folder = Folder::new();
    let help = folder.run("--help").succeeded().stdout();
    let commands = "run check sweep diagnose simulate excite completions man demo compile-rbd compile-rd calibrate \
                    calibrate-validate predict models robots export explain new-plugin";
    for command in commands.split(' ') {
        assert!(help.contains(&format!("  {command} ")), "{command} is missing in\n{help}");
        folder.run(format!("{command} --help")).says(&["Example:\n  aurt "]);
    }
}

#[test]
fn models_are_explained_and_unknown_ones_suggested() {
    let folder = Folder::new();
    let says = |name: &str, words: &[&str]| folder.run(format!("explain {name}")).says(words);
    says("square", &["F_C0 + F_C1 τ_J²", "1/Nm", "Madsen", "{ model = \"square\" }", "even in the load"]);
    says("NMSE", &["mean of |measured|"]);
    folder.run("explain sqare").refused(&["sqare", "did you mean `square`?", "lists what there is"]);
    // An effect of a diagnosis and the arm term of the same name are explained together.
    says("payload", &["What to record to be sure", "Easily confused with", "model = \"payload\""]);
    // Keys of drives stand beside the symbols of their equation.
    let servo =
        ["K_p d(r + b − q)", "back_emf_nm_s_per_rad", "K_e: braking", "coulomb_nm", "command = \"hold\""];
    says("position_servo", &servo);
    for drive in ["current", "pd_law", "torque", "voltage"] {
        says(drive, &["delay_s"]);
    }
    folder.run("explain position_serv").refused(&["did you mean `position_servo`?"]);
    let all =
        "joint_elasticity position_servo maxwell_slip condition_number noise_floor out_of_reach unexplained";
    says("", &all.split(' ').collect::<Vec<_>>());
}

#[test]
fn wrong_arguments_leave_with_status_2() {
    let folder = Folder::new();
    folder.write("mdh.csv", "alpha,a,d\n0,0,0\n");
    let run = |line: &str| folder.run(line);
    run("frobnicate").refused(&["frobnicate"]);
    run("compile-rbd --mdh mdh.csv --gravity 0 0 --out r.json").refused(&["three numbers", "found 2"]);
    run("compile-rbd --mdh mdh.csv --gravity 0 0 0 -9.81 --out r.json")
        .refused(&["three numbers", "found 4"]);
    run("compile-rbd --mdh mdh.csv --gravity 0 0 down --out r.json").refused(&["`down`"]);
    run("compile-rbd --mdh mdh.csv --gravity 0 0 nan --out r.json").refused(&["not finite"]);
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
fn wrong_arguments_are_json_for_scripts() {
    let folder = Folder::new();
    let run = folder.run("compile-rbd --json --mdh mdh.csv");
    assert_eq!(run.status(), 2);
    let document = run.json();
    let message = document["error"]["problems"][0]["message"].as_str().unwrap();
    assert!(message.contains("--gravity") && message.contains("--out"), "{message}");
}

#[test]
fn shells_and_manual_readers_are_served() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish"] {
        folder.run(format!("completions {shell}")).says(&["compile-rbd", "friction-torque-model"]);
    }
    folder.run("man --out man1").succeeded();
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
        let said = folder.run(format!("explain {name}")).succeeded().stdout();
        assert!(said.lines().count() > 2, "{name}: {said}");
    }
}
