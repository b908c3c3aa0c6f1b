//! What counts and what costs, on verdicts that are written by hand.

use serde_json::{Value, json};

use super::*;
use crate::case::{TrueEffect, Truth};

fn truth(case_type: &str, effects: &[Value]) -> Truth {
    serde_json::from_value(json!({
        "case": "case_0001", "world": "rough", "seed": 123_456_789_u64, "robot": "ur10e", "rotors": "geared",
        "case_type": case_type, "strength": "medium", "effects": effects, "noise_nm": [0.1, 0.1, 0.1],
        "validation": [{ "recording": "r", "before_nm": [0.2, 0.1, 0.1], "floor_nm": [0.1, 0.1, 0.1] }],
    }))
    .unwrap()
}

fn effect(name: &str, joints: &[usize], present_in: &str) -> Value {
    json!({
        "effect": name, "family": "P", "in_vocabulary": true, "joints": joints, "present_in": [present_in],
        "recording": null, "window_s": null, "parameters": [["size", vec![2.0; joints.len()]]],
        "achieved": [1.0], "fields": {},
    })
}

fn claimed(name: &str, joints: &[usize], present_in: &str) -> Value {
    json!({ "effect": name, "joints": joints, "present_in": [present_in], "confidence": 0.9,
        "evidence": { "score": 80.0 } })
}

fn claim(word: &str, effects: &[Value]) -> Claim {
    serde_json::from_value(json!({ "verdict": word, "effects": effects })).unwrap()
}

fn spring() -> Truth {
    truth("single", &[effect("spring", &[2], "target")])
}

#[test]
fn all_parts_must_be_right_and_each_is_counted() {
    let of = |word: &str, effects: &[Value]| score(&spring(), &claim(word, effects), None, None);
    let right = claimed("spring", &[2], "target");
    let good = of("named", std::slice::from_ref(&right));
    assert!(good.right && good.first_label && good.anywhere && good.beside == 0);
    assert_eq!((good.joints_right, good.presence_right, good.joint_f1), (Some(true), Some(true), Some(1.0)));

    let word = of("unexplained", std::slice::from_ref(&right));
    assert!(!word.right && word.first_label && word.beside == 0);
    let joints = of("named", &[claimed("spring", &[1], "target")]);
    assert!(!joints.right && joints.first_label && joints.joints_right == Some(false) && joints.beside == 1);
    let presence = of("named", &[claimed("spring", &[2], "calibration")]);
    assert!(!presence.right && presence.first_label && presence.presence_right == Some(false));
    assert_eq!(presence.beside, 0);
    let second = of("named", &[claimed("payload", &[0, 1], "target"), right.clone()]);
    assert!(!second.right && !second.first_label && second.anywhere && second.beside == 1);
    assert!(!of("no_mismatch", &[]).right);
    assert!(!score(&spring(), &Claim::failed(), None, None).right);
}

/// A claim too many costs: as right or wrong, and counted, joint by joint.
#[test]
fn a_surplus_claim_costs() {
    let right = claimed("spring", &[2], "target");
    let beside = |surplus: Value| {
        let scored = score(&spring(), &claim("named", &[right.clone(), surplus]), None, None);
        assert!(!scored.right && scored.first_label, "{scored:?}");
        scored.beside
    };
    assert_eq!(beside(claimed("stribeck", &[0], "target")), 1);
    assert_eq!(beside(claimed("stribeck", &[0, 1, 2], "calibration")), 3);
    assert_eq!(beside(claimed("payload", &[0, 1, 2], "target")), 1, "a load is one thing on all joints");
    assert_eq!(beside(claimed("spring", &[2], "calibration")), 1, "it is not there twice");
    let wide = score(&spring(), &claim("named", &[claimed("spring", &[1, 2], "target")]), None, None);
    assert!(!wide.right && wide.beside == 1 && wide.joint_f1 == Some(2.0 / 3.0));
    let board =
        Scoreboard::of(&[score(&spring(), &claim("named", std::slice::from_ref(&right)), None, None), wide]);
    let rough = &board.worlds[&crate::case::World::Rough];
    assert_eq!(rough.beside, Some(0.5));
    assert_eq!(rough.singles[&crate::strength::Strength::Medium].right, Share { count: 1, of: 2 });
}

