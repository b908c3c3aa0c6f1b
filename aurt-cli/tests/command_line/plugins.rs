//! A plugin that `aurt new-plugin` wrote is built, tests itself, and is then a model like any other.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::{Folder, text};

const EXPERIMENT: &str = include_str!("files/plugins.toml");

fn succeeded(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(output.status.success(), "{command:?}\n{}\n{}", text(&output.stdout), text(&output.stderr));
    text(&output.stdout)
}

/// The model is listed, explained, calibrated, saved, used again and swept.
fn is_a_model(folder: Folder, library: &Path, model: &str) {
    let folder = folder.with_demo(&["mdh.csv", "exciting_motion.csv", "other_motion.csv"]);
    let library = text(library);
    let listed = folder.run(format!("--plugin {library} models")).succeeded().stdout();
    assert!(listed.contains(&format!("  {model} ")), "{listed}");
    let explained = folder.run(format!("--plugin {library} explain {model}")).succeeded().stdout();
    assert!(explained.contains("saturation_velocity_rad_s"), "{explained}");

    folder.write("experiment.toml", &EXPERIMENT.replace("LIBRARY", &library).replace("MODEL", model));
    folder.run("run experiment.toml --out out").succeeded();
    let saved = folder.json("out/rd_calibrated.json");
    let viscous = &saved["model"]["joint_dynamics"][0]["viscous"];
    assert_eq!((&viscous["model"], &viscous["saturation_velocity_rad_s"]), (&model.into(), &1.0.into()));
    let predict =
        "predict --model out/rd_calibrated.json --data other_motion.csv --gravity 0 0 -9.81 --out p.csv";
    let predict = || predict.split(' ').collect::<Vec<_>>();
    folder.aurt(predict()).refused(&[model, "which is not loaded", "load it with `--plugin"]);
    folder.aurt([vec!["--plugin", &library], predict()].concat()).succeeded();

    asks_first(&folder, &library);

    folder.run("sweep run experiment.toml --out sweep").succeeded();
    let table = folder.json("sweep/table.json");
    assert_eq!(table["ranked"].as_array().unwrap().len(), 3);
    assert_eq!(table["failed"].as_array().unwrap().len(), 0);

    // A library that one point names is not a part of the others: each can be run without it.
    let plain =
        EXPERIMENT.replace("MODEL", "saturating").replace("libraries = [\"LIBRARY\"]", "libraries = []");
    let (plain, _) = plain.split_once("[sweep.grid]").unwrap();
    let own = "{ model = \"MODEL\", saturation_velocity_rad_s = 1.0 }".replace("MODEL", model);
    let variants = format!(
        "[[sweep.variant]]\nname = \"ours\"\n[[sweep.variant]]\nname = \"plugin\"\nset = {{ \"plugins.libraries\" = \
         [\"{library}\"], \"joint_dynamics.viscous\" = {own} }}\n"
    );
    folder.write("one.toml", &format!("{plain}{variants}"));
    folder.run("sweep plan one.toml --out one").succeeded();
    folder.run("sweep point 1 --out one").succeeded();
    folder.run("sweep point 2 --out one").succeeded();
    folder.run("sweep collect --out one").succeeded();
}

/// Files that name a library run none of its code before somebody has said that they may.
fn asks_first(folder: &Folder, library: &str) {
    let list = text(&folder.path("list"));
    let aurt = |arguments: &[&str]| {
        folder.aurt_with([("AURT_TRUST", ""), ("AURT_TRUST_FILE", list.as_str())], arguments)
    };
    let run = ["run", "experiment.toml", "--out", "asked"];
    aurt(&run).refused(&["is not trusted", "--allow-plugins", "aurt trust"]);
    assert!(!folder.path("asked").exists());
    aurt(&[&["--allow-plugins"][..], &run].concat()).succeeded();
    aurt(&[&["--plugin", library][..], &run].concat()).succeeded();
    aurt(&run).refused(&["is not trusted"]);
    assert!(aurt(&["trust"]).succeeded().stdout().contains("no library is trusted"));
    aurt(&["trust", library]).succeeded();
    aurt(&run).succeeded();
    assert!(aurt(&["trust"]).succeeded().stdout().contains(library));
    let saved = folder.json("asked/rd_calibrated.json");
    let hash = blake3::hash(&fs::read(library).unwrap()).to_hex().to_string();
    assert_eq!(saved["model"]["joint_dynamics"][0]["viscous"]["plugin"]["blake3"], hash.as_str());
    // Its bytes are trusted, not its name.
    folder.write("list", &format!("{}  {library}\n", "0".repeat(64)));
    aurt(&run).refused(&["is not trusted"]);
    folder.write("list", "nonsense\n");
    aurt(&run).refused(&["line 1 begins with no BLAKE3 hash"]);
}

