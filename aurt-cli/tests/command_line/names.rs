//! Joints by name: whatever order a bag has, every command that takes a recording does the same with it.

use aurt_recording::{JointTopic, ReadOptions, Recording, RobotJoints, mcap, read_recording};

use crate::support::{Folder, numbers, rows};

const IN_ORDER: [BagJoint; 2] = [("shoulder", Some(0)), ("elbow", Some(1))];

/// A joint of a bag: its name, and which of the arm's two joints it is; another one rests.
pub type BagJoint = (&'static str, Option<usize>);

fn write_bag(folder: &Folder, name: &str, recording: &Recording, joints: &[BagJoint]) {
    let rest = vec![0.0; recording.time_s.len()];
    let series = |family: &[Vec<f64>]| -> Vec<Vec<f64>> {
        joints.iter().map(|(_, joint)| joint.map_or(&rest, |j| &family[j]).clone()).collect()
    };
    let effort = series(recording.measurement.as_ref().unwrap());
    let topic = JointTopic {
        name: "/joint_states",
        position: &series(&recording.position_rad),
        velocity: &[],
        effort: &effort,
    };
    let path = folder.path(name);
    let names: Vec<String> = joints.iter().map(|(name, _)| (*name).to_owned()).collect();
    let bag = mcap(&path, &recording.time_s, 0.0, &names, &[topic], &[]).unwrap();
    std::fs::write(path, bag).unwrap();
}

/// Three recordings of the two-link arm as bags with these joints, and an experiment on them.
pub fn recorded(joints: &[BagJoint]) -> Folder {
    let folder = Folder::new();
    for (name, seed) in [("monday", 1), ("tuesday", 2), ("wednesday", 3)] {
        let scenario = format!(
            "robot = 'two_link'\nseed = {seed}\n[motion]\nkind = 'multi_sine'\nduration_s = 12.0\nharmonics = 5\n\
             top_hz = 0.8\nshare = 0.5\n[logger]\nrate_hz = 125\n"
        );
        folder.write("scenario.toml", &scenario);
        folder.run("simulate --scenario scenario.toml --out log.csv --quiet").succeeded();
        let recording = read_recording(&folder.path("log.csv"), &ReadOptions::default()).unwrap();
        write_bag(&folder, &format!("{name}.mcap"), &recording, joints);
    }
    folder.write("mdh.csv", &aurt::simulation::robots::two_link().mdh_csv());
    folder.write("experiment.toml", &experiment("joint_names = ['shoulder', 'elbow']", ""));
    folder
}

pub fn experiment(robot: &str, recordings: &str) -> String {
    format!(
        "schema = 1\n[robot]\nmdh = 'mdh.csv'\ngravity_m_s2 = [0.0, -9.81, 0.0]\n{robot}\n[recordings]\n{recordings}\n\
         calibration = [{{ file = 'monday.mcap', unit = 'A' }}]\n\
         validation = [{{ file = 'tuesday.mcap', unit = 'A' }}]\n[preprocess]\nf_dyn_hz = 5.0\n"
    )
}

fn apart(a: &str, b: &str) -> f64 {
    let [a, b] = [a, b].map(|table| rows(table).concat());
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// What every command that takes a recording makes of it.
fn results(folder: &Folder) -> Vec<(&'static str, String)> {
    for line in [
        "run experiment.toml --out results",
        "compile-rbd --mdh mdh.csv --joint-names shoulder,elbow --gravity 0 -9.81 0 --out rbd.json",
        "compile-rd --model-rbd rbd.json --experiment experiment.toml --out rd.json",
        "calibrate --model rd.json --data monday.mcap --topic /joint_states --unit A --out-params p.csv \
         --out-calibrated-model c.json",
        "predict --model MODEL --data tuesday.mcap --unit A --out predicted.csv",
        "simulate --model MODEL --motion tuesday.mcap --unit A --out moved.csv",
        "track experiment.toml --model MODEL --window-s 2 wednesday.mcap --out track",
        "diagnose experiment.toml --out diagnosis",
        "gains experiment.toml --expect --out gains",
        "init monday.mcap --robot mdh.csv --joint-names shoulder,elbow --unit A --gravity 0 -9.81 0 --out first.toml",
    ] {
        let run = folder.run(line.replace("MODEL", "results/rd_calibrated.json") + " --quiet");
        assert!(run.status() < 2, "{line}: {}", run.stderr());
    }
    // That effort is taken to be in A is a remark, no finding.
    let check = folder.run("check experiment.toml --json").succeeded().json();
    let only = |file: &str, key: &str| folder.json(file)[key].to_string();
    vec![
        ("run", folder.read("results/predicted_tuesday.csv")),
        ("calibrate", folder.read("p.csv")),
        ("predict", folder.read("predicted.csv")),
        ("simulate", folder.read("moved.csv")),
        ("track", only("track/track.json", "recordings")),
        ("diagnose", only("diagnosis/verdict.json", "residual")),
        ("gains", folder.read("gains/gains.json")),
        ("init", folder.read("first.toml")),
        ("check", check["recordings"].to_string()),
    ]
}

#[test]
fn the_order_of_a_bag_changes_nothing_in_any_command() {
    let expected = results(&recorded(&IN_ORDER));
    let [shoulder, elbow] = IN_ORDER;
    for joints in [&[elbow, shoulder][..], &[("gripper", None), elbow, shoulder]] {
        for ((command, found), (_, expected)) in results(&recorded(joints)).iter().zip(&expected) {
            assert!(found == expected, "{command} on {joints:?}:\n{found}\n{expected}");
        }
    }
}

/// Bags of a UR10e, in another order and with a gripper that moves, make the experiment of the bag in the robot's order.
#[test]
fn a_first_experiment_matches_the_joints_of_any_robot_by_name() {
    let folder = Folder::new().with_bag(&["ur10e.urdf", "monday.mcap"]);
    let names = ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint"];
    let names = names.into_iter().chain(["wrist_2_joint", "wrist_3_joint"]);
    let ordered: Vec<BagJoint> = names.enumerate().map(|(j, name)| (name, Some(j))).collect();
    let robot = RobotJoints {
        count: 6,
        names: ordered.iter().map(|(name, _)| (*name).into()).collect(),
        ..RobotJoints::default()
    };
    let recording = read_recording(&folder.path("monday.mcap"), &ReadOptions::default()).unwrap();
    let recording = recording.of_robot(&robot).unwrap();
    let others = [("gripper", Some(3))].into_iter().chain(ordered.iter().rev().copied()).collect::<Vec<_>>();
    let draft = |joints: &[BagJoint], robot: &[&str]| {
        write_bag(&folder, "log.mcap", &recording, joints);
        let init = ["init", "log.mcap", "--unit", "A", "--out", "draft.toml", "--robot"];
        let said = folder.aurt(init.iter().chain(robot)).succeeded().stdout();
        assert!(said.contains("base first: shoulder_pan_joint, shoulder_lift_joint,"), "{said}");
        let text = folder.read("draft.toml");
        std::fs::remove_file(folder.path("draft.toml")).unwrap();
        // The comments tell of the columns, which are others.
        let keys =
            |text: &str| text.lines().filter(|l| !l.trim().starts_with('#')).collect::<Vec<_>>().join("\n");
        let errors = said.split_once("joint by joint").unwrap().1.split_once('(').unwrap().0.to_owned();
        (keys(&text), errors)
    };
    let described = ["ur10e.urdf", "--base", "shoulder_link", "--tip", "wrist_3_link"];
    for robot in [&["ur10e.urdf", "--base", "base_link"][..], &["ur10e"]] {
        let (text, errors) = draft(&ordered, robot);
        assert!(text.contains("base = \"base_link\"") == robot.contains(&"--base"), "{text}");
        assert_eq!(draft(&others, robot), (text, errors));
    }
    let init = ["init", "log.mcap", "--unit", "A", "--robot"];
    folder.aurt(init.iter().chain(&described)).refused(&["`shoulder_link`", "shoulder_pan_link"]);
}

/// The paper's name of a constant level, which older model files have.
#[test]
fn a_model_file_with_the_former_name_of_a_model_predicts_the_same() {
    let folder = recorded(&IN_ORDER);
    folder.run("run experiment.toml --out results --quiet").succeeded();
    let model = folder.read("results/rd_calibrated.json");
    let old = model.replace("{ \"model\": \"constant\" }", "{ \"model\": \"none\" }");
    assert_ne!(old, model);
    folder.write("old.json", &old);
    let predict = "predict --data tuesday.mcap --unit A --out p.csv --model old.json";
    let said = folder.run(predict).succeeded().stderr();
    assert_eq!(said, "note: the coulomb model `none` is called `constant` now; both names mean the same\n");
    assert!(apart(&folder.read("p.csv"), &folder.read("results/predicted_tuesday.csv")) < 1e-9);
}

/// 90 Nm were once between them: the model did not know its joints' names.
#[test]
fn predictions_of_a_saved_model_are_those_of_the_run() {
    let folder = Folder::new().with_bag(&["experiment.toml", "ur10e.urdf", "monday.mcap", "tuesday.mcap"]);
    folder.run("run experiment.toml --out results --quiet").succeeded();
    let predict =
        "predict --model results/rd_calibrated.json --data tuesday.mcap --unit A --out predicted.csv";
    folder.run(predict).succeeded();
    let run = folder.read("results/predicted_tuesday.csv");
    let difference = apart(&run, &folder.read("predicted.csv"));
    assert!(difference < 1e-9, "{difference}");
    // A file of a version that had no names is read as before: in the order of the bag.
    let mut model = folder.json("results/rd_calibrated.json");
    let body = &mut model["model"]["rigid_body_dynamics"]["rigid_body"];
    let names = body.as_object_mut().unwrap().remove("joint_names").unwrap();
    assert_eq!(names[0], "shoulder_pan_joint");
    folder.write("results/rd_calibrated.json", &model.to_string());
    folder.run(predict).succeeded();
    assert!(apart(&run, &folder.read("predicted.csv")) > 80.0);
    let metrics = folder.json("results/metrics.json");
    assert_eq!(metrics["joint_names"][2], "elbow_joint");
    let report = folder.read("results/report.html");
    let shown = report.split("<script").next().unwrap();
    assert!(shown.contains("elbow_joint") && !shown.contains("joint 2"));
}

#[test]
fn tables_of_tracks_and_sweeps_call_joints_by_name() {
    let folder = recorded(&IN_ORDER);
    folder.run("run experiment.toml --out results").succeeded();
    let model = "results/rd_calibrated.json";
    let run =
        folder.run(format!("track experiment.toml --model {model} --window-s 2 wednesday.mcap --out track"));
    assert!(run.status() < 2, "{}", run.stderr());
    let page = folder.read("track/report.html");
    for shown in [run.stdout().as_str(), page.split("<script").next().unwrap()] {
        assert!(shown.contains("friction of elbow") && !shown.contains("friction_1"), "{shown}");
    }
    let sweep = "[sweep.grid]\n'joint_dynamics.coulomb.model' = ['none', 'constant']\n";
    let text = experiment("joint_names = ['shoulder', 'elbow']", "") + sweep;
    folder.write("sweep.toml", &text);
    let shown = folder.run("sweep run sweep.toml --out sweep").succeeded().stdout();
    assert!(shown.contains("elbow") && !shown.contains("joint 1"), "{shown}");
    let page = folder.read("sweep/report.html");
    assert!(!page.split("<script").next().unwrap().contains("joint 1"));
}

#[test]
fn names_that_cannot_match_are_refused_with_those_of_both_sides() {
    let folder = recorded(&[("a1", Some(0)), ("a2", Some(1))]);
    let run = ["run", "experiment.toml", "--out", "results"];
    folder.aurt(run).refused(&["a1, a2", "shoulder, elbow", "joint_names", "--joint-names"]);
    // Which is which can be said, and names a robot that has no names of its own.
    folder.write("experiment.toml", &experiment("", "joint_names = ['a1', 'a2']"));
    folder.aurt(run).succeeded();
    let model = folder.json("results/rd_calibrated.json");
    let names = &model["model"]["rigid_body_dynamics"]["rigid_body"]["joint_names"];
    assert_eq!(names, &serde_json::json!(["a1", "a2"]));
    assert_eq!(numbers(&folder.json("results/metrics.json")["sigma"]).len(), 2);
    folder.write("experiment.toml", &experiment("", "joint_names = ['a1', 'a1']"));
    folder.run("run experiment.toml --out again").refused(&["names two joints"]);
}
