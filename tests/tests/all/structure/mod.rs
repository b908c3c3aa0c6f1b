//! Imports run one way: up the table of crates in ARCHITECTURE.md, up the tables of rooms of the large crates, and between the
//! files of every crate. Folders stay small enough to be read.

mod files;
mod paths;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use files::{Modules, sources};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// Crates whose rooms stand in an order, that of the table of their `lib.rs`.
const ORDERED: [&str; 2] = ["aurt-diagnosis", "aurt-experiment"];

/// Rooms on top of their crate: nothing else in it imports from them.
const TOP_ROOMS: [(&str, &str); 4] = [
    ("aurt-rbd", "robots"),
    ("aurt-friction", "drives"),
    ("aurt-plugins", "model"),
    ("aurt-calibration", "drives"),
];

/// The only crates that simulated robots may know: they share nothing with what is fitted to their recordings.
const KNOWN_TO_SIMULATION: [&str; 4] = ["aurt-files", "aurt-traits", "aurt-rbd", "aurt-recording"];

const MOST_FILES: usize = 20;

/// Most lines of Rust in all crates, tests included. The number may only fall; 130 000 are enough for what they do.
const MOST_LINES: usize = 164_884;

const LISTS: &[&str] = &[
    "aurt-cli/src/commands",
    "aurt-cli/tests/command_line",
    "aurt-diagnosis/src/effects",
    "aurt-simulation/src/effects",
];

fn is_ours(name: &str) -> bool {
    name == "aurt" || name.starts_with("aurt-")
}

/// The crates of the page's table, in its order.
fn order() -> Vec<String> {
    let page = std::fs::read_to_string(Path::new(ROOT).join("ARCHITECTURE.md")).unwrap();
    page.lines()
        .filter_map(|line| line.strip_prefix("| `")?.split('`').next())
        .filter(|name| is_ours(name))
        .map(str::to_owned)
        .collect()
}

struct Crate {
    folder: PathBuf,
    /// Those of ours that it depends on, tests and build scripts aside.
    imports: BTreeSet<String>,
}

fn crates() -> BTreeMap<String, Crate> {
    let output = Command::new(std::env::var("CARGO").unwrap_or_else(|_| "cargo".into()))
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1"])
        .current_dir(ROOT)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let root = Path::new(metadata["workspace_root"].as_str().unwrap());
    let list = |value: &Value| value.as_array().unwrap().clone();
    list(&metadata["packages"])
        .into_iter()
        .map(|package| {
            let imports = list(&package["dependencies"])
                .into_iter()
                .filter(|d| d["kind"].is_null())
                .map(|d| d["name"].as_str().unwrap().to_owned())
                .filter(|name| is_ours(name))
                .collect();
            let manifest = Path::new(package["manifest_path"].as_str().unwrap()).strip_prefix(root).unwrap();
            let folder = manifest.parent().unwrap().to_owned();
            (package["name"].as_str().unwrap().to_owned(), Crate { folder, imports })
        })
        .filter(|(name, _)| is_ours(name))
        .collect()
}

/// Files and folders beside a program's `main.rs` that are no modules of it.
fn without_module(folder: &Path) -> Vec<String> {
    let main = std::fs::read_to_string(folder.join("main.rs")).unwrap();
    let modules: BTreeSet<&str> =
        main.lines().filter_map(|line| line.trim().strip_prefix("mod ")?.strip_suffix(';')).collect();
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries
        .filter(|path| path.extension().is_some_and(|e| e == "rs") || path.join("mod.rs").is_file())
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .filter(|name| name != "main" && !modules.contains(name.as_str()))
        .collect()
}

#[test]
fn every_file_of_a_test_program_is_a_module_of_it() {
    let mut programs = 0;
    for Crate { folder, .. } in crates().values() {
        let Ok(entries) = std::fs::read_dir(Path::new(ROOT).join(folder).join("tests")) else { continue };
        for program in entries.map(|entry| entry.unwrap().path()).filter(|p| p.join("main.rs").is_file()) {
            programs += 1;
            let forgotten = without_module(&program);
            assert!(forgotten.is_empty(), "{} does not run {forgotten:?}", program.display());
        }
    }
    assert!(programs > 8, "{programs} test programs of several files");
}

