//! Chains against MuJoCo's inverse dynamics of the same file, and parameters against what `mujoco.sysid` makes of them.

use std::path::Path;
use std::process::Command;

use aurt_rbd::robots::{ParameterFile, Part, read};

use super::peer;

#[test]
fn torques_limits_and_joints_agree() {
    let Some(text) = peer::compared("mujoco", "mjcf/compare.py", "arm.xml") else { return };
    assert!(text.contains("3 chains compared"), "{text}");
}

#[test]
fn parameters_mean_what_mujoco_sysid_makes_of_them() {
    let Some(python) = peer::python("mujoco.sysid.report.defaults") else { return };
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/descriptions");
    let (file, folder) = (here.join("reference/arm.xml"), tempfile::tempdir().unwrap());
    let script = [&here.join("identified.py"), &file, folder.path()];
    let run = Command::new(python).args(script).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let parameters = ParameterFile::read(&folder.path().join("parameters.yaml")).unwrap();
    let corrected = read(&file, None, &Part::All, Some(&parameters)).unwrap();
    let expected = read(folder.path().join("identified.xml"), None, &Part::All, None).unwrap();
    assert_eq!(
        (&corrected.joint_names, &corrected.armature_kg_m2),
        (&expected.joint_names, &expected.armature_kg_m2)
    );
    assert_eq!(corrected.friction, expected.friction);
    let original = read(&file, None, &Part::All, None).unwrap();
    let [corrected, expected, original] =
        [corrected, expected, original].map(|robot| robot.standard_parameters.unwrap());
    assert_eq!(corrected.len(), 60);
    let largest = |other: &[f64]| corrected.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(largest(&original) > 0.1 && largest(&expected) < 1e-12, "{corrected:?} {expected:?}");
}
