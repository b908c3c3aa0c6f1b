//! The programs of the tests.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::env::consts::EXE_SUFFIX;
use std::fs::read_dir;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

/// `aurt-lab`.
pub fn aurt_lab() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_aurt-lab"))
}

/// `aurt`, in the same folder. Cargo builds it for the tests of the whole workspace, not for those of this package alone;
/// building it here would take other features, that is, every crate once more.
pub fn aurt() -> &'static Path {
    static AURT: LazyLock<PathBuf> = LazyLock::new(|| {
        let folder = aurt_lab().parent().unwrap();
        let aurt = folder.join(format!("aurt{EXE_SUFFIX}"));
        if !is_fresh(&aurt) {
            build(folder);
        }
        aurt
    });
    &AURT
}

/// Whether the program is there and younger than every source of the crates, this one aside.
fn is_fresh(program: &Path) -> bool {
    let written = |path: &Path| path.metadata().and_then(|m| m.modified()).ok();
    let Some(built) = written(program) else { return false };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let below = |folder: PathBuf| read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_linked = |folder: &PathBuf| {
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("aurt") && name != "aurt-lab"
    };
    // The folder that the demo leaves has no sources.
    let sources = below(root).filter(is_linked).map(|folder| folder.join("src"));
    let mut places: Vec<PathBuf> = sources.filter(|place| place.is_dir()).collect();
    while let Some(place) = places.pop() {
        if place.is_dir() {
            places.extend(below(place));
        } else if written(&place).is_none_or(|changed| changed > built) {
            return false;
        }
    }
    true
}

fn build(folder: &Path) {
    let mut build = Command::new(env!("CARGO"));
    build.args(["build", "--quiet", "--package", "aurt-cli", "--target-dir"]).arg(folder.parent().unwrap());
    match folder.file_name().and_then(|name| name.to_str()) {
        Some("debug") | None => {}
        Some(profile) => drop(build.args(["--profile", profile])),
    }
    assert!(build.status().unwrap().success());
}
