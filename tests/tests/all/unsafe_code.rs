//! The inventory of `unsafe` in the documentation has every file that contains it, and no other.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
const INVENTORY: &str = "docs/reliability.md";

/// The words of a source text that are code: no comments, no texts.
fn words(source: &str) -> Vec<String> {
    let (mut found, mut word) = (Vec::new(), String::new());
    let characters: Vec<char> = source.chars().collect();
    let at = |k: usize| characters.get(k).copied().unwrap_or('\n');
    let mut k = 0;
    while k < characters.len() {
        let c = at(k);
        if c.is_alphanumeric() || c == '_' {
            word.push(c);
            k += 1;
            // `r"…"` and `r#"…"#`, where a backslash is a backslash.
            let raw = word == "r" || word == "br" || word == "cr";
            let hashes = (k..).take_while(|i| at(*i) == '#').count();
            if raw && at(k + hashes) == '"' {
                let end: String = std::iter::once('"').chain(std::iter::repeat_n('#', hashes)).collect();
                let rest: String = characters[k + hashes + 1..].iter().collect();
                k += hashes + 1 + rest[..rest.find(&end).unwrap()].chars().count() + end.len();
                word.clear();
            }
            continue;
        }
        if !word.is_empty() {
            found.push(std::mem::take(&mut word));
        }
        match c {
            '/' if at(k + 1) == '/' => k += (k..).take_while(|i| at(*i) != '\n').count(),
            '"' => {
                k += 1;
                while at(k) != '"' {
                    k += if at(k) == '\\' { 2 } else { 1 };
                }
                k += 1;
            }
            '\'' if at(k + 1) == '\\' => k += 3 + (k + 3..).take_while(|i| at(*i) != '\'').count(),
            '\'' if at(k + 2) == '\'' => k += 3,
            _ => k += 1,
        }
    }
    found.extend(Some(word).filter(|word| !word.is_empty()));
    found
}

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && path.file_name().is_some_and(|name| name != "target") {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn comments_and_texts_are_no_code() {
    let source = "fn a() { /* no */ } // unsafe\nlet b = \"unsafe \\\" unsafe\"; let c = r#\"unsafe\"unsafe\"#;\n\
                  let d = ['\"', '\\'', 'u']; unsafe { e::<'static>() }";
    assert_eq!(words(source).iter().filter(|word| *word == "unsafe").count(), 1, "{:?}", words(source));
}

#[test]
fn the_inventory_of_unsafe_code_is_complete() {
    let root = Path::new(ROOT);
    let mut files = Vec::new();
    let crates = fs::read_dir(root).unwrap().map(|entry| entry.unwrap().path());
    let crates = crates.filter(|path| path.file_name().unwrap().to_string_lossy().starts_with("aurt"));
    let others = ["examples", "python/src", "tests"].map(|folder| root.join(folder));
    for folder in crates.chain(others) {
        sources(&folder, &mut files);
    }
    let mut there = BTreeMap::new();
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let count = words(&text).iter().filter(|word| *word == "unsafe").count();
        if count > 0 {
            there.insert(file.strip_prefix(root).unwrap().to_str().unwrap().to_owned(), count);
        }
    }
    let inventory = fs::read_to_string(root.join(INVENTORY)).unwrap();
    let listed: BTreeMap<String, usize> = inventory
        .lines()
        .filter_map(|line| {
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            let file = cells.get(1)?.strip_prefix('`')?.strip_suffix('`')?;
            Some((file.to_owned(), cells.get(2)?.parse().ok()?))
        })
        .collect();
    assert!(there.len() > 10, "{there:?}");
    assert_eq!(listed, there, "left: {INVENTORY}; right: the sources");
}
