//! `aurt-lab setups`: a few right and wrong setups.

use crate::{lab::lab, support::Folder};

/// Right setups are not accused, and the mistakes of wrong ones are told; what was answered is not asked again.
#[test]
fn right_setups_are_not_accused_and_mistakes_are_told() {
    let folder = Folder::new();
    let count = ["setups", "--right", "3", "--wrong", "3", "--seed", "SEED", "--out", "counted"];
    let run = lab(&folder, count).succeeded();
    assert!(run.stdout().contains("0 of 3 right setups accused"), "{}", run.stdout());
    assert!(run.stdout().contains("| wrong (3) | 3 |"), "{}", run.stdout());
    let board = folder.json("counted/setups.json")["board"].clone();
    for answer in board["wrong"].as_array().unwrap() {
        let compared = answer["compared"].as_array().unwrap().last().unwrap();
        assert!(compared["across"]["gain"].as_f64() >= Some(0.15), "{answer}");
    }
    let answers = folder.path("counted/answers");
    std::fs::remove_file(answers.join("SEED_wrong_0002.json")).unwrap();
    let again = lab(&folder, count).succeeded();
    assert_eq!(again.stdout(), run.stdout());
}
