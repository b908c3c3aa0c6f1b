//! Chains and trees against Pinocchio on the same file.

use std::process::Command;

use super::peer;

#[test]
fn torques_regressors_and_base_parameters_agree() {
    let Some(text) = peer::compared("pinocchio", "urdf/compare.py", "gantry.urdf") else { return };
    assert!(text.contains("3 chains compared (1 of all joints at once), 0 refused"), "{text}");
}

#[test]
fn joints_that_follow_others_agree() {
    let Some(text) = peer::compared("pinocchio", "urdf/compare.py", "coupled.urdf") else { return };
    assert!(text.contains("1 chains compared, 0 refused"), "{text}");
}

#[test]
#[ignore = "takes minutes"]
fn every_file_of_example_robot_data_agrees_chain_by_chain_and_with_all_joints_at_once() {
    const FILES: &str = "import pathlib, pinocchio as pin; print(*(pathlib.Path(pin.__file__).parents[4] / 'share' / \
                         'example-robot-data' / 'robots').rglob('*.urdf'), sep='\\n')";
    let Some(python) = std::env::var_os("AURT_PYTHON") else {
        println!("skipped: AURT_PYTHON names no Python with pinocchio and example-robot-data");
        return;
    };
    let listed = Command::new(python).args(["-c", FILES]).output().unwrap().stdout;
    let mut trees = 0;
    for file in String::from_utf8(listed).unwrap().lines() {
        let Some(text) = peer::compared("pinocchio", "urdf/compare.py", file) else { return };
        println!("{text}");
        trees += usize::from(text.contains("(1 of all joints at once)"));
    }
    assert!(trees == 0 || trees > 40, "{trees}");
}
