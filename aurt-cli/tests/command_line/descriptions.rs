//! What URDF and MJCF files lack: their inertial parameters as a model that is diagnosed.

use aurt::simulation::Robot;
use serde_json::{Value, json};

use crate::support::{Folder, without_constants};

/// How the links of the arm stand on one another: origin and turn about x of each joint's frame in that of the link before.
const JOINTS: [([f64; 3], f64); 6] = [
    ([0.0, 0.0, 0.1807], 0.0),
    ([0.0, 0.0, 0.0], std::f64::consts::FRAC_PI_2),
    ([-0.6127, 0.0, 0.0], 0.0),
    ([-0.57155, 0.0, 0.17415], 0.0),
    ([0.0, -0.11985, 0.0], std::f64::consts::FRAC_PI_2),
    ([0.0, 0.11655, 0.0], -std::f64::consts::FRAC_PI_2),
];

/// A simulated UR10e without load-dependent friction, its recordings, and an experiment on its geometry.
fn recorded() -> (Folder, Robot) {
    let folder = Folder::new();
    let mut robot = Robot::named("ur10e").unwrap();
    robot.drives.iter_mut().for_each(|drive| drive.load_coefficient = 0.0);
    let sines = "kind = 'multi_sine'\nduration_s = 20.0\nharmonics = 5\ntop_hz = 0.8\nshare = 0.5";
    let stops = "kind = 'point_to_point'\nduration_s = 40.0\nshare = 0.5\nrest_s = 1.0";
    for (name, seed, motion) in [("first", 3, sines), ("second", 4, sines), ("stops", 5, stops)] {
        let scenario =
            format!("robot = 'ur10e'\nseed = {seed}\n[motion]\n{motion}\n[logger]\nrate_hz = 125\n");
        let drives = (0..6).map(|j| format!("[[drive]]\njoint = {j}\nload_coefficient = 0.0\n"));
        folder.write("scenario.toml", &drives.fold(scenario, |text, drive| text + &drive));
        let out = format!("{name}.csv");
        folder.run(format!("simulate --scenario scenario.toml --out {out} --quiet")).succeeded();
    }
    folder.write("mdh.csv", &robot.mdh_csv());
    let constants: Vec<f64> = robot.drives.iter().map(|d| d.torque_constant_nm_per_a).collect();
    folder.write(
        "experiment.toml",
        &format!(
            "schema = 1\n[robot]\nmdh = 'mdh.csv'\ngravity_m_s2 = [0.0, 0.0, -9.81]\n\
             torque_constants_nm_per_a = {constants:?}\n\
             [recordings]\ncalibration = ['first.csv']\nvalidation = ['second.csv']\n[preprocess]\nf_dyn_hz = 5.0\n"
        ),
    );
    (folder, robot)
}

fn words(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

/// A URDF file of the robot's geometry and bodies, which has no word for rotors, and here none for friction.
fn urdf(robot: &Robot) -> String {
    let mut text = "<robot name=\"arm\">\n<link name=\"link_0\"/>\n".to_owned();
    for (j, ((origin, turn), body)) in JOINTS.iter().zip(&robot.links).enumerate() {
        let (origin, com) = (words(origin), words(&body.com_m));
        let inertia: String = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]
            .iter()
            .zip(body.inertia_at_com_kg_m2)
            .map(|(name, value)| format!(" {name}=\"{value}\""))
            .collect();
        text += &format!(
            "<joint name=\"joint_{j}\" type=\"continuous\"><parent link=\"link_{j}\"/><child link=\"link_{}\"/>\
             <origin xyz=\"{origin}\" rpy=\"{turn} 0 0\"/><axis xyz=\"0 0 1\"/></joint>\n\
             <link name=\"link_{}\"><inertial><origin xyz=\"{com}\"/><mass value=\"{}\"/><inertia{inertia}/></inertial>\
             </link>\n",
            j + 1,
            j + 1,
            body.mass_kg
        );
    }
    text + "</robot>\n"
}

/// An MJCF file of the robot with friction and rotors.
fn mjcf(robot: &Robot) -> String {
    let mut text = "<mujoco model=\"arm\"><compiler angle=\"radian\"/><worldbody>\n".to_owned();
    for (j, ((origin, turn), (body, drive))) in
        JOINTS.iter().zip(robot.links.iter().zip(&robot.drives)).enumerate()
    {
        let [xx, xy, xz, yy, yz, zz] = body.inertia_at_com_kg_m2;
        text += &format!(
            "<body name=\"link_{j}\" pos=\"{}\" euler=\"{turn} 0 0\">\
             <inertial pos=\"{}\" mass=\"{}\" fullinertia=\"{}\"/>\
             <joint name=\"joint_{j}\" axis=\"0 0 1\" armature=\"{}\" damping=\"{}\" frictionloss=\"{}\"/>\n",
            words(origin),
            words(&body.com_m),
            body.mass_kg,
            words(&[xx, yy, zz, xy, xz, yz]),
            drive.rotor_inertia_kg_m2,
            drive.viscous_nm_s,
            drive.coulomb_nm
        );
    }
    text + &"</body>".repeat(JOINTS.len()) + "\n</worldbody></mujoco>\n"
}