#[test]
fn crates_import_only_from_crates_above_them() {
    let (order, crates) = (order(), crates());
    let place = |name: &str| order.iter().position(|o| o == name);
    for (name, Crate { folder, imports }) in &crates {
        let Some(own) = place(name) else {
            // Plugins of users, which the examples stand for, may import the vocabulary alone.
            let vocabulary = BTreeSet::from(["aurt-traits".to_owned()]);
            assert!(imports.is_subset(&vocabulary), "{name} is not on the page and imports {imports:?}");
            continue;
        };
        let below: Vec<_> = imports.iter().filter(|i| place(i).is_none_or(|other| other >= own)).collect();
        assert!(below.is_empty(), "{name} imports {below:?}, which ARCHITECTURE.md does not list above it");
        let expected = if name == "aurt-tests" { "tests" } else { name };
        assert_eq!(folder, Path::new(expected), "a crate is a folder at the top, named as the crate is");
    }
    let missing: Vec<_> = order.iter().filter(|name| !crates.contains_key(*name)).collect();
    assert!(missing.is_empty(), "ARCHITECTURE.md lists {missing:?}, which do not exist");
    assert_eq!(order.len(), order.iter().collect::<BTreeSet<_>>().len(), "a crate stands twice: {order:?}");
}

#[test]
fn simulated_robots_share_nothing_with_what_is_fitted() {
    let imports = &crates()["aurt-simulation"].imports;
    let beyond: Vec<_> = imports.iter().filter(|i| !KNOWN_TO_SIMULATION.contains(&i.as_str())).collect();
    assert!(beyond.is_empty(), "aurt-simulation imports {beyond:?}");
}

/// The rooms of a crate in the order in which the table of its `lib.rs` lists them.
fn rooms(name: &str) -> Vec<String> {
    let lib = std::fs::read_to_string(Path::new(ROOT).join(name).join("src/lib.rs")).unwrap();
    lib.lines()
        .filter_map(|line| {
            line.strip_prefix("//! | [`")?
                .split('`')
                .next()
                .map(|room| room.trim_start_matches("mod@").to_owned())
        })
        .collect()
}

#[test]
fn rooms_import_only_from_rooms_above_them() {
    for name in ORDERED {
        let rooms = rooms(name);
        assert!(rooms.len() >= 4, "{name}: {rooms:?}");
        let place = |room: &str| rooms.iter().position(|r| r == room);
        let later = |file: &str, from: &str| {
            let room = file.split('/').next().unwrap_or_default();
            place(room).is_some_and(|own| place(from).is_some_and(|other| other > own))
        };
        let modules = Modules::read(&Path::new(ROOT).join(name).join("src"));
        let back: Vec<_> =
            modules.folders_imported().into_iter().filter(|(file, from)| later(file, from)).collect();
        assert!(back.is_empty(), "{name}: files that import from a later room: {back:#?}");
    }
}

#[test]
fn nothing_in_a_crate_imports_from_a_room_on_top_of_it() {
    for (name, room) in TOP_ROOMS {
        let src = Path::new(ROOT).join(name).join("src");
        assert!(src.join(room).is_dir(), "{name} has no room {room}");
        let imported = Modules::read(&src).folders_imported().into_iter();
        let files: Vec<_> = imported
            .filter(|(file, from)| from == room && file != "lib" && !file.starts_with(room))
            .collect();
        assert!(files.is_empty(), "{name}: files that import from {room}: {files:#?}");
    }
}

#[test]
fn no_files_of_a_crate_import_one_another_in_a_circle() {
    let mut found = Vec::new();
    for (name, own) in &crates() {
        let src = Path::new(ROOT).join(&own.folder).join("src");
        let circles = Modules::read(&src).circles();
        found.extend(circles.into_iter().map(|circle| format!("{name}: {circle}")));
    }
    assert!(
        found.is_empty(),
        "files import one another in a circle; move what both need into a file of its own:\n{}",
        found.join("\n")
    );
}

#[test]
fn no_folder_has_more_files_than_one_reads() {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for own in crates().values() {
        for path in sources(&Path::new(ROOT).join(&own.folder)) {
            let folder = path.parent().unwrap().strip_prefix(ROOT).unwrap().display().to_string();
            *counts.entry(folder).or_default() += 1;
        }
    }
    counts.retain(|folder, count| *count > MOST_FILES && !LISTS.contains(&folder.as_str()));
    assert!(
        counts.is_empty(),
        "folders with more than {MOST_FILES} files that are no list of one kind: {counts:#?}"
    );
}

