//! `aurt track`: a machine that stays as it is, one that gets a load, one whose friction grows.

use std::process::Command;

use crate::support::{Folder, assert_has};

const START: [&str; 6] =
    ["track", "experiment.toml", "--model", "results/rd_calibrated.json", "--window-s", "1.5"];

const LATER: [&str; 2] = ["later_motion.csv", "later_other_motion.csv"];

fn calibrated() -> Folder {
    let folder = Folder::new().with_whole_demo().with_demo(&LATER);
    folder.run("run experiment.toml --out results").succeeded();
    folder
}

fn track(folder: &Folder, recordings: &[&str], out: &str) -> (i32, serde_json::Value) {
    let run = folder.aurt(START.iter().chain(&["--out", out]).chain(recordings));
    assert!(run.status() < 2, "{}", run.stderr());
    (run.status(), folder.json(&format!("{out}/track.json")))
}

fn drift<'a>(found: &'a serde_json::Value, recording: usize, name: &str) -> &'a serde_json::Value {
    let parameters = found["parameters"].as_array().unwrap();
    let k = parameters.iter().position(|p| p["name"] == name).unwrap();
    &found["recordings"][recording]["drift"][k]
}

/// The demo's later recordings carry 2 kg; the charts say that it is the load and since when.
#[test]
fn a_load_is_noticed_and_an_unchanged_machine_is_not() {
    let folder = calibrated();
    let (status, found) = track(&folder, &["other_motion.csv", "exciting_motion.csv"], "unchanged");
    assert_eq!((status, found["alarms"].as_array().map(Vec::len)), (0, Some(0)), "{found}");
    let (status, found) = track(&folder, &["other_motion.csv", LATER[0], LATER[1]], "loaded");
    assert_eq!(status, 1);
    let alarm = found["alarms"].as_array().unwrap().iter().find(|a| a["group"] == "load").unwrap();
    assert_eq!((&alarm["since_recording"], &alarm["rose"]), (&LATER[0].into(), &true.into()), "{alarm}");
    let mass = drift(&found, 1, "payload.m_5");
    assert!((mass["value"].as_f64().unwrap() - 2.0).abs() < 0.2, "{mass}");
    let page = folder.read("loaded/report.html");
    assert!(page.contains("the load on the last link rose") && page.contains("<svg"));
}

/// A model of another geometry or gravity would hide a load in its wrong lengths.
#[test]
fn a_model_of_another_robot_is_refused() {
    let folder = calibrated();
    let (table, text) = (folder.read("mdh.csv"), folder.read("experiment.toml"));
    let refused = |words: &[&str]| {
        folder.aurt(START.iter().chain(&["--out", "out", LATER[0]])).refused(words);
        let diagnose =
            ["diagnose", "experiment.toml", "--model", "results/rd_calibrated.json", "--out", "out"];
        folder.aurt(diagnose).refused(words);
    };
    folder.edit("mdh.csv", |table| table.replace("0.6127", "0.7127"));
    refused(&["--model", "of another robot", "a (m) of joint 2 is -0.6127 and -0.7127"]);
    folder.write("mdh.csv", &table);
    folder.write("experiment.toml", &text.replace("[0.0, 0.0, -9.81]", "[0.0, -9.81, 0.0]"));
    refused(&["of another robot", "gravity is", "-9.81, 0.0] m/s²"]);
    // Currents are other torques with other torque constants.
    folder.write("experiment.toml", &text);
    folder.edit("experiment.toml", |text| text.replace("nm_per_a = [11.976", "nm_per_a = [13.0"));
    refused(&["--model", "was made with the torque constants 11.976", "the experiment has 13"]);
}

/// A recording that the model was calibrated on is refused as held out, under another name as well.
#[test]
fn a_given_model_is_not_judged_by_its_own_recordings() {
    let folder = calibrated();
    folder.write("renamed.csv", &folder.read("exciting_motion.csv"));
    let text = folder.read("experiment.toml");
    for part in ["validation", "target"] {
        let held_out = text.replace("[\"exciting_motion.csv\"]", "[\"other_motion.csv\"]").replace(
            "validation = [\"other_motion.csv\", \"point_to_point.csv\"]",
            &format!("{part} = [\"renamed.csv\"]"),
        );
        assert!(held_out.contains(&format!("{part} = [\"renamed.csv\"]")), "{held_out}");
        folder.write("asked.toml", &held_out);
        let diagnose = ["diagnose", "asked.toml", "--model", "results/rd_calibrated.json", "--out", "out"];
        folder.aurt(diagnose).refused(&[
            "renamed.csv",
            part,
            "exciting_motion.csv (calibration of the given model)",
            "not held-out",
        ]);
    }
}

