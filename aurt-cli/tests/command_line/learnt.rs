//! `aurt diagnose --learnt`: where confidence comes from.

use crate::support::Folder;

/// What confidence is made of can be given; a file that cannot be used says why.
#[test]
fn confidence_comes_from_the_file_that_is_given() {
    let plan = "[recordings]\nduration_s = 15.0\n[singles]\nrobots = ['two_link']\neffects = ['spring']\n\
        strengths = ['strong']\ntrials = 1\n";
    let folder = Folder::new().with_concealed(plan, 2);
    let learnt = |rate: f64| {
        format!(
            r#"{{"schema": 1, "learnt_from": [], "confidence": {{"by": "score", "curves": {{"score": [[1.0, {rate}]]}}}},
                "ambiguous": {{"findings": 0, "hits": 0}}}}"#
        )
    };
    folder.write("learnt.json", &learnt(0.625));
    folder.write("wrong.json", &learnt(6.25));
    let diagnose = |file: &str| {
        let arguments = ["diagnose", "cases/case_0001/experiment.toml", "--verdict-only", "--out", "said"];
        folder.aurt(arguments.into_iter().chain(["--learnt", file]))
    };
    assert_eq!(diagnose("learnt.json").status(), 1);
    let effects = folder.json("said/verdict.json")["effects"].as_array().unwrap().clone();
    let sure: Vec<f64> = effects
        .iter()
        .filter(|e| e["alternatives"].as_array().unwrap().is_empty())
        .map(|e| e["confidence"].as_f64().unwrap())
        .collect();
    assert!(!effects.is_empty() && sure.iter().all(|c| *c == 0.625), "{effects:#?}");
    let wrong = diagnose("wrong.json");
    assert_eq!(wrong.status(), 2);
    assert!(wrong.stderr().contains("between 0 and 1"), "{}", wrong.stderr());
}
