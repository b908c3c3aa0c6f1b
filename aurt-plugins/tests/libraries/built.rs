//! The libraries that the tests load.

use std::collections::HashMap;
use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

use aurt_plugins::{Registry, Trust};

/// The Rust example, which cargo has built as a library because this test depends on it.
pub fn rust_example() -> PathBuf {
    let folder = std::env::current_exe().unwrap().parent().unwrap().to_owned();
    let file = folder.join(format!("{DLL_PREFIX}aurt_plugin_example{DLL_SUFFIX}"));
    assert!(file.exists(), "{} was not built", file.display());
    file
}

/// The C example; nothing, with a reason printed, where there is no C compiler.
pub fn c_example() -> Option<PathBuf> {
    compile("stop_c", Path::new("../examples/plugin-c/stop.c"), &[])
}

/// `fixtures/faulty.c` with one fault.
pub fn faulty(fault: &str) -> Option<PathBuf> {
    compile(&format!("faulty_{fault}"), Path::new("tests/fixtures/faulty.c"), &[&format!("-D{fault}")])
}

/// A library that asks for `libneighbour.so` beside it (`$ORIGIN`), and that library.
pub fn needs_neighbour(folder: &Path) -> Option<PathBuf> {
    let made = |name: &str, code: &str, arguments: &[&str]| {
        std::fs::write(folder.join(format!("{name}.c")), code).unwrap();
        let mut compiler = Command::new("cc");
        compiler.current_dir(folder).args([
            "-shared",
            "-fPIC",
            "-o",
            &format!("lib{name}.so"),
            &format!("{name}.c"),
        ]);
        let output = compiler.args(arguments).output().ok()?;
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Some(folder.join(format!("lib{name}.so")))
    };
    made("neighbour", "int neighbour(void) { return 1; }", &[])?;
    let needy = "int neighbour(void); int aurt_plugin(void) { return neighbour(); }";
    made("needy", needy, &["-L.", "-lneighbour", "-Wl,-rpath,$ORIGIN"])
}

/// Compiles a library once, though several tests ask for it at the same time.
fn compile(name: &str, source: &Path, arguments: &[&str]) -> Option<PathBuf> {
    static COMPILED: Mutex<Option<HashMap<String, Option<PathBuf>>>> = Mutex::new(None);
    let mut compiled = COMPILED.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    let compiled = compiled.get_or_insert_default();
    compiled.entry(name.to_owned()).or_insert_with(|| compile_now(name, source, arguments)).clone()
}

fn compile_now(name: &str, source: &Path, arguments: &[&str]) -> Option<PathBuf> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let library = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{DLL_PREFIX}{name}{DLL_SUFFIX}"));
    let compiler = Command::new("cc")
        .args(["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC", "-I"])
        .arg(here.join("../aurt-traits/include"))
        .args(arguments)
        .arg(here.join(source))
        .arg("-o")
        .arg(&library)
        .output();
    let Ok(output) = compiler else {
        println!("skipped: there is no C compiler `cc`");
        return None;
    };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(library)
}

/// The linked models; files may name any library.
pub fn trusting() -> Registry {
    let mut registry = Registry::linked().unwrap();
    registry.trust(Trust::all());
    registry
}

/// The linked models and those of a library.
pub fn with(library: &Path) -> Registry {
    let mut registry = trusting();
    registry.load_library(library).unwrap();
    registry
}
