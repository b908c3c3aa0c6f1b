//! What the fuzzer found worth keeping (`fuzz/corpus`), and damaged copies of it, through everything that reads files.

use std::fs;
use std::path::Path;

use aurt::simulation::effects;
use aurt_plugins::Registry;
use aurt_tests::any_input::TARGETS;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
/// Damaged copies of all inputs of a target.
const DAMAGED: u32 = 200;

/// The inputs of a target: those that the fuzzer kept, and files of other tests.
fn inputs(target: &str) -> Vec<Vec<u8>> {
    let others: &[&str] = match target {
        "recording" => &["aurt-recording/tests/formats"],
        "robot" => &["aurt-rbd/tests/descriptions/reference"],
        _ => &[],
    };
    let kept = format!("fuzz/corpus/{target}");
    let folders = std::iter::once(kept.as_str()).chain(others.iter().copied());
    let files = folders.flat_map(|folder| fs::read_dir(Path::new(ROOT).join(folder)).unwrap());
    files
        .map(|file| file.unwrap().path())
        .filter(|path| path.is_file())
        .map(|path| fs::read(path).unwrap())
        .collect()
}

/// A copy of an input with a piece cut out, replaced, or doubled.
fn damaged(inputs: Vec<Vec<u8>>) -> impl Strategy<Value = Vec<u8>> {
    let piece = prop::collection::vec(any::<u8>(), 0..8);
    let edit = (any::<prop::sample::Index>(), 0..16_usize, piece, any::<bool>());
    (prop::sample::select(inputs), prop::collection::vec(edit, 1..4)).prop_map(|(mut bytes, edits)| {
        for (at, removed, piece, doubled) in edits {
            let from = at.index(bytes.len() + 1);
            let to = (from + removed).min(bytes.len());
            let piece = if doubled { bytes[from..to].to_vec().repeat(2) } else { piece };
            bytes.splice(from..to, piece);
        }
        bytes
    })
}

/// A model or effect that is new needs an input that names it.
#[test]
fn every_model_and_effect_has_an_input() {
    let named = |target: &str, name: &str| {
        let quoted = format!("\"{name}\"");
        inputs(target).iter().any(|input| String::from_utf8_lossy(input).contains(&quoted))
    };
    for model in Registry::linked().unwrap().models() {
        assert!(named("experiment", &model.name), "{}", model.name);
    }
    let kinds = effects::catalogue();
    assert!(kinds.len() > 20, "{kinds:?}");
    for kind in kinds {
        assert!(named("scenario", kind.identifier), "{}", kind.identifier);
    }
}

#[test]
fn every_input_is_read_or_refused() {
    for (name, target) in TARGETS {
        let inputs = inputs(name);
        assert!(!inputs.is_empty(), "{name} has no inputs");
        inputs.iter().for_each(|input| target(input));
        let mut runner = TestRunner::new(ProptestConfig {
            failure_persistence: None,
            ..ProptestConfig::with_cases(DAMAGED)
        });
        let all = inputs.len();
        runner
            .run(&damaged(inputs), |input| {
                target(&input);
                Ok(())
            })
            .unwrap();
        println!("{name}: {all} inputs, {DAMAGED} damaged copies");
    }
}
