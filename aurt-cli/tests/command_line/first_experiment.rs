//! `aurt init`: an experiment from a robot and its logs.

use crate::support::{Folder, assert_has, one_line, with_cells};

const LOGS: [&str; 2] = ["exciting_motion.csv", "other_motion.csv"];
const CONSTANTS: [&str; 7] =
    ["--torque-constants", "11.976", "11.976", "9.839", "10.763", "10.763", "10.763"];

fn demo() -> Folder {
    Folder::new().with_demo(&["mdh.csv", LOGS[0], LOGS[1]])
}

/// The arguments of `aurt init` for the demo's table and these recordings.
fn init<'a>(recordings: &'a [&'a str], more: &'a [&'a str]) -> impl Iterator<Item = &'a str> {
    let recordings = recordings.iter().copied();
    std::iter::once("init").chain(recordings).chain(["--robot", "mdh.csv"]).chain(more.iter().copied())
}

#[test]
fn a_robot_and_its_logs_become_an_experiment_that_runs() {
    let folder = demo();
    // One of the files is given twice under another name.
    folder.write("again.csv", &folder.read(LOGS[0]));
    let said = folder.aurt(init(&[LOGS[0], LOGS[1], "again.csv"], &CONSTANTS)).succeeded().stdout();
    assert!(said.contains("again.csv holds the same samples as exciting_motion.csv"), "{said}");
    assert!(said.contains("no common mistake explains more"), "{said}");
    let text = folder.read("experiment.toml");
    assert!(text.starts_with("schema = 1"), "{text}");
    assert_has(&text, &["mdh_rows = \"next\"      # guessed", "9.81]      # guessed"]);
    assert_has(&text, &["torque_constants_nm_per_a = [11.976"]);
    let roles = text.split_once("[recordings]").unwrap().1.split_once("validation").unwrap();
    assert!(roles.0.contains(LOGS[0]) && roles.1.contains(LOGS[1]), "what moves more calibrates: {text}");
    assert!(!text.contains("again.csv"), "{text}");
    folder.run("run experiment.toml --out out").succeeded();
    folder.aurt(init(&LOGS, &[])).refused(&["experiment.toml exists", "experiments are not overwritten"]);
}

#[test]
fn targets_and_held_out_recordings_are_named() {
    let folder = Folder::new().with_demo(&["mdh.csv", LOGS[0], LOGS[1], "later_motion.csv"]);
    let more = [&CONSTANTS[..], &["--target", "later_motion.csv", "--validation", LOGS[1]]].concat();
    let said = folder.aurt(init(&[LOGS[0]], &more)).succeeded().stdout();
    assert!(said.contains("aurt diagnose experiment.toml") && !said.contains("held out"), "{said}");
    let text = folder.read("experiment.toml");
    let (calibration, rest) = text.split_once("[recordings]").unwrap().1.split_once("target = [").unwrap();
    let (target, validation) = rest.split_once("validation = [").unwrap();
    assert!(calibration.contains(LOGS[0]) && target.contains("later_motion.csv"), "{text}");
    assert!(validation.contains(LOGS[1]), "{text}");
    assert!(!text.contains("window_s"), "{text}");
}

/// A recording of the robot as it was says nothing of what has changed.
#[test]
fn beside_targets_no_recording_of_the_unchanged_robot_is_held_out() {
    let folder = Folder::new().with_demo(&["mdh.csv", LOGS[0], LOGS[1], "later_motion.csv"]);
    let more = [&CONSTANTS[..], &["--target", "later_motion.csv"]].concat();
    let said = one_line(&folder.aurt(init(&LOGS, &more)).succeeded().stdout());
    assert!(said.contains("the diagnosis holds out the last quarter of each target"), "{said}");
    let text = folder.read("experiment.toml");
    let (calibration, _) = text.split_once("target = [").unwrap();
    assert!(LOGS.iter().all(|log| calibration.contains(log)) && !text.contains("validation"), "{text}");
}

/// `init` prints the error of the experiment that it writes, which has no rotors; its search for mistakes adds them.
#[test]
fn the_printed_error_is_that_of_the_experiment() {
    let folder = demo();
    let said = one_line(&folder.aurt(init(&LOGS, &CONSTANTS)).succeeded().stdout());
    std::fs::remove_file(folder.path("experiment.toml")).unwrap();
    let json = folder.aurt(init(&LOGS, &[&CONSTANTS[..], &["--json"]].concat())).succeeded().json();
    let [written, tried] = ["written", "before"].map(|key| json["setup"][key]["joints"].clone());
    let percents = |joints: &serde_json::Value| {
        let percent = |e: &serde_json::Value| {
            let percent = 100.0 * e.as_f64().unwrap();
            if percent < 9.95 { format!("{percent:.1} %") } else { format!("{percent:.0} %") }
        };
        joints.as_array().unwrap().iter().map(percent).collect::<Vec<_>>().join(", ")
    };
    assert_ne!(percents(&written), percents(&tried), "the demo's robot has rotors");
    assert!(said.contains(&format!("joint by joint: {}", percents(&written))), "{said}");
}

/// Currents stay currents, and nothing is claimed of a right setup.
#[test]
fn currents_without_constants_accuse_no_robot() {
    let folder = demo();
    let said = one_line(&folder.aurt(init(&LOGS, &[])).succeeded().stdout());
    assert_has(&said, &["to detect wrong zeros and geometries, torque constants are needed"]);
    assert_has(&folder.read("experiment.toml"), &["# Currents stay in A"]);
}

/// What a key can say is set; the experiment then runs.
#[test]
fn a_mistake_that_the_recordings_show_is_corrected_in_the_file() {
    let wrong_setups: [(&[&str], &str); 3] = [
        (&["--mdh-rows", "previous"], "mdh_rows = \"next\""),
        (&["--gravity", "0", "9.81", "0"], "gravity_m_s2 = [0.0, 0.0, -9.81]"),
        // Turning joint 1 half a turn would do nearly the same.
        (&["--gravity", "0", "0", "9.81"], "gravity_m_s2 = [0.0, 0.0, -9.81]"),
    ];
    for (wrong, right) in wrong_setups {
        corrected(&demo(), wrong, right);
    }
    let wrong_logs: [(&str, f64, &str); 3] = [
        ("actual_q_", 180.0 / std::f64::consts::PI, "angle = \"deg\""),
        ("actual_current_1", -1.0, "gains = [1.0, -1.0, 1.0, 1.0, 1.0, 1.0]"),
        ("actual_q_2", -1.0, "gear_ratio = [1.0, 1.0, -1.0, 1.0, 1.0, 1.0]"),
    ];
    for (columns, factor, right) in wrong_logs {
        let folder = demo();
        for log in LOGS {
            folder.edit(log, |table| scaled(table, columns, factor));
        }
        corrected(&folder, &[], right);
    }
}

/// Asserts that the draft has `right` in it, says so, and runs.
fn corrected(folder: &Folder, wrong: &[&str], right: &str) {
    let more: Vec<&str> = CONSTANTS.iter().chain(wrong).copied().collect();
    let said = folder.aurt(init(&LOGS, &more)).succeeded().stdout();
    let text = folder.read("experiment.toml");
    let head = "# The recordings said otherwise than the first guess.";
    assert!(text.starts_with(head) && text.contains(right), "{right}: {said}\n{text}");
    folder.run("run experiment.toml --out out").succeeded();
}

/// A table with the columns whose names begin so multiplied.
fn scaled(table: &str, columns: &str, factor: f64) -> String {
    let names: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let scaled = |cell: &str| (factor * cell.parse::<f64>().unwrap()).to_string();
    with_cells(table, |_, column, cell| names[column].starts_with(columns).then(|| scaled(cell)))
}

/// `aurt check` writes what it would change beside the experiment, whose comments stay.
#[test]
fn an_experiment_is_corrected_beside_itself() {
    let folder = Folder::new().with_whole_demo();
    let wrong = folder.read("experiment.toml").replace("[0.0, 0.0, -9.81]", "[0.0, 9.81, 0.0]");
    folder.write("experiment.toml", &wrong);
    folder.run("check experiment.toml --fixed corrected.toml").found();
    assert_eq!(folder.read("corrected.toml"), wrong.replace("[0.0, 9.81, 0.0]", "[0.0, 0.0, -9.81]"));
    assert_eq!(folder.read("experiment.toml"), wrong);
}

/// A single recording calibrates with its beginning and validates with its end.
#[test]
fn one_recording_is_split() {
    let folder = demo();
    let said = folder.aurt(init(&LOGS[..1], &CONSTANTS)).succeeded().stdout();
    assert!(said.contains("its beginning calibrates, its end validates"), "{said}");
    let text = folder.read("experiment.toml");
    assert_eq!(text.matches("window_s = [").count(), 2, "{text}");
    folder.run("run experiment.toml --out out").succeeded();
}

#[test]
fn a_robot_that_is_not_there_is_refused() {
    let folder = demo();
    folder.aurt(["init", LOGS[0], "--robot", "ur10"]).refused(&["--robot", "did you mean ur10e?"]);
    folder.aurt(["init", LOGS[0]]).refused(&["--robot", "the robot is not given"]);
    assert!(!folder.path("experiment.toml").exists());
}

/// Without a tip all joints on the base are taken, by name, in whatever order the log has them.
#[test]
fn a_tree_without_a_tip_is_taken_whole() {
    let folder = Folder::new();
    let arm = |side: &str, y: f64| {
        format!(
            "<link name=\"{side}\"><inertial><origin xyz=\"0.3 0 0\"/><mass value=\"1\"/><inertia ixx=\"0.1\" iyy=\"0.1\" \
             izz=\"0.1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link><joint name=\"{side}_joint\" \
             type=\"continuous\"><origin xyz=\"0 {y} 0\"/><parent link=\"base\"/><child link=\"{side}\"/><axis xyz=\"0 1 0\"/></joint>"
        )
    };
    let urdf = format!(
        "<robot name=\"two\"><link name=\"base\"/>{}{}</robot>",
        arm("left", 0.2),
        arm("right", -0.2)
    );
    folder.write("two.urdf", &urdf);
    let names = "time,right_joint.position,left_joint.position,right_joint.effort,left_joint.effort\n";
    let row = |k: u32| {
        let t = f64::from(k) * 0.01;
        // With 0.19 kg m² about the joint and 2.943 Nm at a level arm.
        let of = |w: f64| {
            let q = (w * t).sin();
            (q, -0.19 * w * w * q - 2.943 * q.cos() + 0.1 * (w * t).cos().signum())
        };
        let ((left, left_nm), (right, right_nm)) = (of(3.0), of(4.1));
        format!("{t},{right},{left},{right_nm},{left_nm}\n")
    };
    folder.write("log.csv", &(names.to_owned() + &(0..3000).map(row).collect::<String>()));
    let said = folder.run("init log.csv --robot two.urdf").succeeded().stdout();
    assert!(said.contains("base first: left_joint, right_joint"), "{said}");
    let text = folder.read("experiment.toml");
    assert!(text.contains("urdf = \"two.urdf\"\ngravity"), "{text}");
    folder.run("run experiment.toml --out out").succeeded();
    let chain = ["init", "log.csv", "--robot", "two.urdf", "--tip", "right", "--out", "right.toml"];
    folder.aurt(chain).succeeded();
    assert!(folder.read("right.toml").contains("tip = \"right\""));
}

#[test]
fn a_recording_of_one_arm_of_two_says_which_joints_are_missing() {
    let folder = Folder::new();
    let mut text = "<robot name=\"two\"><link name=\"torso\"/>\n".to_owned();
    for side in ["left", "right"] {
        for k in 0..2 {
            let parent = if k == 0 { "torso".to_owned() } else { format!("{side}_l{}", k - 1) };
            text += &format!(
                "<link name=\"{side}_l{k}\"><inertial><origin xyz=\"0.2 0 0\"/><mass value=\"2\"/><inertia ixx=\"0.02\" \
                 ixy=\"0\" ixz=\"0\" iyy=\"0.02\" iyz=\"0\" izz=\"0.02\"/></inertial></link>\n<joint name=\"{side}_s{k}\" \
                 type=\"revolute\"><parent link=\"{parent}\"/><child link=\"{side}_l{k}\"/><origin xyz=\"0.4 0 0\"/><axis \
                 xyz=\"0 1 0\"/></joint>\n"
            );
        }
    }
    folder.write("two.urdf", &(text + "</robot>"));
    let mut rows = "time,left_s0.position,left_s1.position,left_s0.effort,left_s1.effort\n".to_owned();
    for k in 0..2000 {
        let t = f64::from(k) * 0.01;
        let (a, b) = ((1.3 * t).sin(), 0.8 * (0.9 * t).cos() + 0.3 * (2.1 * t).sin());
        rows += &format!(
            "{t:.3},{a:.6},{b:.6},{:.4},{:.4}\n",
            9.0 * a.cos() + 4.0 * (a + b).cos(),
            4.0 * (a + b).cos()
        );
    }
    folder.write("left.csv", &rows);
    let start = ["init", "left.csv", "--robot", "two.urdf"];
    folder.aurt(start).refused(&[
        "`right_s0`, `right_s1` are none",
        "left_s0, left_s1",
        "a part of the robot",
        "--tips",
    ]);
    folder.aurt(start.iter().chain(&["--tips", "nose"])).refused(&["there is no link `nose`", "--tips"]);
    folder.aurt(start.iter().chain(&["--tip", "left_l1"])).succeeded();
    assert!(folder.read("experiment.toml").contains("tip = \"left_l1\""));
    // Several tips are a tree.
    folder.write(
        "both.csv",
        &rows.replacen("left_s1.position", "right_s0.position", 1).replacen("left_s1", "right_s0", 1),
    );
    let both =
        ["init", "both.csv", "--robot", "two.urdf", "--tips", "right_l0,left_l0", "--out", "both.toml"];
    folder.aurt(both).succeeded();
    let text = folder.read("both.toml");
    assert!(text.contains("tips = [\"right_l0\", \"left_l0\"]"), "{text}");
}
