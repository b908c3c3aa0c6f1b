//! Rust crates, built and tested by cargo without a network.

mod times;

use std::process::{Command, Output};

use aurt_export::{Export, rust};

use super::models::*;
use super::{source, write};

/// Runs the test of an export; nothing where there is no cargo.
fn tested(export: &Export) -> Option<Output> {
    let folder = tempfile::tempdir().unwrap();
    write(export, folder.path());
    let run = Command::new("cargo")
        .args(["test", "--offline", "--quiet", "--", "--nocapture", "--test-threads=1"])
        .env("RUSTFLAGS", "-D warnings")
        .env("CARGO_TARGET_DIR", folder.path().join("target"))
        .current_dir(folder.path())
        .output();
    if run.is_err() {
        println!("skipped: there is no `cargo`");
    }
    run.ok()
}

pub fn passes(name: &str, export: &Export, comparisons: usize) {
    let Some(run) = tested(export) else { return };
    let text = String::from_utf8_lossy(&run.stdout);
    println!("{name}: {text}");
    assert!(run.status.success(), "{name}: {text}{}", String::from_utf8_lossy(&run.stderr));
    assert_eq!(text.matches("passed, largest").count(), comparisons, "{name}: {text}");
}

#[test]
fn the_crate_of_an_arm_and_of_a_gantry_predicts_what_their_models_do() {
    for (case, name) in
        [(case(arm(), true), "arm"), (case(gantry(), false), "gantry"), (case(two_arms(), true), "two arms")]
    {
        passes(name, &rust::export(&source(&case), &checks(&case, 32)).unwrap(), 7);
    }
}

#[test]
fn the_crate_of_friction_with_memory_predicts_what_the_models_do() {
    let case = case_with_memory(arm());
    let stored = checks_along_a_path(&case, 400);
    passes("arm", &rust::export(&source(&case), &stored).unwrap(), 5);
    // The order of the samples matters: the same states in another order have another torque.
    let mut turned = stored;
    turned.swap(120, 121);
    let Some(run) = tested(&rust::export(&source(&case), &turned).unwrap()) else { return };
    let text = String::from_utf8_lossy(&run.stderr);
    assert!(!run.status.success() && text.contains("differs by"), "{text}");
}

/// The source has neither `std` nor an allocator, and of `libm` no more than a crate of these names has.
#[test]
fn the_crate_needs_no_standard_library() {
    let case = case_with_memory(gantry());
    let export = rust::export(&source(&case), &checks(&case, 2)).unwrap();
    let folder = tempfile::tempdir().unwrap();
    write(&export, folder.path());
    let functions = ["cos(x)", "exp(x)", "expm1(x)", "fabs(x)", "log1p(x)", "sin(x)", "sqrt(x)", "tanh(x)"]
        .map(|f| f.replace("(x)", "(x: f64) -> f64 { x }"))
        .into_iter()
        .chain(["copysign", "pow"].map(|f| format!("{f}(x: f64, y: f64) -> f64 {{ x + y }}")));
    let named: String = functions.map(|f| format!("pub fn {f}\n")).collect();
    std::fs::write(folder.path().join("libm.rs"), format!("#![no_std]\n{named}")).unwrap();
    let rustc = |arguments: &[&str]| {
        Command::new("rustc")
            .args(["--edition=2021", "--crate-type=rlib", "-Dwarnings", "-L."])
            .args(arguments)
            .current_dir(folder.path())
            .output()
    };
    let (Ok(libm), Ok(machine)) =
        (rustc(&["libm.rs"]), rustc(&["--crate-name=machine", "--extern=libm", "src/lib.rs"]))
    else {
        println!("skipped: there is no `rustc`");
        return;
    };
    for made in [libm, machine] {
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    }
    assert!(folder.path().join("libmachine.rlib").exists());
}