/// What never ends is no list and no library, and is refused before anything is asked about trust.
#[cfg(target_os = "linux")]
#[test]
fn libraries_and_their_list_are_regular_files() {
    let folder = Folder::new().with_demo(&["mdh.csv", "exciting_motion.csv", "other_motion.csv"]);
    let pipe = text(&folder.path("pipe"));
    succeeded(Command::new("mkfifo").arg(&pipe));
    for endless in ["/dev/zero", "/proc/kmsg", pipe.as_str()] {
        folder.aurt_with([("AURT_TRUST", ""), ("AURT_TRUST_FILE", endless)], ["models"]).refused(&[endless]);
        folder
            .write("experiment.toml", &EXPERIMENT.replace("LIBRARY", endless).replace("MODEL", "saturating"));
        folder.run("run experiment.toml --out out").refused(&[endless]);
        folder.run(format!("trust {endless}")).refused(&[endless]);
    }
}

#[test]
fn a_new_rust_plugin_is_calibrated_and_swept() {
    let folder = Folder::new();
    folder.run("new-plugin drag-rust").succeeded();
    // The versions of this workspace, so that nothing has to be downloaded.
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    fs::copy(root.join("Cargo.lock"), folder.path("drag-rust/Cargo.lock")).unwrap();
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("new-plugin-target");
    let cargo = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO"));
        command.current_dir(folder.path("drag-rust")).args(arguments);
        command.env("CARGO_TARGET_DIR", &target).env("CARGO_PROFILE_DEV_DEBUG", "0");
        succeeded(&mut command)
    };
    let tests = cargo(&["test", "--lib"]);
    assert!(tests.contains("test result: ok. 4 passed"), "{tests}");
    cargo(&["build"]);
    let built = target.join("debug").join(format!("{DLL_PREFIX}drag_rust{DLL_SUFFIX}"));
    is_a_model(folder, &built, "drag_rust");
}

#[test]
fn a_new_c_plugin_is_calibrated_and_swept() {
    if Command::new("make").arg("--version").output().is_err()
        || Command::new("cc").arg("--version").output().is_err()
    {
        println!("skipped: there is no C compiler `cc` or no `make`");
        return;
    }
    let folder = Folder::new();
    folder.run("new-plugin drag-c --lang c").succeeded();
    let make = |arguments: &[&str]| {
        succeeded(Command::new("make").current_dir(folder.path("drag-c")).args(arguments))
    };
    let tests = make(&["test"]);
    assert!(tests.contains("all checks passed"), "{tests}");
    make(&[]);
    let built: PathBuf = folder.path("drag-c").join(format!("libdrag_c{DLL_SUFFIX}"));
    is_a_model(folder, &built, "drag_c");
}

#[test]
fn a_library_that_panics_or_gives_no_number_fails_its_point_alone() {
    let folder = Folder::new().with_demo(&["mdh.csv", "exciting_motion.csv", "other_motion.csv"]);
    let (base, _) = EXPERIMENT.split_once("[sweep.grid]").unwrap();
    for (fault, reason) in [
        ("PANICS", "it panicked"),
        ("NOT_FINITE", "is NaN at sample"),
        ("OVERRUN", "writes 1 values too many into column 0"),
        ("STATE_OVERRUN", "writes beyond its state"),
        ("BEYOND_BOUND", "declares that it is bounded by one in magnitude, but column 0 at sample 0"),
    ] {
        let Some(library) = folder.faulty(fault) else { return };
        let base = base.replace("MODEL", "saturating").replace("LIBRARY", &text(&library));
        let sweep = "[sweep.grid]\n\"joint_dynamics.hysteresis.model\" = [\"sign\", \"faulty\", \"tanh\"]\n";
        folder.write("experiment.toml", &format!("{base}{sweep}"));
        folder.run(format!("sweep run experiment.toml --out {fault}")).found();
        let table = folder.json(&format!("{fault}/table.json"));
        assert_eq!(table["ranked"].as_array().unwrap().len(), 2);
        let error = table["failed"][0]["error"].as_str().unwrap();
        assert!(error.contains("model `faulty` failed") && error.contains(reason), "{error}");
    }
}

#[test]
fn names_of_a_library_are_words_and_each_is_there_once() {
    let folder = Folder::new();
    folder.write("none.so", "no library");
    let said = folder.run("--plugin none.so models").refused(&["none.so"]);
    assert!(!said.contains("dlopen failed"), "{said}");
    folder.run("--plugin nowhere.so models").refused(&["nowhere.so"]);
    for (fault, reason) in [("NO_NAME", "names are words"), ("TWICE", "faulty")] {
        let Some(library) = folder.faulty(fault) else { return };
        folder.aurt(["--plugin", &text(&library), "models"]).refused(&[reason]);
    }
}
