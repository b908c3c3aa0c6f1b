//! Chains against Pinocchio on the same file.

mod peer;

#[test]
fn torques_regressors_and_base_parameters_agree() {
    let Some(text) = peer::compared("pinocchio", "urdf/compare.py", "gantry.urdf") else { return };
    assert!(text.contains("2 chains compared, 0 refused"), "{text}");
}