#[test]
fn a_class_is_right_with_the_truth_among_its_three() {
    let with = |alternatives: Value| {
        let mut first = claimed("torque_ripple", &[2], "target");
        first["alternatives"] = alternatives;
        first
    };
    let spring_too = json!([{ "effect": "viscous" }, { "effect": "spring", "joints": [2] }]);
    let class = score(&spring(), &claim("ambiguous", &[with(spring_too.clone())]), None, None);
    assert!(class.right && !class.first_label && class.with_alternatives && class.beside == 0, "{class:?}");
    // Being one of a class is a property of the claim; a program may have a verdict for it as well.
    let named = score(&spring(), &claim("named", &[with(spring_too.clone())]), None, None);
    assert!(named.right && !named.first_label && named.beside == 0, "{named:?}");
    let nameless = score(&spring(), &claim("unexplained", &[with(spring_too)]), None, None);
    assert!(!nameless.right && nameless.beside == 1, "{nameless:?}");
    let fourth = json!([{ "effect": "viscous" }, { "effect": "coulomb" }, { "effect": "spring" }]);
    assert!(!score(&spring(), &claim("ambiguous", &[with(fourth)]), None, None).right);
}

#[test]
fn inseparable_labels_are_wrong_strictly_and_right_as_a_class() {
    let offset = truth("single", &[effect("current_offset", &[1], "target")]);
    let scored = score(&offset, &claim("named", &[claimed("coulomb_asymmetry", &[1], "target")]), None, None);
    assert!(!scored.right && scored.right_class && !scored.first_label && scored.first_label_class);
    assert_eq!((scored.beside, scored.beside_class), (1, 0));
}

#[test]
fn the_background_and_the_reference_are_no_news() {
    let mut rough = spring();
    let undeclared: TrueEffect =
        serde_json::from_value(effect("presliding_hysteresis", &[0, 1], "calibration")).unwrap();
    rough.background = vec![undeclared];
    let right = claimed("spring", &[2], "target");
    let both = |joints: &[usize], present: &str| {
        let effects = [claimed("presliding_hysteresis", joints, present), right.clone()];
        score(&rough, &claim("named", &effects), None, None)
    };
    let declared = both(&[0, 1], "calibration");
    assert!(declared.right && declared.beside == 0 && declared.findings.iter().all(|f| f.hit));
    assert_eq!(both(&[0, 2], "calibration").beside, 1);
    assert_eq!(both(&[0], "target").beside, 1, "a background has not changed");

    let with = |effect: &str, joint: usize, alternative: &str| {
        let mut one = claimed(effect, &[joint], "calibration");
        one["alternatives"] = json!([{ "effect": alternative, "joints": [joint] }]);
        score(&rough, &claim("named", &[one, right.clone()]), None, None).beside
    };
    assert_eq!(with("stribeck", 0, "presliding_hysteresis"), 0, "it says that the background does as well");
    assert_eq!(with("stribeck", 0, "viscous"), 1);
    assert_eq!(with("stribeck", 2, "presliding_hysteresis"), 1, "there is none on this joint");

    let lost: TrueEffect =
        serde_json::from_value(effect("dropped_samples", &[0, 1, 2], "calibration")).unwrap();
    rough.background.push(lost);
    let rows = claim(
        "named",
        &[claimed("dropped_samples", &[0, 1, 2], "target"), claimed("spring", &[2], "target")],
    );
    assert_eq!(score(&rough, &rows, None, None).beside, 0, "which recordings lost rows is a fact of each");

    let before = claim("named", &[claimed("rotor_inertia", &[0, 1], "calibration")]);
    let after = claim("named", &[claimed("rotor_inertia", &[0, 1], "calibration"), right.clone()]);
    assert!(score(&spring(), &after, None, Some(&before)).right);
    assert!(!score(&spring(), &after, None, None).right);
    let rotor = truth("single", &[effect("rotor_inertia", &[1], "target")]);
    let came = claimed("rotor_inertia", &[1], "target");
    let beside = claim("named", &[came.clone(), claimed("rotor_inertia", &[0, 1], "calibration")]);
    let scored = score(&rotor, &beside, None, Some(&before));
    assert!(scored.right && scored.beside == 0, "what was claimed before is no news");
    assert_eq!(score(&rotor, &beside, None, None).beside, 2);
    let old = claim("named", &[right]);
    assert!(score(&spring(), &old, None, Some(&old)).known_before);
}

