//! The commands of tutorials do what the tutorials say.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn blocks(page: &str, language: &str) -> Vec<String> {
    let blocks = page.split("\n```").skip(1).step_by(2);
    blocks.filter_map(|block| block.strip_prefix(language)?.strip_prefix('\n')).map(str::to_owned).collect()
}

/// Runs the commands of a page in a folder, one after the other; what all of them said.
fn run(page: &str, folder: &Path) -> String {
    let mut said = String::new();
    let mut count = 0;
    for line in blocks(page, "sh").iter().flat_map(|block| block.lines()) {
        let arguments = line.strip_prefix("aurt ").unwrap_or_else(|| panic!("no command of ours: {line}"));
        let output = Command::new(env!("CARGO_BIN_EXE_aurt"))
            .args(arguments.split_whitespace())
            .current_dir(folder)
            .output()
            .unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        // 1 says that something was found, which a diagnosis is for.
        assert!(matches!(output.status.code(), Some(0 | 1)), "{line}: {errors}");
        said += &String::from_utf8_lossy(&output.stdout);
        count += 1;
    }
    assert!(count > 0, "the page has no commands");
    said
}

#[test]
fn from_a_urdf_and_a_bag_to_a_report() {
    let page = fs::read_to_string(root().join("docs/tutorial-urdf-bag.md")).unwrap();
    let folder: TempDir = tempfile::tempdir().unwrap();
    for name in ["ur10e.urdf", "monday.mcap", "tuesday.mcap"] {
        fs::copy(root().join("examples/urdf-bag").join(name), folder.path().join(name)).unwrap();
    }
    let experiment = blocks(&page, "toml").remove(0) + "\n";
    assert_eq!(
        experiment.trim(),
        fs::read_to_string(root().join("examples/urdf-bag/experiment.toml")).unwrap().trim(),
        "the example is the page's"
    );
    fs::write(folder.path().join("experiment.toml"), experiment).unwrap();
    let said = run(&page, folder.path());
    let lacks = "the model lacks inertia of the motor's rotor on elbow_joint, wrist_1_joint,\nwrist_2_joint and wrist_3_joint";
    assert!(said.contains(lacks) && page.contains(lacks), "{said}");
    assert!(
        said.contains("joints in this order: elbow_joint, shoulder_lift_joint, shoulder_pan_joint"),
        "{said}"
    );
    assert!(folder.path().join("results/report.html").exists());

    // Errors on the held-out bag, in % of the measurement's size, of the first model and of the improved one.
    let wrist = |out: &str| -> Vec<f64> {
        let text = fs::read_to_string(folder.path().join(out).join("metrics.json")).unwrap();
        let metrics: serde_json::Value = serde_json::from_str(&text).unwrap();
        let judged =
            metrics["recordings"].as_array().unwrap().iter().find(|r| r["role"] == "validation").unwrap();
        judged["nrmse"].as_array().unwrap()[3..].iter().map(|nrmse| 100.0 * nrmse.as_f64().unwrap()).collect()
    };
    for (before, after) in wrist("results").into_iter().zip(wrist("improved")) {
        assert!((7.0..15.0).contains(&before) && (2.0..3.0).contains(&after), "{before} {after}");
    }
}
