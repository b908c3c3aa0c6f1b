//! `aurt simulate`, `aurt excite` and the demo's concealed load.

use std::f64::consts::PI;

use crate::support::{DEMO, Folder, assert_has, numbers, rows, with_table};

const SCENARIO: &str = include_str!("files/scenario.toml");

#[test]
fn the_demo_names_what_was_concealed() {
    let verdict = DEMO.json("demo/diagnosis/verdict.json");
    assert_eq!(verdict["effects"][0]["effect"], "payload", "{verdict}");
    assert_eq!(verdict["effects"][0]["present_in"], serde_json::json!(["target"]));
    let mass = verdict["effects"][0]["parameters"]["mass_kg"]["value"].as_f64().unwrap();
    assert!((mass / 2.0 - 1.0).abs() < 0.05, "{mass} kg of 2");
}

#[test]
fn a_scenario_becomes_a_recording_the_same_each_time() {
    let folder = Folder::new();
    let effect = "\n[[effect]]\nname = \"current_offset\"\njoints = [2]\noffset_nm = [8.0]\n";
    folder.write("plain.toml", SCENARIO);
    folder.write("offset.toml", &format!("{SCENARIO}{effect}"));
    for (scenario, out) in [("plain", "a"), ("plain", "b"), ("offset", "c")] {
        let line = format!("simulate --scenario {scenario}.toml --out {out}.csv");
        folder.run(line).succeeded();
    }
    assert_eq!(folder.read("a.csv"), folder.read("b.csv"));
    assert_ne!(folder.read("a.csv"), folder.read("c.csv"));
    let text = folder.read("a.csv");
    assert!(text.starts_with("timestamp,actual_q_0,"), "{}", &text[..60]);
    assert_eq!(text.lines().count(), 402);
    folder.run("check a.csv").succeeded();
}

#[test]
fn absurd_scenarios_are_refused_with_a_reason() {
    let folder = Folder::new();
    let refused = |change: &dyn Fn(&str) -> String, words: &[&str]| {
        folder.write("absurd.toml", &change(SCENARIO));
        folder.run("simulate --scenario absurd.toml --out x.csv").refused(words);
    };
    let with = |more: &'static str| move |text: &str| format!("{text}{more}");
    refused(&with("[[link]]\nindex = 2\nmass_kg = -1.0\n"), &["link 2", "positive"]);
    refused(&with("[[link]]\nindex = 9\nmass_kg = 1.0\n"), &["link 9", "6"]);
    refused(
        &with("[[effect]]\nname = \"current_offset\"\njoints = [9]\noffset_nm = [1.0]\n"),
        &["current_offset", "joint 9", "6"],
    );
    refused(&with("[[effect]]\nname = \"stribek\"\n"), &["stribek", "did you mean `stribeck`"]);
    refused(&with("[[drive]]\njoint = 1\ntorque_noise_nm = -0.5\n"), &["torque noise of joint 1", "-0.5"]);
    refused(&with("[[drive]]\njoint = 1\nencoder_noise_rad = -1e-6\n"), &["encoder noise of joint 1"]);
    refused(&|text| text.replace("rate_hz = 100", "rate_hz = 0"), &["rate of the logger", "0"]);
    refused(&|text| text.replace("duration_s = 4.0", "duration_s = -4.0"), &["duration"]);
    refused(&|text| text.replace("share = 0.5", "share = 1.5"), &["share of the limits"]);
    refused(&|text| text.replace("ur10e", "ur11"), &["unknown robot `ur11`", "ur10e"]);
    refused(&|text| text.replace("seed = 7", "sead = 7"), &["sead"]);
    let fast = "kind = \"triangles\"\nduration_s = 10.0\nspeed_rad_s = 9.0\namplitude_rad = 1.0\n";
    refused(
        &|text| with_table(text, "[motion]", &format!("[motion]\n{fast}")),
        &["trajectory asks joint", "velocity", "limit"],
    );
}

