//! Cases of the rough world.

use std::collections::BTreeSet;
use std::sync::OnceLock;

use aurt_lab::Strength;
use aurt_lab::case::{Case, CaseType, Plan, World};

const PLAN: &str = include_str!("rough_cases.toml");

fn cases() -> &'static [Case] {
    static CASES: OnceLock<Vec<Case>> = OnceLock::new();
    CASES.get_or_init(|| {
        let made = |k| Plan::parse(PLAN, "plan.toml").and_then(|plan| plan.make(World::Rough, 11, k));
        (0..6).map(|k| made(k).unwrap_or_else(|error| panic!("case {k}: {error}"))).collect()
    })
}

/// The same seed gives the same bytes, another one others; other worlds are not made here.
#[test]
fn the_seed_decides() {
    let plan = Plan::parse(PLAN, "plan.toml").unwrap();
    let made = |seed| plan.make(World::Rough, seed, 0).unwrap();
    let (first, again, other) = (made(4), made(4), made(5));
    assert_eq!((&first.files, &first.truth), (&again.files, &again.truth));
    assert_ne!(first.files, other.files);
    assert_ne!(first.files, plan.make(World::Clean, 4, 0).unwrap().files, "rough cases are clean ones");
    let text = plan.make(World::Mujoco, 4, 0).unwrap_err().to_string();
    assert!(text.contains("mujoco"), "{text}");
}

/// Every case neglects something, nulls too, and what it neglects is weaker than the weakest effect.
#[test]
fn what_is_neglected_is_below_the_effects() {
    for case in cases() {
        let truth = &case.truth;
        assert_eq!(truth.world, World::Rough);
        let law = |name: &str| !["torque_ripple", "dropped_samples"].contains(&name);
        let laws: Vec<_> = truth.background.iter().filter(|b| law(&b.effect)).collect();
        assert!(!laws.is_empty(), "{} neglects nothing", case.name);
        for neglected in laws {
            assert_eq!(neglected.present_in, ["calibration", "target"]);
            let largest = neglected.achieved.iter().fold(0.0_f64, |m, a| m.max(*a));
            assert!(largest > 0.02, "{} of {} is nothing: {largest}", neglected.effect, case.name);
            let weak = Strength::Weak.over_noise();
            assert!(largest < 1.2 * weak, "{} of {}: {largest}", neglected.effect, case.name);
        }
        if truth.case_type == CaseType::Single {
            let effect = truth.effects[0].achieved.iter().fold(0.0_f64, |m, a| m.max(*a));
            let neglected = truth.background.iter().flat_map(|b| &b.achieved).fold(0.0_f64, |m, a| m.max(*a));
            assert!(effect > 2.0 * neglected, "{}: {effect} against {neglected}", case.name);
        }
    }
}

/// A case's folder holds an experiment, its geometry and recordings, and no word of what is in them.
#[test]
fn nothing_tells_the_truth() {
    for case in cases() {
        let names: BTreeSet<&str> = case.files.iter().map(|(name, _)| name.as_str()).collect();
        let recordings = names.iter().filter(|name| name.starts_with("recording_")).count();
        assert_eq!(names.len(), recordings + 2, "{names:?}");
        assert!((1..=5).contains(&recordings));
        let text = |name: &str| {
            let content = &case.files.iter().find(|(n, _)| n == name).unwrap().1;
            String::from_utf8(content.clone()).unwrap()
        };
        let experiment = text("experiment.toml");
        let words = case.truth.effects.iter().chain(&case.truth.background).map(|e| e.effect.as_str());
        for word in words.chain(["null", "rough", "strong", "noise", "background", "seed"]) {
            assert!(!experiment.contains(word), "the experiment says `{word}`");
        }
        for name in names.iter().filter(|name| name.starts_with("recording_")) {
            assert!(experiment.contains(*name));
            let text = text(name);
            let header = text.lines().next().unwrap();
            assert!(header.starts_with("timestamp,actual_q_0,") && !header.contains("stribeck"), "{header}");
        }
        // Without a recording to validate with, the truth promises nothing of one.
        assert_eq!(case.truth.validation.is_empty(), !experiment.contains("validation"));
    }
}
