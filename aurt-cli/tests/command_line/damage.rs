//! What hostile runs from outside have found, each once more.
#![cfg(unix)]

use std::ffi::OsString;
use std::fs;
use std::io::Read;
use std::os::unix::ffi::OsStringExt;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::support::{DEMO, Folder, WHOLE_DEMO};

#[test]
fn a_path_that_is_no_utf_8_is_refused_by_every_command_before_any_work() {
    let folder = Folder::new().with_whole_demo();
    let bad = OsString::from_vec(b"bad\xff".to_vec());
    fs::create_dir(folder.path("").join(&bad)).unwrap();
    let before = fs::read_dir(folder.path("")).unwrap().count();
    for line in [
        "run experiment.toml --out",
        "check exciting_motion.csv --out",
        "demo --out",
        "diagnose experiment.toml --out",
        "sweep run experiment.toml --out",
        "compile-rbd --mdh mdh.csv --out",
        "excite --robot ur10e --seed 1 --out",
        "check",
    ] {
        for json in [&[][..], &["--json"]] {
            let mut arguments: Vec<OsString> = line.split_whitespace().map(Into::into).collect();
            arguments.push(bad.clone());
            arguments.extend(json.iter().map(|j| (*j).into()));
            let output = Command::new(env!("CARGO_BIN_EXE_aurt"))
                .args(&arguments)
                .current_dir(folder.path(""))
                .output()
                .unwrap();
            let said = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{line}: {said}");
            assert!(said.contains("no UTF-8 text") && !said.contains("panicked"), "{line}: {said}");
        }
    }
    assert_eq!(fs::read_dir(folder.path("")).unwrap().count(), before);
    // A folder of such a name that nobody names in an argument is in nobody's way.
    for name in ["mdh.csv", "exciting_motion.csv"] {
        fs::copy(folder.path(name), folder.path("").join(&bad).join(name)).unwrap();
    }
    let output = Command::new(env!("CARGO_BIN_EXE_aurt"))
        .args(["check", "exciting_motion.csv", "--json"])
        .current_dir(folder.path("").join(&bad))
        .output()
        .unwrap();
    assert!(output.status.code().is_some_and(|code| code < 2), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn a_link_to_a_deleted_file_is_written_to_and_stays() {
    let folder = Folder::new().with_whole_demo();
    let link = folder.path("devices");
    fs::create_dir(&link).unwrap();
    // What /dev/stdout is: a link to the descriptor, whose file has another name or none.
    let gone = folder.path("gone.csv");
    let file = fs::File::create(&gone).unwrap();
    fs::remove_file(&gone).unwrap();
    let motion =
        "excite --robot ur10e --kind multi-sine --duration-s 5 --seed 1 --quiet --out /proc/self/fd/1";
    let status = Command::new(env!("CARGO_BIN_EXE_aurt"))
        .args(motion.split_whitespace())
        .current_dir(folder.path(""))
        .stdout(file.try_clone().unwrap())
        .status()
        .unwrap();
    assert_eq!(status.code(), Some(0));
    assert!(!gone.exists());
    assert!(file.metadata().unwrap().len() > 1000);
    // A link that leads nowhere yet keeps its place too.
    symlink("target.csv", folder.path("link.csv")).unwrap();
    folder.run(motion.replace("/proc/self/fd/1", "link.csv")).succeeded();
    assert!(fs::symlink_metadata(folder.path("link.csv")).unwrap().is_symlink());
    assert!(folder.read("target.csv").starts_with("time,"));
}

#[test]
fn a_document_that_nobody_could_take_is_a_failure() {
    let Ok(full) = fs::File::options().write(true).open("/dev/full") else {
        println!("skipped: there is no /dev/full");
        return;
    };
    let mut child = Command::new(env!("CARGO_BIN_EXE_aurt"))
        .args(["models", "--json"])
        .stdout(full)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let status = child.wait().unwrap();
    let mut said = String::new();
    child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert_eq!(status.code(), Some(2), "{said}");
    assert!(said.contains("standard output") && said.contains("cannot be written"), "{said}");
}

#[test]
fn counts_are_checked_before_memory_is_taken_for_them() {
    let folder = Folder::new();
    for harmonics in ["18446744073709551615", "4294967296", "0"] {
        for kind in ["optimised", "multi-sine"] {
            let line =
                format!("excite --robot ur10e --kind {kind} --harmonics {harmonics} --seed 1 --out m.csv");
            folder.run(&line).refused(&["number of harmonics", "between 1 and 40"]);
        }
    }
    let scenario = "robot = \"ur10e\"\nseed = 7\n[motion]\nkind = \"multi_sine\"\nduration_s = 5.0\n\
                    harmonics = 4294967296\ntop_hz = 0.8\nshare = 0.5\n";
    folder.write("scenario.toml", scenario);
    folder
        .run("simulate --scenario scenario.toml --out m.csv")
        .refused(&["scenario.toml", "number of harmonics"]);
    folder
        .run("excite --robot ur10e --kind sweeps --duration-s 3600 --rate-hz 100000 --seed 1 --out m.csv")
        .refused(&["number of rows"]);
    assert_eq!(folder.names(), ["scenario.toml"]);
}

#[test]
fn limits_are_radians_and_rows_are_whole() {
    let folder = Folder::new();
    folder.write("mdh.csv", "alpha,a,d\n0,0.5,0\n0,0,0\n");
    let header = "lower_rad,upper_rad,velocity_rad_s,acceleration_rad_s2\n";
    let excite =
        "excite --mdh mdh.csv --limits limits.csv --kind sweeps --seed 1 --out m.csv --gravity 0 -9.81 0";
    let refusal = |rows: &str, said: &[&str]| {
        folder.write("limits.csv", &format!("{header}{rows}"));
        folder.run(excite).refused(said);
        let run = folder.run(format!("{excite} --json"));
        let document = run.json();
        let problem = &document["error"]["problems"][0];
        assert_eq!((&problem["file"], &problem["line"]), (&"limits.csv".into(), &3.into()), "{document}");
    };
    refusal("-3,3,1,3\n-3,1,3,1,2,0,8,0\n", &["limits.csv", "8 cells, the header has 4"]);
    refusal("-3,3,1,3\n-180,180,1,3\n", &["limits.csv", "lower_rad", "radians"]);
    refusal("-3,3,1,3\n-3,x,1,3\n", &["limits.csv", "`x` is no finite number"]);
    folder.write("limits.csv", &format!("{header}-3,3,1,3\n-3,3,1,3\n"));
    folder.run(excite).succeeded();
}

#[test]
fn programs_are_told_the_place_of_what_is_wrong() {
    let folder = Folder::new();
    let scenario = "robot = \"two_link\"\nseed = 7\n[motion]\nkind = \"multi_sine\"\nduration_s = 3.0\nharmonics = 5\n\
                    top_hz = 0.8\nshare = 0.5\n[[effect]]\nname = \"current_offset\"\njoints = [1]\noffset_nm = [3.0]\n";
    let second = "[[effect]]\nname = \"current_offset\"\njoints = [7]\noffset_nm = [3.0]\n";
    let excite = "excite --robot ur10e --kind sweeps --seed 1 --out m --limits";
    for (file, text, line, command) in [
        ("s.toml", format!("{scenario}{second}"), Some(13), "simulate --out m --scenario"),
        ("s.toml", scenario.replace("two_link", "three_link"), Some(1), "simulate --out m --scenario"),
        ("s.toml", scenario.replace("share = 0.5", "share = 5.0"), Some(3), "simulate --out m --scenario"),
        ("l.csv", "# limits\nlower_rad\n".to_owned(), Some(2), excite),
        ("l.so", "no library".to_owned(), None, "models --plugin"),
    ] {
        folder.write(file, &text);
        let run = folder.run(format!("--json {command} {file}"));
        let document = run.json();
        let problem = &document["error"]["problems"][0];
        assert_eq!((problem["file"].as_str(), problem["line"].as_u64()), (Some(file), line), "{document}");
        let message = problem["message"].as_str().unwrap();
        assert_eq!(message.matches(file).count(), 1, "{message}");
    }
    assert_eq!(folder.names(), ["l.csv", "l.so", "s.toml"]);
}

#[test]
fn the_keys_that_the_pages_list_are_in_the_files() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let folder = Folder::new();
    folder.run("demo --out demo --quiet").succeeded();
    let metrics = folder.json("demo/metrics.json");
    let page = fs::read_to_string(docs.join("formats.md")).unwrap();
    let beside = page.split("Further keys are").nth(1).unwrap().split(';').next().unwrap();
    for key in beside.split('`').skip(1).step_by(2) {
        assert!(!metrics[key].is_null(), "metrics.json has no {key}");
    }
    let verdict = folder.json("demo/diagnosis/verdict.json");
    let page = fs::read_to_string(docs.join("diagnosis.md")).unwrap();
    let table = page.split("`verdict.json` has:").nth(1).unwrap();
    let rows =
        table.lines().skip_while(|line| !line.starts_with("| `")).take_while(|line| line.starts_with('|'));
    for row in rows.filter(|row| !row.contains("(absent if none)")) {
        for key in row.split('|').nth(1).unwrap().split('`').skip(1).step_by(2) {
            assert!(!verdict[key].is_null(), "verdict.json has no {key}");
        }
    }
}

#[test]
fn unknown_names_take_no_time_and_no_page() {
    let folder = Folder::new().with_whole_demo();
    let quick = |arguments: &str, said: &[&str]| {
        let begin = Instant::now();
        let said = folder.run(arguments).refused(said);
        // Generous: a slow machine builds no quadratic algorithm.
        assert!(begin.elapsed() < Duration::from_secs(60), "{arguments} took {:?}", begin.elapsed());
        assert!(said.len() < 100_000, "{arguments} says {} bytes", said.len());
    };
    let names: Vec<String> = (0..100_000).map(|k| format!("alpha{k}")).collect();
    folder.write("wide.csv", &format!("{}\n{}\n", names.join(","), vec!["0"; 100_000].join(",")));
    quick("compile-rbd --mdh wide.csv --gravity 0 0 -9.81 --out r.json", &["wide.csv:1", "alpha0"]);
    let keys: String = (0..30_000).map(|k| format!("key_{k} = 1\n")).collect();
    folder.write("keys.toml", &format!("{keys}{}", folder.read("experiment.toml")));
    quick("run keys.toml --out out", &["keys.toml:1:1", "has no key `key_0`"]);
    folder.write("cell.csv", &format!("alpha,a,d\n0,{},0\n", "9x".repeat(5_000_000)));
    quick("compile-rbd --mdh cell.csv --gravity 0 0 -9.81 --out r.json", &["cell.csv:2", "bytes in all"]);
}

#[test]
fn a_dollar_in_a_folder_is_no_variable() {
    let folder = Folder::new();
    let inner = folder.path("of $HOME");
    fs::create_dir(&inner).unwrap();
    for name in WHOLE_DEMO {
        fs::copy(DEMO.path("demo").join(name), inner.join(name)).unwrap();
    }
    let mut text = fs::read_to_string(inner.join("experiment.toml")).unwrap();
    text.push_str("\n[sweep.grid]\n\"preprocess.f_dyn_hz\" = [5.0, 6.0]\n");
    fs::write(inner.join("sweep.toml"), text).unwrap();
    let run = |line: &str| {
        let mut arguments: Vec<_> = line.split_whitespace().collect();
        let path = inner.join(arguments.pop().unwrap());
        arguments.push(path.to_str().unwrap());
        folder.aurt(arguments)
    };
    run("sweep plan --out swept sweep.toml").succeeded();
    folder.run("sweep point 1 --out swept").succeeded();
}

#[test]
fn numbers_that_no_robot_has_are_refused_and_none_leave() {
    let folder = Folder::new().with_whole_demo();
    for (table, said) in [
        ("alpha,a,d\n0,0.5,1e308\n0,0,0\n", "metres"),
        ("alpha,a,d\n90,0.5,0\n0,0,0\n", "pi/2"),
        ("alpha,a,d\n0,612.7,0\n0,0,0\n", "metres"),
    ] {
        folder.write("odd.csv", table);
        folder
            .run("compile-rbd --mdh odd.csv --gravity 0 0 -9.81 --out r.json")
            .refused(&["odd.csv:2", said]);
    }
    folder.run("compile-rbd --mdh mdh.csv --gravity 0 0 1e300 --out r.json").refused(&["gravity"]);
    folder.run("run experiment.toml --out out").succeeded();
    // A saved model with a coefficient that overflows.
    let mut model = folder.json("out/rd_calibrated.json");
    let mut changed = 0;
    change_numbers(&mut model["calibration"]["parameters"], &mut changed);
    assert!(changed > 0);
    folder.write("odd.json", &model.to_string());
    folder
        .run("predict --model odd.json --data other_motion.csv --out p.csv")
        .refused(&["p.csv", "not a finite number"]);
    assert!(!folder.names().contains(&"p.csv".to_owned()));
    // The geometry that a model carries is held to the same bounds.
    let text = folder.read("out/rd_calibrated.json");
    let at = text.find("\"d_m\":").unwrap() + "\"d_m\":".len();
    let end = at + text[at..].find([',', '}', '\n']).unwrap();
    folder.write("far.json", &format!("{} 1e308{}", &text[..at], &text[end..]));
    folder
        .run("predict --model far.json --data other_motion.csv --out p.csv")
        .refused(&["far.json", "metres"]);
}

/// Replaces every `value` by one that no sum of torques can take.
fn change_numbers(value: &mut serde_json::Value, changed: &mut usize) {
    match value {
        serde_json::Value::Array(items) => items.iter_mut().for_each(|item| change_numbers(item, changed)),
        serde_json::Value::Object(entries) => {
            if let Some(number) = entries.get_mut("value") {
                *number = 1.7e308.into();
                *changed += 1;
            }
        }
        _ => {}
    }
}

#[test]
fn pipes_and_devices_end() {
    let folder = Folder::new().with_whole_demo();
    assert!(Command::new("mkfifo").arg(folder.path("pipe")).status().unwrap().success());
    symlink("/dev/zero", folder.path("zero")).unwrap();
    symlink("/proc/kmsg", folder.path("kernel")).unwrap();
    // Of files of a sweep a hash is taken first, for which they are read once more.
    let sweep = folder.read("experiment.toml").replace("exciting_motion.csv", "pipe");
    folder.write("sweep.toml", &(sweep + "\n[sweep.grid]\n\"preprocess.f_dyn_hz\" = [5.0, 6.0]\n"));
    let lines = [
        ("run zero --out out", "device"),
        ("check zero", "device"),
        ("compile-rbd --mdh zero --gravity 0 0 -9.81 --out r.json", "device"),
        ("simulate --scenario zero --out p.csv", "device"),
        ("run pipe --out out", "nobody writes"),
        ("check pipe", "nobody writes"),
        ("predict --model pipe --data other_motion.csv --out p.csv", "nobody writes"),
        ("export c pipe --name a --out out", "nobody writes"),
        ("sweep run sweep.toml --out out", "pipe"),
        ("run kernel --out out", "kernel"),
        ("check kernel", "kernel"),
        ("compile-rbd --mdh kernel --gravity 0 0 -9.81 --out r.json", "kernel"),
        ("predict --model kernel --data other_motion.csv --out p.csv", "kernel"),
        ("predict --model zero --data other_motion.csv --out p.csv", "device"),
    ];
    let ends = |(k, (line, said)): (usize, (&str, &str))| {
        let begin = Instant::now();
        folder.run(line.replace("--out ", &format!("--out {k}_"))).refused(&[said]);
        assert!(begin.elapsed() < Duration::from_secs(60), "{line}: {:?}", begin.elapsed());
    };
    // They wait for a writer: all at the same time, each with an output of its own.
    std::thread::scope(|scope| {
        for line in lines.into_iter().enumerate() {
            scope.spawn(move || ends(line));
        }
    });
}

#[test]
fn pipes_are_read_once() {
    let folder = Folder::new().with_whole_demo().with_demo(&["rd_calibrated.json"]);
    assert!(Command::new("mkfifo").arg(folder.path("pipe")).status().unwrap().success());
    let run = |line: &str, name: &str| {
        let (pipe, contents) = (folder.path("pipe"), folder.read(name));
        // A command that refuses its input stops reading it.
        let writer = std::thread::spawn(move || drop(fs::write(pipe, contents)));
        let run = folder.run(line);
        writer.join().unwrap();
        run
    };
    run("export c pipe --name arm --out c", "rd_calibrated.json").succeeded();
    run("predict --model pipe --data other_motion.csv --out p.csv", "rd_calibrated.json").succeeded();
    folder.run("predict --model rd_calibrated.json --data other_motion.csv --out q.csv").succeeded();
    assert_eq!(folder.read("p.csv"), folder.read("q.csv"));
    let line = "init pipe --robot ur10e --out first.toml";
    run(line, "other_motion.csv").refused(&["pipe", "which can be read once only", "save its contents"]);
}

#[test]
fn a_diagnosis_of_more_joints_than_it_can_weigh_is_refused_at_once() {
    let folder = Folder::new();
    let joints = 30;
    folder.write("mdh.csv", &format!("alpha,a,d\n{}", "pi/2,0.1,0.1\n".repeat(joints)));
    let names = |family: &str| (0..joints).map(|j| format!(",{family}_{j}")).collect::<String>();
    let mut text = format!("time{}{}\n", names("q"), names("tau"));
    for k in 0..400 {
        let t = f64::from(k) / 100.0;
        text.push_str(&format!("{t}"));
        for j in 0..2 * joints {
            text.push_str(&format!(",{:.6}", ((1.0 + 0.1 * j as f64) * t).sin()));
        }
        text.push('\n');
    }
    folder.write("a.csv", &text);
    folder.write(
        "experiment.toml",
        "schema = 1\n[robot]\nmdh = \"mdh.csv\"\ngravity_m_s2 = [0.0, 0.0, -9.81]\n\
         [recordings]\ncalibration = [\"a.csv\"]\n",
    );
    folder.run("diagnose experiment.toml --out out").refused(&["experiment.toml", "30 joints", "up to 20"]);
    assert!(!folder.path("out").exists());
}
