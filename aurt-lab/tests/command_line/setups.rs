//! `aurt-lab setups`: a few right and wrong setups.

use crate::lab::lab;
use crate::support::Folder;

/// Right setups are not accused, and signs that are wrong are told; what was answered is not asked again.
#[test]
fn right_setups_are_not_accused_and_mistakes_are_told() {
    let folder = Folder::new();
    let count = ["setups", "--right", "2", "--wrong", "3", "--seed", "23", "--out", "counted"];
    let run = lab(&folder, count).succeeded();
    assert!(run.stdout().contains("0 of 2 right setups accused"), "{}", run.stdout());
    let board = folder.json("counted/setups.json")["board"].clone();
    for answer in &board["wrong"].as_array().unwrap()[1..] {
        assert_eq!(answer["outcome"], "told", "{answer:#}");
        assert!(answer["mistake"][0].as_str().unwrap().ends_with("with the other sign"), "{answer:#}");
    }
    let answers = folder.path("counted/answers");
    assert_eq!(std::fs::read_dir(&answers).unwrap().count(), 5);
    std::fs::remove_file(answers.join("23_wrong_0002.json")).unwrap();
    let again = lab(&folder, count).succeeded();
    assert_eq!(again.stdout(), run.stdout());
}
