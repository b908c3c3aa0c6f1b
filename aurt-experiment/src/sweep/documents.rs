//! Experiments as TOML documents: paths made absolute, places found again.

use std::path::{Path, PathBuf};

use aurt_files::escaped;
use aurt_plugins::Span;
use toml::de::{DeTable, DeValue};
use toml::{Table, Value};

/// Makes the relative paths of an experiment absolute, so that it means the same from any folder. Paths that begin with
/// an environment variable stay as they are.
pub(crate) fn make_absolute(document: &mut Table, folder: &Path) {
    // The folder of a bare file name is the empty path, which has no canonical form.
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    // What is written is read again, and a `$` of the folder's name is no variable then.
    let folder = PathBuf::from(escaped(&folder.to_string_lossy()));
    let fix = |value: &mut Value| {
        if let Value::String(text) = value
            && !text.starts_with('$')
            && Path::new(text.as_str()).is_relative()
        {
            *text = folder.join(&*text).to_string_lossy().into_owned();
        }
    };
    let section = |document: &mut Table, name: &str, key: &str| {
        let Some(value) = document.get_mut(name).and_then(|s| s.get_mut(key)) else { return };
        match value {
            Value::Array(items) => items.iter_mut().for_each(|item| each_file(item, &fix)),
            other => each_file(other, &fix),
        }
    };
    for (name, key) in [
        ("robot", "mdh"),
        ("robot", "mjcf"),
        ("robot", "urdf"),
        ("plugins", "libraries"),
        ("recordings", "calibration"),
        ("recordings", "validation"),
        ("recordings", "target"),
        ("recordings", "simulated"),
    ] {
        section(document, name, key);
    }
}

/// The paths in a recording: the value itself, or its `file` and those of the files `joined` to it.
fn each_file(value: &mut Value, fix: &dyn Fn(&mut Value)) {
    let Value::Table(table) = value else { return fix(value) };
    if let Some(file) = table.get_mut("file") {
        fix(file);
    }
    match table.get_mut("joined") {
        Some(Value::Array(items)) => items.iter_mut().for_each(|item| each_file(item, fix)),
        Some(other) => each_file(other, fix),
        None => {}
    }
}

/// The way to what stands at `span` of a text: the deepest key or value that lies there.
pub(crate) fn path_at(text: &str, span: &Span) -> Vec<String> {
    let (table, _) = DeTable::parse_recoverable(text);
    let mut best = (usize::MAX, Vec::new());
    search_table(table.get_ref(), span, &mut Vec::new(), &mut best);
    best.1
}

fn search_table(table: &DeTable<'_>, span: &Span, way: &mut Vec<String>, best: &mut (usize, Vec<String>)) {
    for (key, value) in table {
        way.push(key.get_ref().to_string());
        consider(&key.span(), span, way, best);
        consider(&value.span(), span, way, best);
        search_value(value.get_ref(), span, way, best);
        way.pop();
    }
}

fn search_value(value: &DeValue<'_>, span: &Span, way: &mut Vec<String>, best: &mut (usize, Vec<String>)) {
    match value {
        DeValue::Table(table) => search_table(table, span, way, best),
        DeValue::Array(list) => {
            for (k, item) in list.iter().enumerate() {
                way.push(k.to_string());
                consider(&item.span(), span, way, best);
                search_value(item.get_ref(), span, way, best);
                way.pop();
            }
        }
        _ => {}
    }
}

/// Takes `way` for the answer if what lies at `here` holds `span` more tightly than the best so far; of two that hold
/// it alike, the deeper one.
fn consider(here: &Span, span: &Span, way: &[String], best: &mut (usize, Vec<String>)) {
    let holds = here.start <= span.start && span.end <= here.end;
    let size = here.end - here.start;
    if holds && (size < best.0 || (size == best.0 && way.len() > best.1.len())) {
        *best = (size, way.to_vec());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_to_a_place_in_a_text_is_found() {
        let text =
            "[joint_dynamics]\ncoulomb = { model = \"x\" }\n[[arm_terms]]\nmodel = \"y\"\njoints = [0, 9]\n";
        let way = |what: &str| {
            let start = text.find(what).unwrap();
            path_at(text, &(start..start + what.len())).join(".")
        };
        assert_eq!(way("\"x\""), "joint_dynamics.coulomb.model");
        assert_eq!(way("coulomb"), "joint_dynamics.coulomb");
        assert_eq!(way("9"), "arm_terms.0.joints.1");
        assert_eq!(way("{ model = \"x\" }"), "joint_dynamics.coulomb");
    }

    #[test]
    fn paths_become_absolute_unless_a_variable_leads_them() {
        let mut document: Table = toml::from_str(
            "[robot]\nmdh = \"a.csv\"\n[recordings]\ncalibration = [\"$D/b.csv\", { file = \"c.csv\" }]\nvalidation = \"/d.csv\"",
        )
        .unwrap();
        let above = tempfile::tempdir().unwrap();
        let folder = above.path().join("of $5");
        std::fs::create_dir(&folder).unwrap();
        make_absolute(&mut document, &folder);
        let folder = folder.canonicalize().unwrap();
        let here = |name: &str| folder.join(name).to_string_lossy().replace('$', "$$");
        assert_eq!(document["robot"]["mdh"].as_str(), Some(&*here("a.csv")));
        assert_eq!(document["recordings"]["calibration"][0].as_str(), Some("$D/b.csv"));
        assert_eq!(document["recordings"]["calibration"][1]["file"].as_str(), Some(&*here("c.csv")));
        assert_eq!(document["recordings"]["validation"].as_str(), Some("/d.csv"));

        let mut beside: Table = toml::from_str("robot.mdh = \"Cargo.toml\"").unwrap();
        make_absolute(&mut beside, Path::new(""));
        assert!(Path::new(beside["robot"]["mdh"].as_str().unwrap()).is_absolute());
    }
}
