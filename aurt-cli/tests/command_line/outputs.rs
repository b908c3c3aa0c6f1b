//! Outputs appear whole or not at all.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::{DEMO, Folder, with_cell, with_line};

#[test]
fn impossible_outputs_are_refused_first() {
    let folder = Folder::new().with_whole_demo();
    let run = |line: &str| folder.run(line);
    let compile = |out: &str| run(&format!("compile-rbd --mdh mdh.csv --gravity 0 0 -9.81 --out {out}"));
    compile(".").refused(&["--out", "is a folder"]);
    compile("no/rbd.json").refused(&["no/rbd.json", "not an existing folder", "create the folder first"]);
    compile("mdh.csv").refused(&["is an input", "overwritten"]);
    run("run experiment.toml --out mdh.csv").refused(&["is a file", "a folder is needed"]);
    run("run experiment.toml --out no/where").refused(&["not an existing folder"]);
    run("demo --out experiment.toml").refused(&["is a file"]);
}

#[test]
fn a_failing_run_leaves_nothing() {
    let folder = Folder::new().with_whole_demo();
    folder.edit("point_to_point.csv", |text| with_line(text, 700, |l| with_cell(l, 9, "nan")));
    folder.run("run experiment.toml --out out").refused(&["point_to_point.csv", "700"]);
    assert!(!folder.path("out").exists());

    // What an earlier run left stays as it was.
    fs::create_dir(folder.path("out")).unwrap();
    folder.write("out/metrics.json", "earlier");
    folder.run("run experiment.toml --out out").refused(&["700"]);
    assert_eq!(folder.read("out/metrics.json"), "earlier");
    assert_eq!(fs::read_dir(folder.path("out")).unwrap().count(), 1);
}

/// A file of some name, which the command reads, stays as it is when the command would write to that name.
#[test]
fn what_a_command_has_read_is_not_overwritten() {
    let folder = Folder::new().with_whole_demo();
    let copy = |from: &str, to: &str| fs::copy(folder.path(from), folder.path(to)).unwrap();
    let stays = |experiment: &str, command: &str, file: &str| {
        folder.write("own.toml", experiment);
        let (before, names) = (folder.read(file), folder.names());
        folder.run(command).refused(&[file, "overwritten"]);
        assert!(folder.read(file) == before && folder.names() == names, "{command}: {:?}", folder.names());
    };
    let toml = folder.read("experiment.toml");
    copy("exciting_motion.csv", "predicted_other_motion.csv");
    let recording = toml.replace("exciting_motion.csv", "predicted_other_motion.csv");
    stays(&recording, "run own.toml --out .", "predicted_other_motion.csv");
    copy("mdh.csv", "calibrated_parameters.csv");
    let table = toml.replace("mdh.csv", "calibrated_parameters.csv");
    stays(&table, "run own.toml --out .", "calibrated_parameters.csv");
    stays(&toml, "check own.toml --fixed mdh.csv", "mdh.csv");
    stays(
        &toml.replace("-9.81", "9.81"),
        "check own.toml --fixed exciting_motion.csv",
        "exciting_motion.csv",
    );
    folder.write("improved.toml", &toml);
    stays(&toml, "diagnose improved.toml --out .", "improved.toml");
    // Under another name: a link among the results, and a second name of the same file.
    #[cfg(unix)]
    for is_link in [true, false] {
        let second_name: fn(PathBuf, PathBuf) -> std::io::Result<()> =
            if is_link { std::os::unix::fs::symlink } else { fs::hard_link };
        fs::create_dir(folder.path("out")).unwrap();
        second_name(folder.path("other_motion.csv"), folder.path("out/metrics.json")).unwrap();
        stays(&toml, "run own.toml --out out", "out/metrics.json");
        fs::remove_dir_all(folder.path("out")).unwrap();
    }
}

/// Makes a folder as commands make it for unfinished results.
fn private_folder(path: &Path) {
    fs::create_dir_all(path).unwrap();
    #[cfg(unix)]
    fs::set_permissions(path, std::os::unix::fs::PermissionsExt::from_mode(0o700)).unwrap();
}

