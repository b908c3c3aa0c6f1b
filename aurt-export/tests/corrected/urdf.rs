//! The user's own URDF file with its dynamics corrected.

use aurt_export::into::{Corrected, Format, correct};

use super::super::models::Case;
use super::super::source;
use super::{around_heading, case_of, original, read};

const OWN: &str = include_str!("own.urdf");

fn corrected(text: &str, case: &Case) -> Corrected {
    correct(&source(case), &original(text, Format::Urdf)).unwrap()
}

fn difference(text: &str, case: &Case) -> f64 {
    case.difference(&read(text))
}

/// The lines that have no dynamics of the chain.
fn untouched(text: &str) -> Vec<&str> {
    let carries =
        ["<inertial", "<origin rpy=", "<mass", "<inertia", "ixy=\"", "<dynamics", "name=\"wrist\"/>"];
    let changed =
        |line: &&str| carries.iter().any(|part| line.contains(part)) || line.contains("\"upper\"></");
    text.lines().filter(|line| !changed(line)).collect()
}

#[test]
fn a_corrected_urdf_file_needs_the_torques_of_the_model_and_is_else_the_same() {
    let case = case_of(OWN);
    assert!(difference(OWN, &case) > 0.1);
    let Corrected { text, changed, lost, notes } = corrected(OWN, &case);
    println!("{text}\n{changed:#?}\n{lost:#?}\n{notes:#?}");
    let worst = difference(&text, &case);
    println!("largest difference {worst:e} of the largest torque");
    assert!(worst <= 1e-12, "{worst:e}");

    let robot = read(&text);
    let parameter = |name: &str| case.coefficient(name);
    assert_eq!(robot.friction[0].coulomb_nm, parameter("F_C0_0"));
    assert_eq!(robot.friction[2].viscous_nm_s_rad, 0.0);
    assert_eq!(robot.limits, read(OWN).limits);

    // The comment comes before the robot; inertias and friction of the chain are the only other changes.
    let [before, after] = around_heading(&text, "<!--\n  Dynamics corrected by `aurt export urdf`");
    assert!(after.starts_with("<robot name = 'own'>"));
    let without_heading = format!("{before}{after}");
    assert_eq!(untouched(&without_heading), untouched(OWN));
    for same in [
        "<!-- weighed in 2019 -->",
        "<link name=\"world\"/>",
        "<dynamics damping=\"3\"/>",
        "<origin xyz=\"0.02 0 0.01\"/><mass value=\"0.2\"/><inertia ixx=\"1e-4\"",
        "<inertial><origin xyz=\"0 0.01 0\"/><mass value=\"0.05\"/>",
    ] {
        assert!(text.contains(same), "{same} in {text}");
    }
    assert!(text.contains("<link name=\"wrist\"><inertial><origin xyz="), "{text}");
    assert!(changed.iter().any(|c| c.starts_with("body wrist: mass none to ")), "{changed:#?}");
    assert!(changed.iter().any(|c| c.starts_with("joint pan: damping 7.0000 to ")), "{changed:#?}");
    for part in ["rotor inertia of joint 1", "spring of joint 2", "hysteresis `tanh`"] {
        assert!(lost.iter().any(|l| l.contains(part)), "{part}: {lost:#?}");
    }

    // Once more: nothing is left to be done.
    let again = corrected(&text, &case);
    assert!(again.changed.iter().all(|c| c.starts_with("body ")), "{:#?}", again.changed);
    assert!(difference(&again.text, &case) <= 1e-12);
}

#[test]
fn files_that_are_no_urdf_or_follow_other_joints_are_refused() {
    let case = case_of(OWN);
    let refusal =
        |text: &str| correct(&source(&case), &original(text, Format::Urdf)).unwrap_err().to_string();
    assert!(refusal("<mujoco/>").contains("<mujoco>, and <robot> of URDF is wanted"));
    let coupled = OWN.replace("<safety_controller k_velocity=\"1\"/>", "<mimic joint=\"pan\"/>");
    assert!(refusal(&coupled).contains("follow others (mimic)"), "{}", refusal(&coupled));
}
