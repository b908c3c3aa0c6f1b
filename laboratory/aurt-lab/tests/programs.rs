//! The programs of the tests.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::{
    env::consts::EXE_SUFFIX,
    path::{Path, PathBuf},
    process::Command,
    sync::LazyLock,
};

/// `aurt-lab`.
pub fn aurt_lab() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_aurt-lab"))
}

/// `aurt`, in the same folder. It belongs to another package, which cargo does not build for these tests.
pub fn aurt() -> &'static Path {
    static AURT: LazyLock<PathBuf> = LazyLock::new(|| {
        let folder = aurt_lab().parent().unwrap();
        let mut build = Command::new(env!("CARGO"));
        build
            .args(["build", "--quiet", "--package", "aurt-cli", "--target-dir"])
            .arg(folder.parent().unwrap());
        match folder.file_name().and_then(|name| name.to_str()) {
            Some("debug") | None => {}
            Some(profile) => drop(build.args(["--profile", profile])),
        }
        assert!(build.status().unwrap().success());
        folder.join(format!("aurt{EXE_SUFFIX}"))
    });
    &AURT
}
