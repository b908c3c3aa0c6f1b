//! The user's own MuJoCo file with its dynamics corrected.

mod urdf;

use std::path::Path;
use std::sync::LazyLock;

use aurt_export::into::{Corrected, Format, Original, correct};
use aurt_export::{ExportError, Source};
use aurt_rbd::SerialChain;
use aurt_rbd::robots::{DescribedRobot, Part};
use roxmltree::Document;

use super::models::{Case, case};
use super::source;

const OWN: &str = include_str!("own.xml");

fn read(text: &str) -> DescribedRobot {
    aurt_rbd::robots::parse(text, "own.xml", None, &Some("tool").into(), None).unwrap()
}

fn light_case(text: &str) -> Case {
    case(SerialChain::new(read(text).joints, [0.0, 0.0, -9.81]).unwrap(), true)
}

/// The same with links that are heavier than what the file states, so that something is left for every body.
fn case_of(text: &str) -> Case {
    let mut case = light_case(text);
    let stated = read(text).standard_parameters.unwrap();
    case.standard.iter_mut().zip(stated).for_each(|(sum, value)| *sum += value);
    case
}

fn original(text: &str, format: Format) -> Original<'_> {
    static TOOL: LazyLock<Part> = LazyLock::new(|| Part::from(Some("tool")));
    Original { text, path: Path::new("own.xml"), format, base: None, part: &TOOL }
}

fn corrected(text: &str, case: &Case) -> Result<Corrected, ExportError> {
    let original = original(text, Format::Mjcf);
    correct(&source(case), &original)
}

fn around_heading<'a>(text: &'a str, begin: &str) -> [&'a str; 2] {
    let (before, heading) = text.split_once(begin).unwrap();
    [before, heading.split_once("-->\n").unwrap().1]
}

/// The text outside the elements that carry dynamics.
fn untouched(text: &str) -> String {
    let document = Document::parse(text).unwrap();
    let carries = |n: &roxmltree::Node<'_, '_>| {
        n.has_tag_name("inertial")
            || (n.has_tag_name("joint") && n.ancestors().any(|a| a.has_tag_name("body")))
    };
    let mut out = String::new();
    let mut at = 0;
    for node in document.descendants().filter(carries) {
        out.push_str(&text[at..node.range().start]);
        at = node.range().end;
    }
    out + &text[at..]
}

#[test]
fn armature_and_damping_of_an_actuator_count_once() {
    let driven = "<actuator><motor joint=\"pan\" gear=\"-5 0\" armature=\"0.02\" damping=\"0.2\"/></actuator></mujoco>";
    let text = OWN.replace("</mujoco>", driven);
    let [without, with] = [OWN, &text].map(read);
    assert_eq!(with.armature_kg_m2[0] - without.armature_kg_m2[0], 25.0 * 0.02);
    assert_eq!(with.friction[0].viscous_nm_s_rad - without.friction[0].viscous_nm_s_rad, 25.0 * 0.2);
    let case = case_of(OWN);
    let [without, with] = [OWN, &text].map(|text| corrected(text, &case).unwrap());
    assert!(with.text.contains("armature=\"0.0\" damping=\"0.0\"/></actuator>"), "{}", with.text);
    assert_eq!(read(&with.text).armature_kg_m2, read(&without.text).armature_kg_m2);
    assert_eq!(read(&with.text).friction, read(&without.text).friction);
}

#[test]
fn a_corrected_file_has_the_bodies_of_the_model_and_is_else_the_same() {
    let case = case_of(OWN);
    let Corrected { text, changed, lost, notes } = corrected(OWN, &case).unwrap();
    println!("{text}\n{changed:#?}\n{lost:#?}\n{notes:#?}");

    let robot = read(&text);
    assert!(apart(&robot, &case) < 1e-13);
    let parameter = |name: &str| case.coefficient(name);
    let rotors = [0.0, parameter("rotor_inertia.I_a_1"), 0.0, parameter("rotor_inertia.I_a_3")];
    assert_eq!(robot.armature_kg_m2, rotors, "class defaults are overridden");
    assert_eq!(robot.friction[0].coulomb_nm, parameter("F_C0_0"));
    assert_eq!(robot.friction[2].viscous_nm_s_rad, 0.0);
    assert!(text.contains(&format!("stiffness=\"{:?}\"", parameter("spring.k_2"))), "{text}");

    // Where bytes differ: the heading, inertias, and joints along the chain.
    let [before, after] = around_heading(&text, "<!--\n  Dynamics corrected");
    let without_heading = format!("{before}{after}");
    let added = without_heading.find("euler=\"0 90 0\">").unwrap();
    assert!(without_heading[added..].starts_with("euler=\"0 90 0\">\n              <inertial pos="));
    assert_eq!(
        untouched(&without_heading),
        untouched(OWN).replace(
            "<body name=\"wrist\" pos=\"0 0.1 0.4\" euler=\"0 90 0\">",
            "<body name=\"wrist\" pos=\"0 0.1 0.4\" euler=\"0 90 0\">\n              "
        )
    );
    for same in [
        "<joint name=\"pan\" axis=\"0 0 1\"   range=\"-170 170\"",
        "<joint name='lift' pos=\"0.02 -0.03 0.05\" axis=\"0 -1 0\" ref=\"0\"",
        "<joint name=\"grip\" type=\"slide\" axis=\"0 1 0\" damping=\"3\"/>",
        "<inertial pos=\"0 0.01 0\" mass=\"0.05\" diaginertia=\"1e-5 1e-5 1e-5\"/>",
        "<inertial pos=\"0.02 0 0.01\" mass=\"0.2\" diaginertia=\"0.0001 0.0002 0.00015\"/>",
    ] {
        assert!(text.contains(same), "{same} in {text}");
    }
    assert!(changed.iter().any(|c| c.starts_with("joint pan: armature 0.0500 to 0.0000, ")), "{changed:#?}");
    assert!(changed.iter().any(|c| c.starts_with("body wrist: mass none to ")), "{changed:#?}");
    assert!(text.contains("BLAKE3 of the model: 0123"));
    assert!(lost.iter().any(|l| l.contains("hysteresis `tanh`")), "{lost:#?}");

    // Once more: nothing is left to be done.
    let again = corrected(&text, &case).unwrap();
    assert!(again.changed.iter().all(|c| c.starts_with("body ")), "{:#?}", again.changed);
    assert!(apart(&read(&again.text), &case) < 1e-13);
}

