//! Names that would command a terminal or turn the direction of writing, in everything that has a name: no command hands them on.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use aurt_files::is_harmful;
use serde_json::Value;

use crate::names::{BagJoint, experiment, recorded};
use crate::programs::aurt;
use crate::support::Folder;

/// `ESC [ 38;5;15;8 m` sets a colour and hides what follows; U+202E turns it around; U+009B is `ESC [` in one character.
const JOINTS: [BagJoint; 3] = [
    ("shoul\u{1b}[38;5;15;8mder", Some(0)),
    ("el\u{202e}bow\u{9b}2J\u{7f}", Some(1)),
    ("grip\u{2066}per", None),
];
const TOML_JOINTS: &str = r#"["shoul\u001b[38;5;15;8mder", "el\u202ebow\u009b2J\u007f"]"#;
const RECORDING: &str = "day\u{1b}[8m\u{202e}\u{9b}2J.mcap";
const TOML_RECORDING: &str = r#""DAYday\u001b[8m\u202e\u009b2J.mcap""#;
const MODEL: &str = "results/rd_calibrated.json";

/// Command lines that end with a result; MON and TUES are recordings, JOINTS names.
const LINES: [&str; 32] = [
    "check experiment.toml",
    "check MON --mdh mdh.csv --gravity 0 -9.81 0 --joint-names JOINTS --unit A",
    "run experiment.toml --out results",
    "init MON --robot mdh.csv --joint-names JOINTS --unit A --gravity 0 -9.81 0 --out first.toml",
    "compile-rbd --mdh mdh.csv --joint-names JOINTS --gravity 0 -9.81 0 --out rbd.json",
    "compile-rd --model-rbd rbd.json --experiment experiment.toml --out rd.json",
    "calibrate --model rd.json --data MON --unit A --out-params p.csv --out-calibrated-model c.json",
    "calibrate-validate --model rd.json --data MON --unit A --calibration-data-rel 0.6 --out-params p.csv \
     --out-calibrated-model c.json --out-prediction q.csv",
    "predict --model MODEL --data TUES --unit A --out q.csv",
    "simulate --model MODEL --motion TUES --unit A --out moved.csv",
    "track experiment.toml --model MODEL TUES --window-s 2 --out track",
    "diagnose experiment.toml --out diagnosis",
    "next experiment.toml --tries 8 --duration-s 10 --out next.csv",
    "gains experiment.toml --expect --out gains",
    "sensitivity experiment.toml --effects stribeck --joints 0 --out sensitivity",
    "sweep run sweep.toml --out sweep",
    "sweep show sweep",
    "sweep plan sweep.toml --out planned",
    "sweep point 1 --out planned",
    "export c MODEL --name arm --out c",
    "export rust MODEL --name arm --out rust",
    "export urdf MODEL --name arm --out urdf",
    "export mjcf MODEL --name arm --out mjcf",
    "export sdf MODEL --name arm --out sdf",
    "export fmu MODEL --kind inverse --name arm --out fmu",
    "excite --robot ur10e --duration-s 5 --seed 1 --out motion.csv",
    "models",
    "robots",
    "explain",
    "trust",
    "completions bash",
    "man --out man",
];

/// Command lines without a part that a test can have.
const OTHERS: [&str; 3] = ["demo", "new-plugin", "help"];

fn assert_harmless(what: &str, text: &str) {
    if let Some(at) = text.find(is_harmful) {
        let around: String =
            text[..at].chars().rev().take(60).collect::<Vec<_>>().into_iter().rev().collect();
        panic!("{what}: {around:?} is followed by {:?}", text[at..].chars().next());
    }
}

/// Reports and sources of a folder and the folders in it.
fn assert_pages_harmless(folder: &Path, seen: &mut BTreeSet<String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            assert_pages_harmless(&path, seen);
            continue;
        }
        let ending = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if ["html", "svg", "c", "h", "rs", "urdf", "xml", "sdf"].contains(&ending.as_str())
            || name == "Cargo.toml"
        {
            assert_harmless(&path.display().to_string(), &fs::read_to_string(&path).unwrap());
            seen.insert(ending);
        }
    }
}

fn arguments(line: &str, model: &str) -> Vec<String> {
    let joints = JOINTS[..2].iter().map(|joint| joint.0).collect::<Vec<_>>().join(",");
    let word = |word: &str| match word {
        "MON" => format!("mon{RECORDING}"),
        "TUES" => format!("tues{RECORDING}"),
        "JOINTS" => joints.clone(),
        "MODEL" => model.to_owned(),
        other => other.to_owned(),
    };
    line.split_whitespace().map(word).collect()
}

/// A folder of an arm, its recordings and a sweep, all with such names.
fn hostile() -> Folder {
    let folder = recorded(&JOINTS);
    let robot = format!("joint_names = {TOML_JOINTS}\ntorque_constants_nm_per_a = [1.0, 1.0]");
    let mut text = experiment(&robot, "") + "[calibration]\nestimator = \"consistent\"\n";
    for day in ["mon", "tues"] {
        fs::rename(folder.path(&format!("{day}day.mcap")), folder.path(&format!("{day}{RECORDING}")))
            .unwrap();
        text = text.replace(&format!("'{day}day.mcap'"), &TOML_RECORDING.replace("DAY", day));
    }
    folder.write("experiment.toml", &text);
    let variant = |name: &str, f: f64| {
        format!("[[sweep.variant]]\nname = \"{name}\"\nset = {{ \"preprocess.f_dyn_hz\" = {f:?} }}\n")
    };
    let variants = variant("a\\u001b[8m\\u202eb", 4.0) + &variant("c", 6.0);
    folder.write("sweep.toml", &(text + &variants));
    folder
}