#[test]
fn two_commands_do_not_write_to_one_place() {
    let folder = Folder::new().with_whole_demo();
    let held = |place: &str| {
        private_folder(&folder.path(place));
        let lock = fs::File::create(folder.path(place).join("lock")).unwrap();
        lock.lock().unwrap();
        lock
    };
    let run = || folder.run("run experiment.toml --out out");
    for place in [".aurt-out.part", "out/.aurt-.part"] {
        let lock = held(place);
        run().refused(&["--out", "another run writes there", "wait until it has ended"]);
        assert!(folder.path(place).is_dir() && !folder.path("out/metrics.json").exists());
        drop(lock);
    }
    // Nobody holds them any more: they are of killed commands.
    let said = run().succeeded().stderr();
    assert!(said.contains("that a killed command had left"), "{said}");
    assert!(folder.names().iter().all(|name| !name.starts_with(".aurt-")), "{:?}", folder.names());
    assert!(!folder.path("out/.aurt-.part").exists() && folder.path("out/metrics.json").exists());
    let lock = held(".aurt-p.csv.part");
    let predict =
        "predict --model out/rd_calibrated.json --data other_motion.csv --gravity 0 0 -9.81 --out p.csv";
    folder.run(predict).refused(&["p.csv", "another run writes there"]);
    drop(lock);
    folder.run(predict).succeeded();
}

/// A list of renames that somebody has put into the folder is no instruction, and is not even opened.
#[cfg(unix)]
#[test]
fn a_forged_journal_does_nothing() {
    let folder = Folder::new().with_whole_demo();
    folder.write("victim", "stays");
    folder.write("forged", "forged");
    let journal =
        format!("{}\0{}\0\0complete\n", folder.path("forged").display(), folder.path("victim").display());
    fs::create_dir(folder.path("out")).unwrap();
    for place in [".aurt-1.journal", "out/.aurt-1.journal"] {
        folder.write(place, &journal);
    }
    std::os::unix::fs::symlink("/dev/zero", folder.path(".aurt-2.journal")).unwrap();
    let pipe = folder.path("out/.aurt-3.journal");
    assert!(std::process::Command::new("mkfifo").arg(pipe).status().unwrap().success());
    folder.run("run experiment.toml --out out").succeeded();
    folder.run("run experiment.toml --out new").succeeded();
    assert_eq!((folder.read("victim"), folder.read("forged")), ("stays".into(), "forged".into()));
}

#[test]
fn exports_replace_exports_alone() {
    let folder = Folder::new();
    fs::copy(DEMO.path("demo/rd_calibrated.json"), folder.path("rd_calibrated.json")).unwrap();
    let export = |line: &str| folder.run(format!("export {line} --name robot --out ."));
    for (target, file) in [("c rd_calibrated.json", "main.c"), ("rust rd_calibrated.json", "Cargo.toml")] {
        folder.write(file, "mine");
        export(target).refused(&["--out", file, "is not by `aurt export`", "--force"]);
        assert_eq!(folder.read(file), "mine");
        export(&format!("{target} --force")).succeeded();
        // Its own files are replaced.
        export(target).succeeded();
        assert_ne!(folder.read(file), "mine");
    }
    // What it reads, never.
    let model = folder.read("rd_calibrated.json");
    folder.write("main.c", &model);
    export("c main.c --force").refused(&["main.c", "overwritten"]);
    assert_eq!(folder.read("main.c"), model);
}

#[test]
fn recordings_of_one_name_keep_their_predictions_apart() {
    let folder = Folder::new().with_whole_demo();
    fs::create_dir(folder.path("second")).unwrap();
    fs::rename(folder.path("other_motion.csv"), folder.path("second/exciting_motion.csv")).unwrap();
    folder.edit("experiment.toml", |text| text.replace("\"other_motion", "\"second/exciting_motion"));
    folder.run("run experiment.toml --out out").succeeded();
    let demo = |name: &str| DEMO.read(&format!("demo/{name}"));
    assert_eq!(folder.read("out/predicted_exciting_motion.csv"), demo("predicted_exciting_motion.csv"));
    assert_eq!(folder.read("out/predicted_exciting_motion_2.csv"), demo("predicted_other_motion.csv"));
    let metrics = folder.json("out/metrics.json");
    assert_eq!(metrics["recordings"][1]["prediction"], "predicted_exciting_motion_2.csv");
}

#[test]
fn the_demo_runs_again_where_it_has_run() {
    let folder = Folder::new();
    fs::create_dir(folder.path("demo")).unwrap();
    // As if it had been killed: one of its files is missing.
    for name in ["mdh.csv", "experiment.toml", "exciting_motion.csv", "other_motion.csv", "report.html"] {
        fs::copy(DEMO.path("demo").join(name), folder.path("demo").join(name)).unwrap();
    }
    for _ in 0..2 {
        folder.run("demo --out demo --quiet").succeeded();
        for name in ["mdh.csv", "later.toml", "point_to_point.csv", "rd_calibrated.json"] {
            assert_eq!(folder.read(&format!("demo/{name}")), DEMO.read(&format!("demo/{name}")), "{name}");
        }
    }
    let changed = folder.read("demo/experiment.toml") + "# mine\n";
    folder.write("demo/experiment.toml", &changed);
    folder.run("demo --out demo").refused(&["experiment.toml", "your own", "another folder"]);
    assert_eq!(folder.read("demo/experiment.toml"), changed);
}