/// Robots of a list, followed one by one and by their numbers, and one table of them.
#[test]
fn a_fleet_is_followed_robot_by_robot() {
    let folder = calibrated();
    let line =
        |name: &str, model: &str, recording: &str| format!("{name},experiment.toml,{model},{recording}\n");
    let model = "results/rd_calibrated.json";
    let list = "name,experiment,model,recordings\n".to_owned()
        + &line("still", model, "other_motion.csv")
        + &line("loaded", model, LATER[0]);
    folder.write("robots.csv", &list);
    folder.write("broken.csv", &(list + &line("broken", "none.json", "other_motion.csv")));
    let fleet = |list: &str, arguments: &[&str]| {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/../scripts/fleet.py");
        let run = Command::new("python3")
            .args([script, list, "--out", "fleet", "--aurt", env!("CARGO_BIN_EXE_aurt")])
            .args(arguments)
            .current_dir(folder.path("."))
            .output();
        run.ok().map(|run| (run.status.code(), String::from_utf8(run.stdout).unwrap()))
    };
    let Some(first) = fleet("robots.csv", &["--index", "1"]) else {
        println!("skipped: there is no python3 for fleets");
        return;
    };
    assert_eq!(first, (Some(0), String::new()));
    let (status, table) = fleet("robots.csv", &["--table"]).unwrap();
    assert_eq!(status, Some(2), "one robot has no result yet: {table}");
    let (status, table) = fleet("robots.csv", &[]).unwrap();
    assert_eq!(status, Some(1), "{table}");
    let of = |name: &str| table.lines().find(|line| line.starts_with(name)).unwrap();
    assert!(of("loaded").contains("payload.m_5 rose") && !of("still").contains("rose"), "{table}");
    assert_eq!(folder.read("fleet/fleet.csv").lines().count(), 3);
    assert_eq!(fleet("broken.csv", &[]).unwrap().0, Some(2));
    assert_eq!(fleet("nothing.csv", &[]).unwrap().0, Some(2));
    assert_eq!(fleet("robots.csv", &["--index", "2"]).unwrap().0, Some(2));
}

/// Of two unchanged motions a single parameter says little of how much motions differ; all together say enough for 2 kg.
#[test]
fn two_unchanged_recordings_are_enough_to_notice_a_load() {
    let folder = Folder::new().with_whole_demo().with_demo(&LATER);
    folder.edit("experiment.toml", |text| text.replace(", \"point_to_point.csv\"", ""));
    folder.run("run experiment.toml --out results").succeeded();
    let (status, found) = track(&folder, &["other_motion.csv", "point_to_point.csv"], "unchanged");
    assert_eq!((status, found["alarms"].as_array().map(Vec::len)), (0, Some(0)), "{found}");
    let (status, found) = track(&folder, &["other_motion.csv", LATER[0]], "loaded");
    assert_eq!(status, 1);
    let alarm = &found["alarms"][0];
    assert_eq!((&alarm["group"], &alarm["since_recording"]), (&"load".into(), &LATER[0].into()), "{alarm}");
}

#[test]
fn what_cannot_be_tracked_is_refused() {
    let folder = calibrated();
    std::fs::create_dir(folder.path("empty")).unwrap();
    let refused = |arguments: &[&str], words: &[&str]| {
        folder.aurt(START[..4].iter().chain(&["--out", "out"]).chain(arguments)).refused(words);
    };
    refused(&["empty"], &["empty", "holds no recording"]);
    refused(&["nowhere.csv"], &["nowhere.csv"]);
    refused(&["-", "-"], &["standard input is named twice"]);
    refused(&["other_motion.csv", "--window-s", "15"], &["whole windows", "--window-s"]);
    assert!(!folder.names().contains(&"out".to_owned()));
}