#[test]
fn a_null_is_flagged_by_what_is_news() {
    let null = truth("null", &[]);
    let play = [claimed("backlash", &[1], "calibration")];
    let flagged = score(&null, &claim("named", &play), None, None);
    assert!(!flagged.right && flagged.flagged_by == ["backlash"]);
    assert!(score(&null, &claim("named", &play), None, Some(&claim("named", &play))).right);
    assert_eq!(score(&null, &claim("unexplained", &[]), None, None).flagged_by, ["unexplained"]);
    assert_eq!(score(&null, &Claim::failed(), None, None).flagged_by, ["failed"]);
    assert!(score(&null, &claim("no_mismatch", &[]), None, None).right);
    let structure: Claim =
        serde_json::from_value(json!({ "verdict": "no_mismatch", "structure": "unexplained" })).unwrap();
    assert_eq!(score(&null, &structure, None, None).flagged_by, ["unexplained"]);
    // An undeclared background is missing, named or not; nothing has changed.
    let background = |name: &str, family: &str| {
        let mut one = effect(name, &[0, 1], "calibration");
        one["family"] = json!(family);
        Truth { background: vec![serde_json::from_value(one).unwrap()], ..truth("null", &[]) }
    };
    let stribeck = background("stribeck", "F");
    assert!(score(&stribeck, &structure, None, None).right);
    assert!(score(&stribeck, &claim("unexplained", &[]), None, None).right, "one question");
    let change: Claim =
        serde_json::from_value(json!({ "verdict": "unexplained", "structure": "no_mismatch" })).unwrap();
    assert_eq!(score(&stribeck, &change, None, None).flagged_by, ["unexplained"]);
    assert_eq!(score(&stribeck, &claim("named", &play), None, None).flagged_by, ["backlash"]);
    let wrong = Claim { structure: Some(Answer::Named), ..claim("no_mismatch", &play) };
    assert_eq!(score(&stribeck, &wrong, None, None).flagged_by, ["backlash"]);
    assert_eq!(score(&stribeck, &Claim::failed(), None, None).flagged_by, ["failed"]);
    let lost = background("dropped_samples", "Q");
    assert_eq!(score(&lost, &structure, None, None).flagged_by, ["unexplained"]);
}

