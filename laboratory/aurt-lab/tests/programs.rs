//! The programs of the tests.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::{
    env::consts::EXE_SUFFIX,
    fs::read_to_string,
    path::{Path, PathBuf},
    process::Command,
    sync::LazyLock,
};

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

/// Whether the program is there and younger than every file that cargo lists as its source.
fn is_fresh(program: &Path) -> bool {
    let written = |path: &Path| path.metadata().and_then(|m| m.modified()).ok();
    let (Some(built), Ok(listed)) = (written(program), read_to_string(program.with_extension("d"))) else {
        return false;
    };
    let sources = listed.split_once(": ").map_or("", |(_, sources)| sources);
    sources
        .split_whitespace()
        .all(|source| written(Path::new(source)).is_some_and(|changed| changed <= built))
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