/// Without forgetting the tracked estimate after one recording is the recording's own.
#[test]
fn nothing_forgotten_is_the_estimate_of_the_batch() {
    let folder = calibrated();
    let endless =
        ["--friction-half-life-s", "1e15", "--gain-half-life-s", "1e15", "--load-half-life-s", "1e15"];
    let recordings = ["other_motion.csv"];
    let (_, found) = track(&folder, &[&endless[..], &recordings].concat(), "endless");
    let of = |what: &str, k: usize| found["recordings"][0][what][k]["value"].as_f64().unwrap();
    let count = found["parameters"].as_array().unwrap().len();
    assert_eq!(count, 16);
    for k in 0..count {
        let (batch, tracked) = (of("drift", k), of("tracked", k));
        assert!((batch - tracked).abs() <= 1e-9 * batch.abs().max(1e-3), "{k}: {batch} {tracked}");
    }
}

/// Rows of recordings, one after the other, each `gap_s` after the last.
fn stream(folder: &Folder, recordings: &[&str], gap_s: f64) -> Vec<String> {
    let mut lines = Vec::new();
    let mut offset_s = 0.0;
    for recording in recordings {
        let text = folder.read(recording);
        let mut rows = text.lines();
        let header = rows.next().unwrap().to_owned();
        if lines.is_empty() {
            lines.push(header);
        }
        let mut end_s = 0.0;
        for row in rows {
            let (stamp, cells) = row.split_once(',').unwrap();
            end_s = offset_s + stamp.parse::<f64>().unwrap();
            lines.push(format!("{end_s:.4},{cells}"));
        }
        offset_s = end_s + gap_s;
    }
    lines
}

fn fed(folder: &Folder, lines: &[String], out: &str) -> crate::support::Run {
    folder.aurt_fed(lines.join("\n") + "\n", START.iter().chain(&["--out", out, "-"]))
}

#[test]
fn rows_as_they_come_tell_what_files_tell() {
    let folder = calibrated();
    let mut lines = stream(&folder, &["other_motion.csv", LATER[0]], 30.0);
    // A sensor fails for two rows, a row comes late.
    for line in [300, 301] {
        let (rest, _) = lines[line].rsplit_once(',').unwrap();
        lines[line] = format!("{rest},NaN");
    }
    lines.swap(700, 704);
    let run = fed(&folder, &lines, "running").found();
    assert!(run.stderr().contains("alarm: the load on the last link rose"), "{}", run.stderr());
    let found = folder.json("running/track.json");
    let alarm = &found["alarms"][0];
    let since_s = alarm["since_s"].as_f64().unwrap();
    assert!(alarm["group"] == "load" && (since_s - 40.0).abs() < 3.0, "{alarm}");
    let notes = found["notes"].to_string();
    assert_has(&notes, &["time jumped 1 times, over 30.0 s", "no finite number", "goes back"]);
    // With as much rest between as the filters need, windows are nearly those of the file.
    let lines = stream(&folder, &[LATER[0]], 0.0);
    assert_eq!(fed(&folder, &lines, "alone").status(), 1);
    let (_, file) = track(&folder, &LATER[..1], "file");
    let mass = |found: &serde_json::Value| drift(found, 0, "payload.m_5")["value"].as_f64().unwrap();
    let (rows, file) = (mass(&folder.json("alone/track.json")), mass(&file));
    assert!((rows - file).abs() < 0.02, "{rows} {file}");
}

#[test]
fn a_stream_that_fails_is_refused() {
    let folder = calibrated();
    let good = stream(&folder, &["other_motion.csv", "exciting_motion.csv"], 0.008);
    let refused = |lines: &[String], words: &[&str]| {
        fed(&folder, lines, "out").refused(words);
    };
    let mut nan = good.clone();
    for line in nan.iter_mut().skip(1).step_by(20) {
        let (rest, _) = line.rsplit_once(',').unwrap();
        *line = format!("{rest},nan");
    }
    refused(&nan, &["standard input, line 2", "no finite number", "at most"]);
    let mut back = good.clone();
    let again: Vec<String> = good[1..400].to_vec();
    back.extend(again);
    refused(&back, &["standard input", "time goes back"]);
    refused(&good[..1], &["standard input", "no row follows"]);
    refused(&[], &["standard input"]);
    assert!(!folder.names().contains(&"out".to_owned()));
}

