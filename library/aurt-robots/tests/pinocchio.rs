//! Chains against Pinocchio on the same file.

mod peer;

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
