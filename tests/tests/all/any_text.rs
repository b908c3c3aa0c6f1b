//! Plans and scenarios that are almost right: refused or planned, never more.

use aurt::simulation::ScenarioFile;
use aurt_lab::case::Plan;
use proptest::prelude::*;

const SCENARIO: &str = "robot = \"two_link\"\nseed = 7\n[motion]\nkind = \"multi_sine\"\nduration_s = 5.0\nharmonics = 5\n\
                        top_hz = 0.8\nshare = 0.5\n[logger]\nrate_hz = 125\n[[link]]\nindex = 1\nmass_kg = 1.9\n[[effect]]\n\
                        name = \"current_offset\"\njoints = [1]\noffset_nm = [3.0]\n";
const PLAN: &str = "[singles]\nrobots = [\"ur10e\"]\neffects = [\"stribeck\"]\nstrengths = [\"medium\"]\ntrials = 2\n\
                    [pairs]\ncount = 3\n[nulls]\ncount = 3\n";

/// A text with one of its tokens replaced by another token, which it may have or not.
fn almost(text: &'static str) -> impl Strategy<Value = String> {
    let tokens: Vec<&str> = text.split_inclusive([' ', '\n', '[', ']', '"']).collect();
    let odd = prop_oneof![
        "[a-z_]{1,12}",
        any::<i64>().prop_map(|n| n.to_string()),
        any::<f64>().prop_map(|x| format!("{x:e}")),
        Just("nan".to_owned()),
        Just("18446744073709551615".to_owned()),
        Just("[[".to_owned()),
        "\\PC{0,8}",
    ];
    (0..tokens.len(), odd).prop_map(move |(at, odd)| {
        let mut tokens: Vec<String> = tokens.iter().map(|t| (*t).to_owned()).collect();
        let end: String = tokens[at].chars().filter(|c| " \n[]\"".contains(*c)).collect();
        tokens[at] = odd + &end;
        tokens.concat()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn scenarios(text in almost(SCENARIO)) {
        match ScenarioFile::parse(&text, "scenario.toml").and_then(|file| file.scenario()) {
            Ok(scenario) => prop_assert!(scenario.trajectory.duration_s().is_finite()),
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }

    #[test]
    fn plans(text in almost(PLAN)) {
        match Plan::parse(&text, "plan.toml") {
            Ok(plan) => prop_assert!(plan.requests(1).is_ok_and(|list| list.len() <= 1_000_000)),
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }
}