/// A logger that doubles its rate does not look like a change of the machine.
#[test]
fn a_change_of_rate_is_told_and_no_alarm() {
    let folder = calibrated();
    let lines = stream(&folder, &["other_motion.csv", "exciting_motion.csv"], 20.0);
    let (slow, fast) = lines[1..].split_at(1251);
    let thinned = slow.iter().step_by(2).chain(fast);
    let lines: Vec<String> = lines[..1].iter().chain(thinned).cloned().collect();
    let run = fed(&folder, &lines, "rates");
    assert_eq!(run.status(), 0, "{}", run.stderr());
    let notes = folder.json("rates/track.json")["notes"].to_string();
    assert!(notes.contains("from 62 Hz to 125 Hz") || notes.contains("from 63 Hz to 125 Hz"), "{notes}");
}

/// The demo's robot with more friction in joint 4, as another logger recorded it.
const RUBBING: &str = include_str!("files/rubbing.toml");

#[test]
fn friction_that_grows_is_named_with_its_joint_and_size() {
    let folder = calibrated();
    folder.write("scenario.toml", RUBBING);
    folder.run("simulate --scenario scenario.toml --out rubbing.csv").succeeded();
    let (status, found) = track(&folder, &["other_motion.csv", "rubbing.csv"], "rubbing");
    assert_eq!(status, 1);
    let alarms = found["alarms"].as_array().unwrap();
    assert_eq!(alarms[0]["parameter"], "friction_4", "{alarms:?}");
    let grown = drift(&found, 1, "friction_4");
    let ends: Vec<f64> = crate::support::numbers(&grown["interval_95"]);
    assert!(ends[0] < 0.5 && 0.5 < ends[1] && ends[0] > 0.2, "{grown}");
}

/// Nine minutes of one motion that the reference lacks, cut by the clock into minutes with gaps, is one motion; the same minutes
/// with stamps that begin anew would each count as a motion of their own that errs alike.
#[test]
fn a_motion_that_the_clock_cuts_into_files_is_one_motion() {
    let folder = Folder::new().with_whole_demo();
    let simulated = |seed: u32, duration_s: f64, file: &str| {
        let motion = format!(
            "kind = 'multi_sine'\nduration_s = {duration_s}\nharmonics = 8\ntop_hz = 1.0\nshare = 0.6\n"
        );
        folder.write(
            "s.toml",
            &format!("robot = 'ur10e'\nseed = {seed}\n[motion]\n{motion}[logger]\nrate_hz = 125\n"),
        );
        folder.run(format!("simulate --scenario s.toml --out {file} --quiet")).succeeded();
    };
    for (seed, file) in
        [(1001, "exciting_motion.csv"), (1002, "other_motion.csv"), (1003, "point_to_point.csv")]
    {
        simulated(seed, 120.0, file);
    }
    folder.edit("experiment.toml", |text| text.replace("model = \"absolute\"", "model = \"constant\""));
    folder.run("run experiment.toml --out results --quiet").succeeded();
    simulated(1014, 600.0, "whole.csv");
    let whole = folder.read("whole.csv");
    let (header, rows) = whole.split_once('\n').unwrap();
    let pieces = |of: &str, origin_s: f64| -> Vec<String> {
        let mut names = Vec::new();
        for from_s in (0..9).map(|k| 3.0 + 60.0 * f64::from(k)) {
            let mut piece = header.to_owned();
            for row in rows.lines() {
                let (stamp, cells) = row.split_once(',').unwrap();
                let at_s = stamp.parse::<f64>().unwrap() - from_s;
                if (0.0..60.0).contains(&at_s) && !(20.0..21.0).contains(&at_s) {
                    piece.push_str(&format!("\n{:.4},{cells}", at_s + origin_s * from_s));
                }
            }
            names.push(format!("{of}_{from_s}.csv"));
            folder.write(&names[names.len() - 1], &piece);
        }
        names
    };
    let alarms = |of: &str, origin_s: f64| {
        let names = pieces(of, origin_s);
        let arguments =
            [&["--false-alarm-h", "2"][..], &names.iter().map(String::as_str).collect::<Vec<_>>()].concat();
        let start: Vec<&str> = START[..4].iter().chain(&["--out", of]).chain(&arguments).copied().collect();
        assert!(folder.aurt(start).status() < 2);
        folder.json(&format!("{of}/track.json"))["alarms"].as_array().unwrap().len()
    };
    assert_eq!(alarms("continued", 1.0), 0);
    assert!(alarms("anew", 0.0) > 0);
}
