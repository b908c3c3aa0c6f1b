//! Chains against MuJoCo's inverse dynamics of the same file.

use super::peer;

#[test]
fn torques_limits_and_joints_agree() {
    let Some(text) = peer::compared("mujoco", "mjcf/compare.py", "arm.xml") else { return };
    assert!(text.contains("3 chains compared"), "{text}");
}