/// The effects of a diagnosis of a description, each with its joints, and the verdict.
fn lack(folder: &Folder, file: &str) -> (Vec<(String, Value)>, Value) {
    corrected(folder, file, &[])
}

/// As [`lack`], with more options.
fn corrected(folder: &Folder, file: &str, more: &[&str]) -> (Vec<(String, Value)>, Value) {
    let out = format!("{file}.out");
    let run = ["diagnose", "experiment.toml", "--model", file, "--out", &out, "--quiet"];
    let run = folder.aurt([&run[..], more].concat());
    assert!(matches!(run.status(), 0 | 1), "{}", run.stderr());
    let verdict = folder.json(&format!("{out}/verdict.json"));
    let effects = verdict["effects"].as_array().unwrap();
    let named = |e: &Value| (e["effect"].as_str().unwrap().to_owned(), e["joints"].clone());
    (effects.iter().map(named).collect(), verdict)
}

#[test]
fn a_description_without_friction_lacks_friction_and_one_with_all_lacks_nothing() {
    let (folder, mut robot) = recorded();
    folder.write("bare.urdf", &urdf(&robot));
    let (effects, verdict) = lack(&folder, "bare.urdf");
    assert_eq!(verdict["verdict"], "named", "{verdict}");
    // Friction of the experiment's own models has one name where all of it is missing. Rotors of the first two joints are
    // bodies on their links as well.
    let joints = |named: &[&str]| {
        let those = effects.iter().filter(|(e, _)| named.contains(&e.as_str()));
        let mut joints: Vec<u64> =
            those.flat_map(|(_, j)| j.as_array().unwrap()).filter_map(Value::as_u64).collect();
        joints.sort_unstable();
        joints.dedup();
        joints
    };
    assert_eq!(effects[0].0, "friction_level_changed", "{effects:?}");
    assert_eq!(joints(&["friction_level_changed"]), [0, 1, 2, 3, 4, 5], "{effects:?}");
    assert_eq!(joints(&["rotor_inertia", "payload"]), [0, 1, 2, 3, 4, 5], "{effects:?}");
    assert_eq!(joints(&["base_tilt", "torque_constant"]), [0; 0], "{effects:?}");
    // What the experiment's own structure has is not added to it again.
    let improved = folder.read("bare.urdf.out/improved.toml");
    assert!(improved.contains("rotor_inertia") && !improved.contains("joint_friction"), "{improved}");

    // An arm that stands holds as much by the friction that the file lacks: no force from outside does.
    let experiment = folder.read("experiment.toml");
    folder.write("experiment.toml", &experiment.replacen("['first.csv']", "['stops.csv']", 1));
    let (of_stops, verdict) = lack(&folder, "bare.urdf");
    assert!(of_stops.iter().any(|(e, _)| e == "friction_level_changed"), "{of_stops:?}");
    assert!(of_stops.iter().all(|(e, _)| e != "external_contact"), "{verdict}");
    folder.write("experiment.toml", &experiment);

    folder.write("whole.xml", &mjcf(&robot));
    let (effects, verdict) = lack(&folder, "whole.xml");
    assert_eq!((&verdict["verdict"], effects.len()), (&json!("no_mismatch"), 0), "{verdict}");

    // A load of 2 kg that the file does not know.
    robot.links[2].mass_kg -= 2.0;
    folder.write("light.xml", &mjcf(&robot));
    let (effects, verdict) = lack(&folder, "light.xml");
    assert_eq!(effects[0].0, "payload", "{verdict}");
    let first = &verdict["effects"][0]["parameters"];
    let mass = first["mass_kg"]["value"].as_f64().unwrap();
    assert!((mass - 2.0).abs() < 0.4, "{first}");

    // What mujoco.sysid identified of that body corrects the file.
    let parameters = format!(
        "link_2_mass:\n  value:\n  - {}\ncommand_delay:\n  value: [0.01]\n",
        robot.links[2].mass_kg + 2.0
    );
    folder.write("params.yaml", &parameters);
    let (effects, verdict) = corrected(&folder, "light.xml", &["--parameters", "params.yaml"]);
    assert_eq!((&verdict["verdict"], effects.len()), (&json!("no_mismatch"), 0), "{verdict}");
    let options = ["diagnose", "experiment.toml", "--model", "light.xml", "--out", "out", "--parameters"];
    let run = folder.aurt([&options[..], &["params.yaml", "--json"]].concat());
    let notes = serde_json::from_str::<Value>(&run.stdout()).unwrap()["notes"].to_string();
    assert!(notes.contains("no model of torques") && notes.contains("command_delay"), "{notes}");
    folder.write("wrong.yaml", "hand_mass:\n  value:\n  - 1.0\n");
    folder.aurt([&options[..], &["wrong.yaml"]].concat()).refused(&["wrong.yaml:1", "`hand`", "link_2"]);
}

