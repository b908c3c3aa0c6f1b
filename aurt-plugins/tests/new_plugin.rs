//! A new plugin builds, passes its own tests, and its library gives a model.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use aurt_friction::conformance::joint;
use aurt_plugins::{NewPlugin, Node, PluginLanguage, Registry, new_plugin};
use aurt_traits::{Slot, ViscousBasis};

fn fresh(name: &str, language: PluginLanguage) -> NewPlugin {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    new_plugin(name, language, &folder).unwrap()
}

fn run(command: &mut Command) -> String {
    let output = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(output.status.success(), "{command:?}\n{}\n{}", text(&output.stdout), text(&output.stderr));
    text(&output.stdout)
}

/// The library's example gives a model that does what it declares.
fn check(library: &Path, name: &str) {
    let mut registry = Registry::linked().unwrap();
    registry.load_library(library).unwrap();
    let example = &registry.model(Slot::Viscous, name).unwrap().example;
    let table: toml::Table = toml::from_str(&format!("viscous = {example}")).unwrap();
    let table = serde_json::to_value(&table["viscous"]).unwrap();
    let model = registry.build::<dyn ViscousBasis>(&Node::from(&table)).unwrap();
    for seed in 0..5 {
        joint::check(&*model, seed).unwrap();
    }
    joint::check_shape(&model, 0).unwrap();
}

#[test]
fn a_new_rust_plugin_works() {
    let plugin = fresh("new-in-rust", PluginLanguage::Rust);
    // The versions of this workspace, so that nothing has to be downloaded.
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    fs::copy(root.join("Cargo.lock"), plugin.folder.join("Cargo.lock")).unwrap();
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("new-plugin-target");
    let cargo = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO"));
        command.current_dir(&plugin.folder).args(arguments);
        command.env("CARGO_TARGET_DIR", &target).env("CARGO_PROFILE_DEV_DEBUG", "0");
        run(&mut command)
    };
    let tests = cargo(&["test", "--lib"]);
    assert!(tests.contains("4 passed"), "{tests}");
    cargo(&["build"]);
    let library = target.join("debug").join(plugin.library.file_name().unwrap());
    check(&library, "new_in_rust");
}

#[test]
fn a_new_c_plugin_works() {
    if Command::new("cc").arg("--version").output().is_err() {
        println!("skipped: there is no C compiler `cc`");
        return;
    }
    let plugin = fresh("new-in-c", PluginLanguage::C);
    let cc = |arguments: &[&str]| {
        let strict = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "-pedantic"];
        run(Command::new("cc").current_dir(&plugin.folder).args(strict).args(arguments))
    };
    cc(&["test.c", "new_in_c.c", "-o", "run_tests", "-lm"]);
    let tests = run(&mut Command::new(plugin.folder.join("run_tests")));
    assert_eq!(tests, "all checks passed\n");
    let library: PathBuf = plugin.folder.join(&plugin.library);
    cc(&["-shared", "-fPIC", "new_in_c.c", "-o", &library.to_string_lossy(), "-lm"]);
    check(&library, "new_in_c");
}