/// Of real recordings nobody knows which structure is missing: their nulls have a truth for change alone.
#[test]
fn nulls_of_real_recordings_are_flagged_by_changes_alone() {
    let null = Truth { world: crate::case::World::Injected, ..truth("null", &[]) };
    let (spring, change) = (claimed("spring", &[2], "calibration"), claimed("payload", &[0], "target"));
    let said = |verdict: &str, structure: Option<Answer>, effects: &[Value]| Claim {
        structure,
        ..claim(verdict, effects)
    };
    let reference = said("no_mismatch", Some(Answer::Named), std::slice::from_ref(&spring));
    let of = |claim: &Claim| score(&null, claim, None, Some(&reference));
    let other = claimed("stribeck", &[1], "calibration");
    let structural = of(&said("no_mismatch", Some(Answer::Unexplained), std::slice::from_ref(&other)));
    assert!(structural.right && structural.beside == 0 && structural.named.is_empty());
    assert!(structural.findings.is_empty(), "there is nothing to learn of them");
    assert_eq!(structural.structure_agrees, Some(false));
    let both = of(&said("named", Some(Answer::Named), &[spring, change.clone()]));
    assert_eq!((both.structure_agrees, both.beside), (Some(true), 1));
    assert_eq!(both.flagged_by, ["payload"]);
    // A change that is claimed of other recordings as well is no truer.
    let changed = said("named", Some(Answer::NoMismatch), &[change]);
    assert!(!score(&null, &changed, None, Some(&changed)).right);
    assert_eq!(of(&said("unexplained", Some(Answer::NoMismatch), &[])).flagged_by, ["unexplained"]);
    assert_eq!(of(&Claim::failed()).flagged_by, ["failed"]);
    assert!(of(&said("named", None, &[other])).right, "one verdict on claims of the structure");
    let board = Scoreboard::of(&[structural, both]);
    let board = &board.worlds[&crate::case::World::Injected];
    assert_eq!((board.nulls_flagged.count, board.nulls_agree), (1, Share { count: 1, of: 2 }));
}

#[test]
fn two_words_answer_two_questions() {
    let effects = [claimed("payload", &[0], "target"), claimed("spring", &[2], "calibration")];
    let mut said = claim("named", &effects[..1]);
    said.structure = Some(Answer::Unexplained);
    let load = truth("single", &[effect("payload", &[0], "target")]);
    assert!(score(&load, &said, None, None).right, "an unexplained structure does not spoil a plain change");
    let structural = truth("single", &[effect("spring", &[2], "calibration")]);
    let mut both = claim("no_mismatch", &effects[1..]);
    both.structure = Some(Answer::Named);
    assert!(score(&structural, &both, None, None).right);
}

#[test]
fn pairs_need_both_first_and_removed_candidates_a_word() {
    let pair = truth("pair", &[effect("spring", &[2], "target"), effect("payload", &[0], "target")]);
    let said = [claimed("payload", &[0, 1], "target"), claimed("spring", &[2], "target")];
    assert!(score(&pair, &claim("named", &said), None, None).right);
    let third = [said[0].clone(), claimed("viscous", &[1], "target"), said[1].clone()];
    let late = score(&pair, &claim("named", &third), None, None);
    assert!(!late.right && !late.first_label && late.anywhere && late.beside == 1);
    let near = [claimed("torque_ripple", &[2], "target")];
    assert!(score(&spring(), &claim("named", &near), Some("spring"), None).right);
    assert!(score(&spring(), &claim("unexplained", &[]), Some("spring"), None).right);
    assert!(!score(&spring(), &claim("no_mismatch", &near), Some("spring"), None).right);
}

#[test]
fn deviations_cover_or_do_not_and_improvement_counts_when_the_name_is_wrong() {
    let with = |name: &str, value: f64| -> Claim {
        let mut one = claimed(name, &[2], "target");
        one["parameters"] = json!({ "size": { "value": value, "std": 0.1 } });
        serde_json::from_value(json!({ "verdict": "named", "effects": [one],
            "held_out": { "rms_before": [0.2, 0.1, 0.1], "rms_after": [0.1, 0.1, 0.1] } }))
        .unwrap()
    };
    let covered =
        |value: f64| score(&spring(), &with("spring", value), None, None).parameter_errors[0].is_covered();
    assert_eq!((covered(2.19), covered(2.21), covered(1.5)), (Some(true), Some(false), Some(false)));
    let wrong = score(&spring(), &with("payload", 1.0), None, None);
    assert!(!wrong.right && wrong.recovered == Some(1.0));
}

