//! Chains against MuJoCo's inverse dynamics of the same file, where `AURT_PYTHON` names an interpreter that has it.
#![expect(dead_code, reason = "the example's main function is not called")]

#[path = "../examples/chains.rs"]
mod chains;

use std::path::Path;
use std::process::Command;

#[test]
fn torques_limits_and_joints_agree() {
    let Some(python) = std::env::var_os("AURT_PYTHON") else {
        println!("skipped: AURT_PYTHON names no Python with MuJoCo");
        return;
    };
    if !Command::new(&python).args(["-c", "import mujoco"]).status().is_ok_and(|s| s.success()) {
        println!("skipped: {} has no MuJoCo", python.display());
        return;
    }
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = here.join("tests/reference/arm.xml");
    let folder = std::env::temp_dir().join(format!("aurt-robots-mjcf-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let found = chains::chains(&file, &folder, 0).unwrap();
    std::fs::write(folder.join("chains.json"), found.to_string()).unwrap();
    let run = Command::new(&python)
        .arg(here.join("../../proof/mjcf/compare.py"))
        .arg("--written")
        .arg(&folder)
        .arg(&file)
        .output()
        .unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    let (text, errors) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success(), "{text}\n{errors}");
    assert!(text.contains("2 chains compared"), "{text}");
}
