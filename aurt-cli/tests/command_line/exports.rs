//! Exports that begin from a file of the user.

use serde_json::Value;

use crate::support::Folder;

/// For each joint whether the torque of an exported file, read back, is another one than the model's.
fn unlike_the_model(json: &str) -> Vec<bool> {
    let made: Value = serde_json::from_str(json).unwrap();
    let unlike = |joint: &Value| {
        let relative = joint["relative"].as_f64().unwrap();
        assert!(!(1e-6..1e-3).contains(&relative), "{joint}");
        relative > 1e-3
    };
    made["differences"].as_array().unwrap().iter().map(unlike).collect()
}

#[test]
fn a_mujoco_file_that_a_model_was_calibrated_with_is_corrected() {
    let folder = Folder::new().with_whole_demo();
    let text = folder.read("experiment.toml") + "\n[calibration]\nestimator = \"consistent\"\n";
    folder.write("experiment.toml", &text);
    folder.run("run experiment.toml --out of_mdh").succeeded();
    let export = |model: &str, more: &[&str]| folder.aurt(["export", "mjcf", model].iter().chain(more));
    let made = export("of_mdh/rd_calibrated.json", &["--name", "own", "--out", ".", "--json"]).succeeded();
    // Friction of joints 1 and 2 depends on load, which MuJoCo has no word for; all else is read back.
    assert_eq!(unlike_the_model(&made.stdout()), [false, true, true, false, false, false]);
    folder.run("export sdf of_mdh/rd_calibrated.json --name own --out .").succeeded();
    assert!(folder.read("own.sdf").contains("<sdf version=\"1.9\">"));
    let rust = |name| folder.run(format!("export rust of_mdh/rd_calibrated.json --name {name} --out crate"));
    rust("core").refused(&["`core`", "is a word or a crate of Rust"]);
    rust("own").succeeded();
    assert!(folder.read("crate/src/lib.rs").contains("pub fn step(state: &mut State, t: f64, q: &[f64; 6]"));

    // Somebody's file: an elbow that is too heavy, and joints of which nothing is known.
    let exact = folder.read("own.xml");
    let mut masses = 0;
    let wrong: String = exact
        .lines()
        .map(|line| {
            masses += usize::from(line.contains("mass=\""));
            let line = if line.contains("<joint ") {
                line.replace("damping=", "user=").replace("frictionloss=", "margin=")
            } else if masses == 3 {
                line.replace("mass=\"", "mass=\"1")
            } else {
                line.to_owned()
            };
            line + " <!-- mine -->\n"
        })
        .collect();
    assert!(masses >= 3, "{exact}");
    let wrong = wrong[wrong.find("<mujoco").unwrap()..].to_owned();
    folder.write("own.xml", &wrong);
    let with_file: String = text
        .lines()
        .map(|l| if l.starts_with("mdh = ") { "mjcf = \"own.xml\"\n".into() } else { format!("{l}\n") })
        .collect();
    folder.write("again.toml", &with_file);
    let model = "of_file/rd_calibrated.json";
    assert!(folder.run("run again.toml --out of_file").status() < 2);
    let said = export(model, &["--into", "own.xml", "--out", "corrected", "--json"]).succeeded().stdout();
    assert!(said.contains("joint joint_1: damping 0.0000 to "), "{said}");
    assert_eq!(unlike_the_model(&said), [false, true, true, false, false, false]);
    let corrected = folder.read("corrected/own_calibrated.xml");
    assert_eq!(corrected.matches("<!-- mine -->").count(), wrong.matches("<!-- mine -->").count());
    assert!(corrected.contains("user=") && corrected.contains("Dynamics corrected by"), "{corrected}");
    assert_eq!(folder.read("own.xml"), wrong);

    // The same of a URDF file, which has the same chain.
    let of_urdf = ["export", "urdf", "of_mdh/rd_calibrated.json", "--name", "own", "--out", ".", "--json"];
    // URDF has no rotors either, which joints 2 to 5 have.
    let made = folder.aurt(of_urdf).succeeded();
    assert_eq!(unlike_the_model(&made.stdout()), [false, true, true, true, true, true]);
    let own_urdf = folder.read("own.urdf");
    let elbow = own_urdf.match_indices("<mass value=\"").nth(2).unwrap().0;
    let (before, rest) = own_urdf.split_at(elbow);
    let rest = rest.replacen("<mass value=\"", "<!-- mine --><mass value=\"1", 1);
    let heavy = rest[rest.find("<mass").unwrap()..].split('"').nth(1).unwrap().to_owned();
    let wrong_urdf = format!("{before}{rest}");
    let wrong_urdf = wrong_urdf[wrong_urdf.find("<robot").unwrap()..].to_owned();
    folder.write("own.urdf", &wrong_urdf);
    let into = ["export", "urdf", "of_mdh/rd_calibrated.json", "--into", "own.urdf", "--out", "corrected"];
    let said = folder.aurt(into).succeeded().stdout();
    assert!(said.contains("changed: body own_link_"), "{said}");
    assert!(said.contains("less those of the model") && said.contains("    joint 1  "), "{said}");
    let corrected = folder.read("corrected/own_calibrated.urdf");
    assert!(!corrected.contains(&format!("<mass value=\"{heavy}\"")), "{corrected}");
    assert_eq!(corrected.matches("<!-- mine -->").count(), wrong_urdf.matches("<!-- mine -->").count());

    // Of another robot, of another target, and over the input.
    let other = export("of_mdh/rd_calibrated.json", &["--into", "experiment.toml", "--out", "x"]);
    other.refused(&["well-formed XML"]);
    folder
        .run(format!("export sdf {model} --into own.xml --out x"))
        .refused(&["--into", "`mjcf` and `urdf` alone"]);
    folder
        .run(format!("export urdf {model} --into own.xml --out x"))
        .refused(&["<mujoco>, and <robot> of URDF is wanted"]);
    export(model, &["--tip", "own_link_5", "--out", "x"]).refused(&["--into"]);
}
