//! Whatever an experiment's text is, reading it gives an experiment or problems, and every problem can be shown.

use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use aurt_experiment::Experiment;
use aurt_plugins::Registry;
use aurt_plugins::model::model_file;
use proptest::prelude::*;
use proptest::sample::Index;
use serde_json::{Value, json};
use tempfile::TempDir;

const TEXT: &str = include_str!("experiments/any.toml");

fn folder() -> &'static Path {
    static FOLDER: OnceLock<TempDir> = OnceLock::new();
    FOLDER
        .get_or_init(|| {
            let folder = TempDir::new().unwrap();
            fs::write(folder.path().join("mdh.csv"), "alpha,a,d\n0,0.5,0\n0,0.4,0\n").unwrap();
            fs::write(folder.path().join("ä.csv"), "").unwrap();
            folder
        })
        .path()
}

fn parse(text: &str) -> Result<Experiment, Box<aurt_experiment::ExperimentErrors>> {
    Experiment::parse(text, &folder().join("e.toml"), &mut Registry::linked().unwrap())
}

fn inside(value: &Value, pointer: String, found: &mut Vec<String>) {
    match value {
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, v)| inside(v, format!("{pointer}/{i}"), found));
        }
        Value::Object(entries) => {
            entries.iter().for_each(|(key, v)| inside(v, format!("{pointer}/{key}"), found));
        }
        _ => {}
    }
    found.push(pointer);
}

fn any_value() -> impl Strategy<Value = Value> {
    let odd = json!([null, true, -1, 3, u64::MAX, 1e308, "ZZ_1", [], {}, { "model": "sign" }]);
    prop::sample::select(odd.as_array().unwrap().clone())
}

/// A few of the text's pieces replaced by others: what slips of the hand look like.
fn changed() -> impl Strategy<Value = String> {
    let slips =
        ["\"", "[", "]\n", " = ", "nan", "-1e400", "99999999999999999999", "model = 3", "${", "${ÄÖ}"];
    let library = "[plugins]\nlibraries = [\"ä.csv\", 3]\n";
    let slips = prop::sample::select([&slips[..], &[library]].concat()).prop_map(str::to_owned);
    let pieces = prop_oneof![11 => slips, 1 => "\\PC{0,8}"];
    let edit = (0..TEXT.len(), 0..12_usize, pieces);
    prop::collection::vec(edit, 1..4).prop_map(|edits| {
        edits.into_iter().fold(TEXT.to_owned(), |text, (at, removed, piece)| {
            let boundary =
                |i: usize| (0..=i.min(text.len())).rev().find(|i| text.is_char_boundary(*i)).unwrap();
            let (from, to) = (boundary(at), boundary(at + removed));
            format!("{}{piece}{}", &text[..from], &text[to..])
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn every_problem_has_its_place(text in changed()) {
        if let Err(errors) = parse(&text) {
            prop_assert!(!errors.problems.is_empty());
            prop_assert_eq!(&errors.source_text, &text);
            for problem in &errors.problems {
                prop_assert!(text.get(problem.span.clone()).is_some(), "{:?} of {:?}", problem.span, text);
                prop_assert!(problem.line >= 1 && problem.line <= text.lines().count() + 1);
                prop_assert!(problem.column >= 1);
                prop_assert!(!problem.message.is_empty());
            }
            prop_assert!(errors.problems.is_sorted_by_key(|p| p.span.start));
        }
    }

    #[test]
    fn a_changed_model_file_is_read_or_refused_at_its_place(place in any::<Index>(), value in any_value()) {
        static SAVED: OnceLock<Value> = OnceLock::new();
        let saved =
            SAVED.get_or_init(|| model_file::robot_model_to_json(&parse(TEXT).unwrap().robot_model().unwrap()).unwrap());
        let mut pointers = Vec::new();
        inside(saved, String::new(), &mut pointers);
        let mut changed = saved.clone();
        let pointer: &String = place.get(&pointers);
        *changed.pointer_mut(pointer).unwrap() = value;
        let text = serde_json::to_string_pretty(&changed).unwrap();
        let registry = Registry::linked().unwrap();
        if let Err(error) = model_file::robot_model_from_json(&changed, &registry) {
            let error = error.in_file(Path::new("m.json"), &text, &[]);
            let aurt_plugins::model::Error::ModelFile { line, column, .. } = error else {
                return Err(TestCaseError::fail(error.to_string()));
            };
            prop_assert!(line >= 1 && line <= text.lines().count() && column >= 1);
        }
    }
}