#[test]
fn a_calibrated_model_follows_a_motion_and_is_driven_by_what_was_measured() {
    let folder = Folder::new().with_demo(&["rd_calibrated.json", "other_motion.csv"]);
    let run = folder
        .run("simulate --model rd_calibrated.json --motion other_motion.csv --out moved.csv --json")
        .succeeded();
    let report = run.json();
    let away = numbers(&report["largest_distance_rad"]);
    assert!(away.iter().all(|d| *d < 5e-3), "{away:?}");
    let moved = folder.read("moved.csv");
    assert!(moved.starts_with("time,q_0,q_1,"), "{}", &moved[..40]);
    assert_eq!(moved.lines().nth(1).unwrap().split(',').count(), 1 + 3 * 6);

    // What it needed for that is what the recording measured, up to noise and model errors.
    let predicted =
        folder.run("simulate --model rd_calibrated.json --torques other_motion.csv --out driven.csv");
    let said = predicted.succeeded().stdout();
    assert!(said.contains("without controller"), "{said}");
}

#[test]
fn a_model_needs_something_that_moves_it() {
    let folder = Folder::new().with_demo(&["rd_calibrated.json", "mdh.csv"]);
    let run = |line: &str| folder.run(line);
    run("simulate --model rd_calibrated.json --out x.csv").refused(&["--motion", "--torques"]);
    run("simulate --out x.csv").refused(&["--model", "--scenario"]);
    run("simulate --model rd_calibrated.json --motion mdh.csv --out x.csv").refused(&["mdh.csv"]);
}

#[test]
fn excitation_is_optimised_within_limits() {
    let folder = Folder::new().with_demo(&["mdh.csv"]);
    folder.write(
        "limits.csv",
        &format!(
            "lower_rad,upper_rad,velocity_rad_s,acceleration_rad_s2\n{}",
            "-2.0,2.0,1.5,4.0\n".repeat(6)
        ),
    );
    let line =
        "excite --mdh mdh.csv --gravity 0 0 -9.81 --limits limits.csv --duration-s 12 --tries 60 --seed 3";
    let run = folder.run(format!("{line} --out motion.csv --json")).succeeded();
    let report = run.json();
    let [first, best] =
        ["first_condition_number", "condition_number"].map(|key| report[key].as_f64().unwrap());
    assert!(best < first && best > 1.0, "{best} {first}");
    folder.run(format!("{line} --out again.csv")).succeeded();
    let motion = folder.read("motion.csv");
    assert_eq!(motion, folder.read("again.csv"));
    for row in rows(&motion) {
        assert!(row[1..7].iter().all(|q| q.abs() <= 2.0), "{row:?}");
        assert!(row[7..13].iter().all(|v| v.abs() <= 1.5), "{row:?}");
        assert!(row[13..].iter().all(|a| a.abs() <= 4.0), "{row:?}");
    }
    for kind in ["multi-sine", "point-to-point", "triangles", "sweeps"] {
        let line = format!("excite --robot panda --kind {kind} --seed 1 --out {kind}.csv");
        folder.run(line).succeeded();
        assert_eq!(folder.read(&format!("{kind}.csv")).lines().count(), 2002);
    }
}