fn apart(robot: &DescribedRobot, case: &Case) -> f64 {
    let found = robot.standard_parameters.as_ref().unwrap();
    found.iter().zip(&case.standard).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()))
}

/// The file has the bodies of the model.
fn assert_has_bodies(text: &str, case: &Case) {
    let apart = apart(&read(text), case);
    assert!(apart < 1e-13, "{apart:e}");
    in_mujoco(text, case);
}

#[test]
fn what_a_tool_weighs_too_much_goes_to_the_body_of_the_joint() {
    let heavy = OWN.replace("mass=\"0.2\"", "mass=\"20\"");
    let case = light_case(&heavy);
    let Corrected { text, changed, .. } = corrected(&heavy, &case).unwrap();
    assert!(changed.contains(&"body tool: without mass, which is in body wrist".to_owned()), "{changed:#?}");
    assert_has_bodies(&text, &case);

    let error = corrected(&OWN.replace("mass=\"0.05\"", "mass=\"50\""), &light_case(OWN)).unwrap_err();
    assert!(
        matches!(&error, ExportError::Remainder { link: 3, carried, .. } if carried == "finger"),
        "{error}"
    );
}

/// A welded body that has its mass from a shape: an `inertial` without mass comes into it.
#[test]
fn a_tool_of_shapes_that_weighs_too_much_gets_an_inertial() {
    let stated = "<inertial pos=\"0.02 0 0.01\" mass=\"0.2\" diaginertia=\"0.0001 0.0002 0.00015\"/>";
    let heavy = OWN.replace(stated, "<geom size=\"0.1\" mass=\"20\"/>");
    let case = light_case(&heavy);
    let Corrected { text, .. } = corrected(&heavy, &case).unwrap();
    let added = "<inertial pos=\"0.0 0.0 0.0\" mass=\"0.0\" diaginertia=\"0.0 0.0 0.0\"/>";
    assert!(text.contains(added), "{text}");
    assert_has_bodies(&text, &case);
}

#[test]
fn files_of_other_robots_are_refused() {
    let case = case_of(OWN);
    let refusal = |text: &str| corrected(text, &case).unwrap_err().to_string();
    let elsewhere = refusal(&OWN.replace("0 0.1 0.4", "0 0.1 0.41"));
    assert!(elsewhere.contains("its joint wrist is elsewhere than joint 3 of the model"), "{elsewhere}");
    let turned = refusal(&OWN.replace("axis=\"0 -1 0\"", "axis=\"0 1 0\""));
    assert!(turned.contains("joint lift has the opposite sense"), "{turned}");
    let kind = refusal(&OWN.replace("<joint name=\"wrist\"", "<joint name=\"wrist\" type=\"slide\""));
    assert!(kind.contains("joint wrist does not move as joint 3"), "{kind}");
    let fewer = refusal(&OWN.replace("<joint name=\"wrist\" axis=\"1 0 0\"/>", ""));
    assert!(fewer.contains("it has 3 joints, and the model has 4"), "{fewer}");
    let unread = refusal(&OWN.replace("<actuator>", "<actuators>"));
    assert!(unread.contains("no well-formed XML"), "{unread}");
    let shapes = refusal(&OWN.replace("<compiler", "<compiler inertiafromgeom=\"true\""));
    assert!(shapes.contains("`inertiafromgeom=\"auto\"`"), "{shapes}");
    let urdf = refusal("<robot name=\"a\"><link name=\"b\"/></robot>");
    assert!(urdf.contains("the outermost element is <robot>, and <mujoco>"), "{urdf}");
}

#[test]
fn a_corrected_file_needs_our_torques_in_mujoco() {
    let case = case_of(OWN);
    in_mujoco(&corrected(OWN, &case).unwrap().text, &case);
    // Before, it did not: the comparison can fail.
    if let Some(worst) = difference_in_mujoco(OWN, &case) {
        assert!(worst > 0.1, "{worst:e}");
    }
}

fn in_mujoco(text: &str, case: &Case) {
    if let Some(worst) = difference_in_mujoco(text, case) {
        assert!(worst <= 1e-9, "{worst:e}");
    }
}

fn difference_in_mujoco(text: &str, case: &Case) -> Option<f64> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("own.xml");
    std::fs::write(&file, text).unwrap();
    super::difference_in_mujoco(&file, case, &["pan", "lift", "elbow", "wrist"])
}

#[test]
fn a_model_without_bodies_corrects_nothing() {
    let case = case_of(OWN);
    let original = original(OWN, Format::Mjcf);
    let bare = Source { standard: None, ..source(&case) };
    assert!(matches!(correct(&bare, &original).unwrap_err(), ExportError::NoBodies));
}