#[test]
fn the_tree_does_not_grow() {
    let folders = crates().into_values().map(|own| Path::new(ROOT).join(own.folder));
    let files = folders.flat_map(|folder| sources(&folder));
    let lines: usize = files.map(|file| std::fs::read_to_string(file).unwrap().lines().count()).sum();
    assert!(lines <= MOST_LINES, "{lines} lines of Rust where {MOST_LINES} are allowed");
    assert!(lines + 1000 > MOST_LINES, "{lines} lines of Rust: lower MOST_LINES");
}

#[test]
fn circles_are_found_through_groups_and_re_exports_but_not_in_tests_or_between_a_parent_and_its_children() {
    let circles = |files: &[(&str, &str)]| {
        let src = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = src.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        Modules::read(src.path()).circles()
    };
    let b = ("b.rs", "/* crate::c */ use super::a::Aye as Eye; pub struct Bee; // crate::d\n");
    let grouped =
        ("a.rs", "use crate::{b::{self, Bee}, other}; pub struct Aye(Bee, &'static str, \"crate::e\");");
    assert_eq!(circles(&[b, grouped]), ["a.rs → b.rs → a.rs"]);
    let root = ("lib.rs", "mod a; mod b; pub use b::Bee;");
    let re_exported = ("a.rs", "pub struct Aye; fn f() -> crate::Bee { loop {} }");
    assert_eq!(circles(&[root, b, re_exported]), ["a.rs → b.rs → a.rs"]);
    let tested = ("a.rs", "pub struct Aye;\n#[cfg(test)]\nmod tests { use crate::b::Bee; }");
    assert_eq!(circles(&[root, b, tested]), [""; 0]);
    let parent = ("p/mod.rs", "mod c; use c::See; pub struct Pea(See);");
    let child = ("p/c.rs", "use super::Pea; use crate::q::Queue; pub struct See;");
    assert_eq!(circles(&[parent, child, ("q.rs", "pub struct Queue;")]), [""; 0]);
    let round = ("q.rs", "pub struct Queue(crate::p::Pea);");
    assert_eq!(circles(&[parent, child, round]), ["q.rs → p/mod.rs → p/c.rs → q.rs"]);
}

/// Files that open something by themselves: what opens for all, what is written here, and what the program wrote itself.
const OPENING: [&str; 6] = [
    "aurt-files/src/input.rs",
    "aurt-files/src/output",
    "aurt-plugins/src",
    "aurt-export/src/fmu/library.rs",
    "aurt-experiment/src/workbench/exporting.rs",
    "aurt-lab",
];
/// Files that write to a terminal.
const SHOWING: [&str; 3] =
    ["aurt-cli/src/rendering/terminal.rs", "aurt-cli/src/rendering/progress.rs", "aurt-lab"];

/// A file of a user that is opened past `aurt_files`, and text that is shown past the one writer, have no bounds.
#[test]
fn files_are_opened_and_text_is_shown_in_one_place() {
    let root = Path::new(ROOT);
    let mut past = Vec::new();
    for path in crates().values().flat_map(|own| sources(&root.join(&own.folder).join("src"))) {
        let inside = path.strip_prefix(root).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        let names = |words: &[&str], allowed: &[&str]| {
            let is_code = |line: &&str| !line.trim_start().starts_with("//");
            let has = |line: &str| words.iter().any(|word| line.contains(word));
            !allowed.iter().any(|allowed| inside.starts_with(allowed))
                && code.lines().filter(is_code).any(has)
        };
        let is_tests = inside.iter().any(|part| part == "tests" || part == "tests.rs");
        let is_template = inside.ends_with("check_main.rs") || inside.ends_with("build.rs");
        if is_tests || is_template {
            continue;
        }
        let opens = ["File::open(", "fs::read(", "fs::read_to_string(", "OpenOptions"];
        let shows = ["io::stdout(", "io::stderr(", "println!", "eprintln!", "print!", "dbg!"];
        if names(&opens, &OPENING) || names(&shows, &SHOWING) {
            past.push(inside.display().to_string());
        }
    }
    assert!(past.is_empty(), "open files without aurt_files, or write to a terminal: {past:#?}");
}