/// The motion of a robot description within the limits that it states, with those that it does not told.
#[test]
fn limits_of_a_description_are_those_of_the_motion() {
    let folder = Folder::new();
    folder.write("gantry.urdf", include_str!("../../../aurt-rbd/tests/descriptions/reference/gantry.urdf"));
    folder.write("arm.xml", include_str!("../../../aurt-rbd/tests/descriptions/reference/arm.xml"));
    let line = "excite --robot gantry.urdf --tip wrist --velocity-rad-s 2 --duration-s 8 --tries 20 --seed 1 --out m.csv";
    let run = folder.run(format!("{line} --json")).succeeded();
    let report = run.json();
    let notes = report["notes"].to_string();
    let parts =
        ["those of gantry.urdf", "velocity limit of elbow: 2, as given", "no range is stated of elbow"];
    assert_has(&notes, &[&parts[..], &["0.5 s"]].concat());
    let expected = [[-0.8, 1.2, 0.9], [-2.5, 2.5, 3.0], [-PI, PI, 2.0], [0.0, 0.25, 0.4]];
    let limits = report["limits"].as_array().unwrap();
    for (limits, [lower, upper, velocity]) in limits.iter().zip(expected) {
        assert_eq!((limits["lower_rad"].as_f64(), limits["upper_rad"].as_f64()), (Some(lower), Some(upper)));
        assert_eq!(limits["acceleration_rad_s2"].as_f64(), Some(2.0 * velocity));
    }
    for row in rows(&folder.read("m.csv")) {
        for (j, [lower, upper, velocity]) in expected.into_iter().enumerate() {
            assert!((lower..=upper).contains(&row[1 + j]) && row[5 + j].abs() <= velocity, "{row:?}");
            assert!(row[9 + j].abs() <= 2.0 * velocity, "{row:?}");
        }
    }
    let run = |line: &str| folder.run(format!("{line} --tries 5 --duration-s 8 --seed 1 --out x.csv"));
    let urdf = "excite --robot gantry.urdf";
    let tree = run(&format!("{urdf} --velocity-rad-s 2")).succeeded().stdout();
    assert!(tree.contains("the robot is a tree") && tree.contains("1 joints follow others"), "{tree}");
    run(&format!("{urdf} --tip wrist"))
        .refused(&["no velocity limit of the joints elbow", "--velocity-rad-s"]);
    run(&format!("{urdf} --tip wrist --velocity-rad-s=0")).refused(&["--velocity-rad-s", "0 is no limit"]);
    run(&format!("{urdf} --tip wrist --velocity-rad-s 1 --torque-limits"))
        .refused(&["--torque-limits", "masses"]);
    // Limits that are reversed or equal cannot be meant, whether a description writes one or both.
    let gantry = folder.read("gantry.urdf");
    for (limits, said) in [
        ("lower=\"0.2\" upper=\"-0.2\"", "shoulder (lower 0.2, upper -0.2)"),
        ("lower=\"0.2\" upper=\"0.2\"", "shoulder (lower 0.2, upper 0.2)"),
        ("lower=\"0.2\"", "shoulder (lower 0.2, upper 0)"),
    ] {
        folder.write("wrong.urdf", &gantry.replace("lower=\"-2.5\" upper=\"2.5\"", limits));
        run("excite --robot wrong.urdf --tip wrist --velocity-rad-s 2").refused(&[
            "wrong.urdf",
            said,
            "--limits",
        ]);
    }
    let (mut links, mut joints) = ("<link name=\"l0\"/>".to_owned(), String::new());
    for k in 1..=5000 {
        links += &format!("<link name=\"l{k}\"/>");
        joints += &format!(
            "<joint name=\"j{k}\" type=\"revolute\"><parent link=\"l{}\"/><child link=\"l{k}\"/></joint>\n",
            k - 1
        );
    }
    folder.write("chain.urdf", &format!("<robot name=\"chain\">{links}{joints}</robot>"));
    run("excite --robot chain.urdf --velocity-rad-s 2").refused(&[
        "chain.urdf",
        "5000 joints",
        "at most 128",
    ]);
    run("excite --robot arm.xml --tip nothing").refused(&["arm.xml", "nothing"]);
    run("excite --robot ur10e --tip wrist").refused(&["--tip", "`ur10e` is no file"]);
    // Robots known by name alone, and other limits than the description's.
    let known = run("excite --robot xarm6 --acceleration-rad-s2 5").succeeded().stdout();
    assert!(known.contains("those of xarm6") && known.contains("acceleration limit: 5"), "{known}");
    folder.write(
        "limits.csv",
        &format!("lower_rad,upper_rad,velocity_rad_s,acceleration_rad_s2\n{}", "0,0.2,0.3,1\n".repeat(4)),
    );
    let known = run(&format!("{urdf} --tip wrist --limits limits.csv")).succeeded().stdout();
    assert!(known.contains("those of limits.csv"), "{known}");
}

#[test]
fn absurd_excitation_is_refused() {
    let folder = Folder::new().with_demo(&["mdh.csv"]);
    folder.write("few.csv", "lower_rad,upper_rad,velocity_rad_s,acceleration_rad_s2\n-1,1,1,1\n");
    folder.write("none.csv", "lower_rad,upper_rad,velocity_rad_s,acceleration_rad_s2\n1,-1,1,1\n");
    let run = |line: &str| folder.run(format!("{line} --seed 1 --out x.csv"));
    run("excite --robot ur10e --rate-hz 0 --kind sweeps").refused(&["rate", "0"]);
    run("excite --robot ur10e --share 2").refused(&["share of the limits", "2"]);
    run("excite --robot ur10e --duration-s 0").refused(&["duration"]);
    run("excite --robot ur10e --kind triangles --speed-rad-s 9 --amplitude-rad 1").refused(&["limit"]);
    run("excite --robot nobody").refused(&["nobody", "ur10e"]);
    run("excite --mdh mdh.csv --limits few.csv").refused(&["few.csv", "1 joints", "6"]);
    run("excite --mdh mdh.csv --limits none.csv").refused(&["none.csv:2", "lower_rad"]);
}