#[test]
fn descriptions_that_are_no_model_of_the_arm_are_refused() {
    let (folder, robot) = recorded();
    let whole = urdf(&robot);
    let refused = |text: &str, words: &[&str]| {
        folder.write("robot.urdf", text);
        let arguments = ["diagnose", "experiment.toml", "--model", "robot.urdf", "--out", "out", "--quiet"];
        folder.aurt(arguments).refused(words);
        assert!(!folder.path("out").exists());
    };
    let massless: String =
        whole.lines().map(|l| if l.contains("<inertial>") { "" } else { l }).collect::<Vec<_>>().join("\n");
    let mut links = String::new();
    for j in 1..=6 {
        links += &format!("<link name=\"link_{j}\"/>\n");
    }
    refused(&massless.replace("</robot>", &(links + "</robot>")), &["states no masses", "inertial"]);
    refused(&whole.replace("-0.6127", "-0.5127"), &["of another arm", "gravity_m_s2"]);
    let end = whole.find("<joint name=\"joint_5\"").unwrap();
    refused(&(whole[..end].to_owned() + "</robot>"), &["has 5 joints, the experiment's robot 6", "--tip"]);

    folder.write("robot.urdf", &whole);
    let text = folder.read("experiment.toml");
    folder.write("amperes.toml", &without_constants(&text));
    let arguments = ["diagnose", "amperes.toml", "--model", "robot.urdf", "--out", "out", "--quiet"];
    folder.aurt(arguments).refused(&["in Nm", "in A", "torque_constants_nm_per_a"]);
    folder.write("rd.json", "{}");
    let arguments = ["diagnose", "amperes.toml", "--model", "rd.json", "--tip", "link_6", "--out", "out"];
    folder.aurt(arguments).refused(&["--tip"]);
}

fn masses(folder: &Folder, results: &str) -> Vec<f64> {
    let metrics = folder.json(&format!("{results}/metrics.json"));
    let standard = metrics["consistent"]["standard"].as_array().unwrap();
    let mass = |e: &&Value| e["name"].as_str().unwrap().starts_with("m_");
    standard.iter().filter(mass).map(|e| e["value"].as_f64().unwrap()).collect()
}

#[test]
fn a_description_is_a_prior_of_consistent_estimates() {
    let (folder, robot) = recorded();
    folder.write("arm.urdf", &urdf(&robot));
    let on_table = folder.read("experiment.toml");
    let text = on_table.replace("mdh = 'mdh.csv'", "urdf = 'arm.urdf'")
        + "[[arm_terms]]\nmodel = 'rotor_inertia'\njoints = [2, 3, 4, 5]\n";
    let run = |name: &str, text: &str, calibration: &str| {
        folder.write(&format!("{name}.toml"), &format!("{text}[calibration]\n{calibration}\n"));
        folder.aurt(["run", &format!("{name}.toml"), "--out", name, "--quiet"])
    };
    let truth: Vec<f64> = robot.links.iter().map(|link| link.mass_kg).collect();
    let away = |results: &str| {
        let masses = masses(&folder, results);
        assert_eq!(masses.len(), truth.len());
        masses.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    };
    run("alone", &text, "estimator = 'consistent'").succeeded();
    run("known", &text, "estimator = 'consistent'\nprior = 'description'").succeeded();
    run("held", &text, "estimator = 'consistent'\nprior = 'description'\nprior_weight = 1e6").succeeded();
    run("open", &text, "estimator = 'consistent'\nprior = 'description'\nprior_weight = 0.0").succeeded();
    let (alone, known, held) = (away("alone"), away("known"), away("held"));
    println!(
        "{:?} {:?} {:?} {:?}",
        masses(&folder, "alone"),
        masses(&folder, "open"),
        masses(&folder, "known"),
        truth
    );
    assert!(known < 0.1 * alone && held < 0.02 * alone, "{alone} {known} {held}");
    // What a true description says of a mass stays.
    let stayed = masses(&folder, "known");
    assert!(
        stayed.iter().zip(&truth).all(|(kg, known)| (kg / known - 1.0).abs() < 0.1),
        "{stayed:?} {truth:?}"
    );
    assert_eq!(folder.json("known/metrics.json")["consistent"]["prior"], true);
    assert_eq!(folder.json("alone/metrics.json")["consistent"]["prior"], false);

    let prior = "estimator = 'consistent'\nprior = 'description'";
    run("table", &on_table, prior).refused(&["`prior` needs masses", "inertial"]);
    run("other", &text, "prior = 'description'").refused(&["`prior` is for another estimator", "consistent"]);
    run("word", &text, "estimator = 'consistent'\nprior = 'cad'").refused(&["`prior` expects", "cad"]);
    let alone = "estimator = 'consistent'\nprior_weight = 1.0";
    run("weight", &text, alone).refused(&["`prior_weight` weighs a `prior`"]);
    let negative = format!("{prior}\nprior_weight = -1.0");
    run("negative", &text, &negative).refused(&["`prior_weight` must not be negative"]);
    let mut impossible = robot;
    impossible.links[2].inertia_at_com_kg_m2[0] = 1e3;
    folder.write("arm.urdf", &urdf(&impossible));
    run("impossible", &text, prior).refused(&["prior of link 2 is physically impossible"]);
}
