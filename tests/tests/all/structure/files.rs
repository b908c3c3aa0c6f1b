//! Which file of a crate imports which, and in which circles.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::paths::Paths;

/// The modules of a crate with what their files name.
pub struct Modules(BTreeMap<Vec<String>, (PathBuf, Paths)>);

impl Modules {
    /// Reads all sources below a crate's `src`.
    pub fn read(src: &Path) -> Self {
        let mut modules = BTreeMap::new();
        for path in sources(src) {
            let inside = path.strip_prefix(src).unwrap().with_extension("");
            let mut module: Vec<String> =
                inside.iter().map(|part| part.to_string_lossy().into_owned()).collect();
            if ["mod", "lib", "main"].contains(&module.last().unwrap().as_str()) {
                module.pop();
            }
            // A file of tests alone is no part of the crate.
            if module.last().is_some_and(|name| name == "tests") {
                continue;
            }
            let paths = Paths::read(&std::fs::read_to_string(&path).unwrap(), &module);
            modules.insert(module, (inside, paths));
        }
        Self(modules)
    }

    /// The modules in whose files the item of a path is defined; re-exports are followed.
    fn owners(&self, path: &[String], seen: &mut BTreeSet<Vec<String>>) -> BTreeSet<&[String]> {
        let depth = (0..=path.len()).rev().find(|n| self.0.contains_key(&path[..*n])).unwrap_or(0);
        let Some((module, (_, paths))) = self.0.get_key_value(&path[..depth]) else { return BTreeSet::new() };
        let own = || BTreeSet::from([module.as_slice()]);
        let Some(name) = path.get(depth) else { return own() };
        if !seen.insert(path.to_vec()) || paths.defined.contains(name) {
            return own();
        }
        if let Some(target) = paths.imported.get(name) {
            let onwards = [target.as_slice(), &path[depth + 1..]].concat();
            return self.owners(&onwards, seen);
        }
        let found = paths.globs.iter().flat_map(|glob| {
            let inside = [glob.as_slice(), &path[depth..]].concat();
            let there = self.0.get(glob).is_some_and(|(_, p)| p.defined.contains(name));
            if there { self.owners(&inside, seen) } else { BTreeSet::new() }
        });
        let found: BTreeSet<_> = found.collect();
        // The first name of a path of another crate is found nowhere.
        if found.is_empty() && depth > 0 { own() } else { found }
    }

    fn imports(&self) -> Imports<'_> {
        let of = |(module, (_, paths)): (&_, &(PathBuf, Paths))| {
            let named = paths.named.iter().chain(&paths.globs);
            let owners = named.flat_map(|path| self.owners(path, &mut BTreeSet::new()));
            owners.filter(|owner| *owner != module).collect()
        };
        self.0.iter().map(|entry| (entry.0.as_slice(), of(entry))).collect()
    }

    /// Every file with each folder, or file, at the crate's root from which it imports.
    pub fn folders_imported(&self) -> BTreeSet<(String, String)> {
        let imports = self.imports();
        let pairs = imports.iter().flat_map(|(module, from)| {
            let file = self.0[*module].0.display().to_string();
            from.iter().filter_map(move |other| Some((file.clone(), other.first()?.clone())))
        });
        pairs.collect()
    }

    /// The circles in which files import one another, each as a chain of files. A `mod.rs` or `lib.rs` and its own children may
    /// import one another.
    pub fn circles(&self) -> Vec<String> {
        let mut open = vec![self.imports()];
        let mut circles = Vec::new();
        while let Some(imports) = open.pop() {
            for mut component in components(&imports) {
                let members: Vec<&[String]> = component.keys().copied().collect();
                if let Some(parent) = parent(&members) {
                    component.insert(parent, BTreeSet::new());
                    open.push(component);
                    continue;
                }
                let ways = members.iter().filter_map(|start| way_back(&component, start));
                let way = ways.min_by_key(|way| (parent(way).is_some(), way.len())).unwrap();
                let files = way.iter().chain(&way[..1]);
                let files: Vec<String> = files.map(|m| format!("{}.rs", self.0[*m].0.display())).collect();
                circles.push(files.join(" → "));
            }
        }
        circles
    }
}

type Imports<'a> = BTreeMap<&'a [String], BTreeSet<&'a [String]>>;

fn parent<'a>(members: &[&'a [String]]) -> Option<&'a [String]> {
    members.iter().copied().find(|module| members.iter().all(|other| other.starts_with(module)))
}

/// The sets of modules each of which leads to all others of its set, with what they import from one another.
fn components<'a>(imports: &Imports<'a>) -> Vec<Imports<'a>> {
    let reached: BTreeMap<&[String], BTreeSet<&[String]>> =
        imports.keys().map(|start| (*start, reached_from(imports, start))).collect();
    let mut components = Vec::new();
    let mut done: BTreeSet<&[String]> = BTreeSet::new();
    for (start, to) in &reached {
        if !to.contains(start) || done.contains(start) {
            continue;
        }
        let members: BTreeSet<&[String]> =
            to.iter().copied().filter(|m| reached.get(m).is_some_and(|back| back.contains(start))).collect();
        let inside = |m: &&'a [String]| (*m, imports[*m].intersection(&members).copied().collect());
        components.push(members.iter().map(inside).collect());
        done.extend(&members);
    }
    components
}

fn reached_from<'a>(imports: &Imports<'a>, start: &[String]) -> BTreeSet<&'a [String]> {
    let mut reached = BTreeSet::new();
    let mut open: Vec<&[String]> = imports[start].iter().copied().collect();
    while let Some(module) = open.pop() {
        if reached.insert(module) {
            open.extend(imports.get(module).into_iter().flatten());
        }
    }
    reached
}

/// The shortest way from a module back to itself.
fn way_back<'a>(imports: &Imports<'a>, start: &'a [String]) -> Option<Vec<&'a [String]>> {
    let mut from: BTreeMap<&[String], &[String]> = BTreeMap::new();
    let mut next = std::collections::VecDeque::from([start]);
    while let Some(module) = next.pop_front() {
        for other in imports.get(module).into_iter().flatten() {
            if *other == start {
                let mut way = vec![module];
                while way[way.len() - 1] != start {
                    way.push(from[way[way.len() - 1]]);
                }
                way.reverse();
                return Some(way);
            }
            if !from.contains_key(other) {
                from.insert(other, module);
                next.push_back(other);
            }
        }
    }
    None
}

pub fn sources(folder: &Path) -> Vec<PathBuf> {
    let (mut found, mut folders) = (Vec::new(), vec![folder.to_owned()]);
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}
