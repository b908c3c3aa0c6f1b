//! The table in ARCHITECTURE.md says which crate may import which of ours; this keeps it true.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
    process::Command,
};

use serde_json::Value;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// Whether a crate is one of ours, by its name.
fn is_ours(name: &str) -> bool {
    name == "aurt" || name.starts_with("aurt-")
}

/// The crates of each row's last column; `None` where it says `all`.
fn allowed() -> BTreeMap<String, Option<BTreeSet<String>>> {
    let page = std::fs::read_to_string(Path::new(ROOT).join("ARCHITECTURE.md")).unwrap();
    let names = |cell: &str| -> BTreeSet<String> {
        cell.split('`').skip(1).step_by(2).filter(|n| is_ours(n)).map(str::to_owned).collect()
    };
    page.lines()
        .filter(|line| line.starts_with("| `aurt"))
        .map(|line| {
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            let may_import = (cells[3] != "all").then(|| names(cells[3]));
            (names(cells[1]).pop_first().unwrap(), may_import)
        })
        .collect()
}

/// Our crates with those of ours that they depend on, tests and build scripts aside.
fn imports() -> BTreeMap<String, BTreeSet<String>> {
    let output = Command::new(std::env::var("CARGO").unwrap_or_else(|_| "cargo".into()))
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1"])
        .current_dir(ROOT)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let list = |value: &Value| value.as_array().unwrap().clone();
    list(&metadata["packages"])
        .into_iter()
        .map(|package| {
            let imported = list(&package["dependencies"])
                .into_iter()
                .filter(|d| d["kind"].is_null())
                .map(|d| d["name"].as_str().unwrap().to_owned())
                .filter(|name| is_ours(name))
                .collect();
            (package["name"].as_str().unwrap().to_owned(), imported)
        })
        .filter(|(name, _): &(String, _)| is_ours(name))
        .collect()
}

#[test]
fn crates_import_what_the_architecture_page_allows() {
    let (allowed, imports) = (allowed(), imports());
    assert!(imports.len() >= 8, "{imports:?}");
    for (name, imported) in &imports {
        let Some(row) = allowed.get(name) else {
            // Plugins of users, which the examples stand for, may import the vocabulary alone.
            let vocabulary = BTreeSet::from(["aurt-traits".to_owned()]);
            assert!(imported.is_subset(&vocabulary), "{name} is not on the page and imports {imported:?}");
            continue;
        };
        let Some(may) = row else { continue };
        let beyond: Vec<_> = imported.difference(may).collect();
        assert!(beyond.is_empty(), "{name} imports {beyond:?}, which ARCHITECTURE.md does not allow");
    }
    let missing: Vec<_> = allowed.keys().filter(|name| !imports.contains_key(*name)).collect();
    assert!(missing.is_empty(), "ARCHITECTURE.md lists {missing:?}, which do not exist");
}

/// The rooms of the diagnosis in the order in which the table of its `lib.rs` lists them.
fn rooms() -> Vec<String> {
    let lib = std::fs::read_to_string(Path::new(ROOT).join("library/aurt-diagnosis/src/lib.rs")).unwrap();
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
fn rooms_of_the_diagnosis_import_only_from_rooms_before_them() {
    let rooms = rooms();
    assert!(rooms.len() >= 10, "{rooms:?}");
    let mut back = Vec::new();
    for (place, room) in rooms.iter().enumerate() {
        let folder = Path::new(ROOT).join("library/aurt-diagnosis/src").join(room);
        let mut folders = vec![folder];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(&folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                    continue;
                }
                let text = std::fs::read_to_string(&path).unwrap();
                let code = text.split("#[cfg(test)]").next().unwrap_or_default();
                let later =
                    rooms[place + 1..].iter().filter(|later| code.contains(&format!("crate::{later}")));
                back.extend(later.map(|later| format!("{} imports {later}", path.display())));
            }
        }
    }
    assert!(back.is_empty(), "{back:#?}");
}
