//! The files that an experiment names, written so that another folder finds them.

use std::path::{Component, Path, PathBuf};

use aurt_files::escaped;
use toml_edit::{DocumentMut, Item, Value};

use crate::error::DiagnosisError;

/// Keys whose strings, alone, in a list or under `file` in a table of a list, name files.
const KEYS: [(&str, &[&str]); 4] = [
    ("robot", &["mdh", "mjcf", "urdf"]),
    ("plugins", &["libraries"]),
    ("recordings", &["calibration", "validation", "target", "simulated"]),
    // The recordings in which a term acts, by the names that `[recordings]` gives them.
    ("arm_terms", &["recordings"]),
];

/// Keys of a recording's table that name files: its own and those joined to it.
const FILES: [&str; 2] = ["file", "joined"];

/// Stands for a variable's `$` while a name is rewritten; no file name has this character of Unicode's private use area.
const VARIABLE: char = '\u{f8fe}';

/// The experiment with every relative file name replaced by what `rewrite` makes of it; comments and order are kept.
/// Names that begin with an environment variable say themselves where they are and stay, as do absolute ones.
///
/// # Errors
/// [`DiagnosisError::Improvement`] if the text is no TOML.
pub fn with_file_names(source: &str, rewrite: &dyn Fn(&Path) -> PathBuf) -> Result<String, DiagnosisError> {
    let mut document: DocumentMut =
        source.parse().map_err(|e| DiagnosisError::Improvement { reason: format!("{e}") })?;
    for (section, keys) in KEYS {
        let Some(section) = document.get_mut(section) else { continue };
        match section {
            Item::ArrayOfTables(tables) => {
                for table in tables.iter_mut() {
                    for key in keys {
                        if let Some(item) = table.get_mut(key) {
                            names(item, rewrite);
                        }
                    }
                }
            }
            Item::Value(Value::Array(tables)) => {
                for table in tables.iter_mut().filter_map(Value::as_inline_table_mut) {
                    for key in keys {
                        if let Some(value) = table.get_mut(key) {
                            name(value, rewrite);
                        }
                    }
                }
            }
            other => {
                let Some(table) = other.as_table_like_mut() else { continue };
                for key in keys {
                    if let Some(item) = table.get_mut(key) {
                        names(item, rewrite);
                    }
                }
            }
        }
    }
    Ok(document.to_string())
}

fn names(item: &mut Item, rewrite: &dyn Fn(&Path) -> PathBuf) {
    match item {
        Item::Value(value) => name(value, rewrite),
        Item::ArrayOfTables(tables) => {
            for table in tables.iter_mut() {
                FILES
                    .iter()
                    .for_each(|key| table.get_mut(key).into_iter().for_each(|item| names(item, rewrite)));
            }
        }
        Item::Table(_) | Item::None => {}
    }
}

fn name(value: &mut Value, rewrite: &dyn Fn(&Path) -> PathBuf) {
    match value {
        Value::String(text) => {
            let written = Path::new(text.value());
            if text.value().starts_with('$') || !written.is_relative() {
                return;
            }
            // A `$` of the name as written is a variable's; those that folders bring along stand for themselves.
            let variables = text.value().replace('$', &VARIABLE.to_string());
            let moved = escaped(&rewrite(Path::new(&variables)).to_string_lossy());
            let mut moved = Value::from(moved.replace(VARIABLE, "$"));
            *moved.decor_mut() = text.decor().clone();
            *value = moved;
        }
        Value::Array(list) => list.iter_mut().for_each(|item| name(item, rewrite)),
        Value::InlineTable(table) => {
            FILES.iter().for_each(|key| table.get_mut(key).into_iter().for_each(|item| name(item, rewrite)));
        }
        _ => {}
    }
}

/// The way from a folder to a file, both absolute and without links: `../monday.csv`. Where they have nothing but the root
/// in common, the file's own path, which a move of either does not break.
pub fn from_folder(folder: &Path, file: &Path) -> PathBuf {
    let (from, to): (Vec<Component<'_>>, Vec<Component<'_>>) =
        (folder.components().collect(), file.components().collect());
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if !to[..common].iter().any(|c| matches!(c, Component::Normal(_))) {
        return file.to_owned();
    }
    let up = from[common..].iter().map(|_| Component::ParentDir);
    up.chain(to[common..].iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_name_moves_and_nothing_else() {
        let source = "schema = 1 # mdh.csv\n[robot]\nmdh = \"mdh.csv\" # the arm\n[plugins]\nlibraries = [\"a.so\"]\n\
                      [recordings]\ncalibration = [\"a.csv\", { file = \"b.csv\", window_s = [0.0, 1.0] }]\n\
                      validation = [\"$DATA/c.csv\", \"/d.csv\"]\n\
                      [[arm_terms]]\nmodel = \"payload\"\nrecordings = [\"a.csv\"]\n";
        let moved = with_file_names(source, &|p| Path::new("..").join(p)).unwrap();
        let expected = "schema = 1 # mdh.csv\n[robot]\nmdh = \"../mdh.csv\" # the arm\n[plugins]\nlibraries = [\"../a.so\"]\n\
                        [recordings]\ncalibration = [\"../a.csv\", { file = \"../b.csv\", window_s = [0.0, 1.0] }]\n\
                        validation = [\"$DATA/c.csv\", \"/d.csv\"]\n\
                        [[arm_terms]]\nmodel = \"payload\"\nrecordings = [\"../a.csv\"]\n";
        assert_eq!(moved, expected);
        let tables = "[[recordings.target]]\nfile = \"a.csv\"\n";
        let moved = with_file_names(tables, &|p| Path::new("x").join(p)).unwrap();
        assert!(moved.contains("file = \"x/a.csv\""), "{moved}");
        let moved =
            with_file_names("[robot]\nmdh = \"a/$B/$$c.csv\"\n", &|p| Path::new("/of $5").join(p)).unwrap();
        assert_eq!(moved, "[robot]\nmdh = \"/of $$5/a/$B/$$c.csv\"\n");
        assert!(with_file_names("= 1", &Path::to_owned).is_err());
    }

    #[test]
    fn ways_go_up_and_down_but_not_over_the_root() {
        let way = |a: &str, b: &str| from_folder(Path::new(a), Path::new(b)).display().to_string();
        assert_eq!(way("/home/r/out", "/home/r/monday.csv"), "../monday.csv");
        assert_eq!(way("/home/r", "/home/r/data/monday.csv"), "data/monday.csv");
        assert_eq!(way("/tmp/out", "/home/r/monday.csv"), "/home/r/monday.csv");
    }
}