#[test]
fn no_command_hands_on_names_that_command_a_terminal() {
    let folder = hostile();
    for line in LINES {
        for json in [&["--json"][..], &[]] {
            // Neither is written over.
            let _ = fs::remove_file(folder.path("first.toml"));
            let _ = fs::remove_dir_all(folder.path("fmu"));
            let words = arguments(line, MODEL);
            let run = folder.aurt(words.iter().map(String::as_str).chain(json.iter().copied()));
            let (out, err) = (run.stdout(), run.stderr());
            assert!(run.status() < 2, "{line}: {out}{err}");
            assert_harmless(line, &out);
            assert_harmless(line, &err);
            if !json.is_empty() {
                serde_json::from_str::<Value>(&out).unwrap_or_else(|e| panic!("{line}: {e}"));
            }
        }
    }
    // What programs read has the names as they are.
    let document = folder.aurt(["check", "experiment.toml", "--json"]).stdout();
    let document: Value = serde_json::from_str(&document).unwrap();
    assert!(document.to_string().contains('\u{202e}'), "{document}");

    // A model whose coefficients have such names.
    let model = folder.read(MODEL).replace("F_v1.", "F\\u001b[8m\u{202e}v1.");
    folder.write("model.json", &model);
    let of_model = LINES.iter().filter(|line| line.contains("MODEL"));
    for line in of_model {
        let run = folder.aurt(arguments(line, "model.json"));
        assert_harmless(line, &(run.stdout() + &run.stderr()));
    }
    let mut seen = BTreeSet::new();
    assert_pages_harmless(&folder.path(""), &mut seen);
    assert!(seen.len() >= 6, "{seen:?}");
}

#[test]
fn no_command_hands_on_arguments_that_command_a_terminal() {
    let folder = Folder::new();
    let help = folder.aurt(["--help"]).succeeded().stdout();
    let names = help.lines().skip_while(|line| *line != "Start here:").take_while(|line| *line != "Options:");
    let names = names.filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    let commands: BTreeSet<&str> = names.filter(|name| !name.is_empty()).collect();
    let walked = LINES.iter().map(|line| line.split(' ').next().unwrap());
    assert_eq!(commands, walked.chain(OTHERS).collect());
    for command in commands {
        for argument in ["\u{1b}[8m\u{202e}a", "--\u{1b}[8m\u{202e}a"] {
            for json in [&["--json"][..], &[]] {
                let run = folder.aurt([command, argument].into_iter().chain(json.iter().copied()));
                assert_harmless(command, &(run.stdout() + &run.stderr()));
            }
        }
    }
    let run = folder.aurt(["\u{1b}[8m\u{202e}a"]);
    assert_harmless("an unknown command", &run.stderr());
}

/// Output of a command on a terminal with colours, lines ended as in files; nothing, with a reason printed, where no program makes a
/// terminal. Its standard error is one as well unless it goes to `elsewhere`.
#[cfg(target_os = "linux")]
fn on_terminal(folder: &Folder, line: &str, elsewhere: bool) -> Option<String> {
    let words = arguments(line, MODEL).into_iter().map(|word| format!(" '{word}'")).collect::<String>();
    let apart = if elsewhere { " 2> /dev/null" } else { "" };
    let output = Command::new("script")
        .args(["-qc", &format!("'{}'{words}{apart}", aurt().display()), "/dev/null"])
        .current_dir(folder.path(""))
        .env_remove("NO_COLOR")
        .env("TERM", "xterm-256color")
        .stdin(std::process::Stdio::null())
        .output();
    let Ok(output) = output else {
        println!("skipped: there is no program `script`");
        return None;
    };
    Some(String::from_utf8(output.stdout).unwrap().replace("\r\n", "\n"))
}

#[cfg(target_os = "linux")]
#[test]
fn no_name_commands_a_terminal_with_colours() {
    let folder = hostile();
    let text = folder.read("experiment.toml");
    folder.write("bad.toml", &(text + "[joint_dynamics]\ncoulomb = { model = \"\\u001b[38;5;15;8mx\" }\n"));
    let lines = [
        "check experiment.toml",
        "run experiment.toml --out results",
        "diagnose experiment.toml --out diagnosis",
        "sweep run sweep.toml --out sweep",
        "sweep show sweep",
        "export mjcf MODEL --name arm --out mjcf",
    ];
    let mut coloured = 0;
    for line in lines {
        let Some(shown) = on_terminal(&folder, line, true) else { return };
        let own = ["\u{1b}[1m", "\u{1b}[33m", "\u{1b}[0m"];
        coloured += usize::from(own.iter().any(|sequence| shown.contains(sequence)));
        assert_harmless(line, &own.iter().fold(shown, |text, sequence| text.replace(sequence, "")));
    }
    assert!(coloured >= 5, "{coloured}");
    for line in ["run bad.toml --out results", "run \u{1b}[38;5;15;8mx.toml --out results"] {
        let Some(shown) = on_terminal(&folder, line, false) else { return };
        assert!(shown.contains("[38;5;15;8mx") && shown.contains("\u{1b}["), "{line:?}: {shown:?}");
        assert!(!shown.contains("\u{1b}[38;5;15;8m"), "{line:?}: {shown:?}");
    }
    // Sequences in arguments are left out.
    let Some(shown) = on_terminal(&folder, "\u{1b}[38;5;15;8mx", false) else { return };
    assert!(shown.starts_with("\u{1b}[33merror:\u{1b}[0m") && shown.contains("'x'"), "{shown:?}");
    assert_harmless("a command", &shown.replace("\u{1b}[33m", "").replace("\u{1b}[0m", ""));
    let Some(shown) = on_terminal(&folder, "--help", false) else { return };
    assert!(shown.contains("\u{1b}[") && shown.contains("Options:"), "{shown:?}");
}