#[test]
fn a_coupling_is_compared_as_the_claim_names_it() {
    let names = ["partner", "ratio", "inertia_kg_m2", "viscous_nm_s", "coulomb_nm"];
    let mut coupling = truth("single", &[effect("joint_coupling_friction", &[0, 5], "target")]);
    let values = [5.0, -2.0, 0.1, 0.3, 0.2];
    coupling.effects[0].parameters =
        names.map(str::to_owned).into_iter().zip(values.map(|v| vec![v])).collect();
    let errors = |values: [f64; 5]| {
        let mut one = claimed("joint_coupling_friction", &[0, 5], "target");
        let of = |(name, value): (&str, f64)| (name.to_owned(), json!({ "value": value, "std": 0.01 }));
        one["parameters"] = names.into_iter().zip(values).map(of).collect();
        score(&coupling, &claim("named", &[one]), None, None).parameter_errors
    };
    assert!(errors(values).iter().all(|e| e.relative < 1e-12));
    // The same motor turns with joint 5: half as fast, and what acts on it there is larger.
    let other = errors([0.0, -0.5, 0.4, 1.2, 0.4]);
    assert!(other.len() == 4 && other.iter().all(|e| e.relative < 1e-12), "{other:?}");
    assert!(errors([0.0, -2.0, 0.1, 0.3, 0.2]).iter().all(|e| e.relative > 0.4));
}

#[test]
fn confidence_is_learnt_on_other_worlds() {
    let mut scores = Vec::new();
    for (world, right) in [("clean", true), ("rough", false)] {
        for case in 0..20 {
            let mut truth = spring();
            truth.world = crate::case::World::named(world).unwrap();
            truth.case = format!("case_{case}");
            let name = if right { "spring" } else { "payload" };
            scores.push(score(&truth, &claim("named", &[claimed(name, &[2], "target")]), None, None));
        }
    }
    let board = Scoreboard::of(&scores);
    let rough = &board.worlds[&crate::case::World::Rough];
    // Printed .9 and always wrong: .81; learnt where all was right (21/22): .911.
    assert!((rough.reliability.brier.unwrap() - 0.81).abs() < 1e-12);
    let elsewhere = rough.reliability_learnt_elsewhere.as_ref().unwrap();
    assert!((elsewhere.brier.unwrap() - (21.0_f64 / 22.0).powi(2)).abs() < 1e-12);
    let learnt = learnt(&[(crate::case::World::Clean, 7, &scores[..20])]);
    assert_eq!((learnt.learnt_from[0].hits, learnt.confidence.by.as_str()), (20, "score"));
    let text = board.markdown();
    assert!(text.contains("| what is counted | clean | rough |"), "{text}");
}

#[test]
fn a_truth_in_a_folder_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("experiment.toml", "[joint_dynamics]\ncoulomb = { model = \"none\" }\n");
    write("recording_1.csv", "t,q_0\n0.0,1e-3\n0.1,nan\n");
    assert_eq!(leaks(folder.path(), &spring()).unwrap(), Vec::<String>::new());
    for (name, text) in [
        ("experiment.toml", "# Spring on joint 2\n"),
        ("recording_2.csv", "t,q_0\n0.0,1.0\n# 123456789\n"),
        ("mdh.csv", "a,alpha # 123456789\n"),
        ("case_0001.json", "{}"),
        ("recording_3.csv", "t,achieved\n"),
    ] {
        let kept = std::fs::read_to_string(folder.path().join(name)).ok();
        write(name, text);
        assert_eq!(leaks(folder.path(), &spring()).unwrap().len(), 1, "{name}");
        match kept {
            Some(kept) => write(name, &kept),
            None => std::fs::remove_file(folder.path().join(name)).unwrap(),
        }
    }
    // Any experiment in amperes has the key; the identifier is no key.
    let mut gain = spring();
    gain.effects[0].effect = "torque_constant".into();
    for (text, found) in [("torque_constants_nm_per_a = [9.8]\n", 0), ("torque_constant = [9.8]\n", 1)] {
        write("experiment.toml", text);
        assert_eq!(leaks(folder.path(), &gain).unwrap().len(), found, "{text}");
    }
}
