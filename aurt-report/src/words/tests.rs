//! Sentences of made-up verdicts.

use aurt_diagnosis::{Evidence, HeldOut, HeldOutDifference, ParameterValue, VisibleGear};
use aurt_traits::MeasurementUnit;

use super::*;

pub(crate) fn finding(effect: &str, family: Family, joints: &[usize], present_in: &[&str]) -> Finding {
    let only = if present_in == ["target"] { ", in the target recordings only" } else { "" };
    Finding {
        effect: effect.into(),
        family,
        joints: joints.into(),
        present_in: present_in.iter().map(|k| (*k).to_owned()).collect(),
        recording: None,
        window_s: None,
        confidence: 0.9,
        parameters: std::collections::BTreeMap::new(),
        alternatives: Vec::new(),
        evidence: Evidence { score: 50.0, threshold: 8.0, ..Evidence::default() },
        sentence: format!("{effect}{only} (k = 1)"),
    }
}

pub(crate) fn residual(joint: usize, rms: f64, structure_left: bool) -> JointResidual {
    JointResidual {
        joint,
        baseline_rms: rms,
        unexplained_rms: rms,
        floor_rms: 0.1,
        structure_left,
        follows: None,
        follows_share: 0.0,
        windows_s: Vec::new(),
    }
}

pub(crate) fn verdict(answer: Answer, effects: Vec<Finding>, before: &[f64], after: &[f64]) -> Verdict {
    Verdict {
        schema: aurt_diagnosis::SCHEMA,
        settings: aurt_diagnosis::SelectionOptions::default(),
        explained: None,
        remainder: Vec::new(),
        joint_names: Vec::new(),
        link_names: Vec::new(),
        gears_visible: Vec::new(),
        unit: MeasurementUnit::NewtonMetre,
        verdict: answer,
        structure: None,
        effects,
        indications: Vec::new(),
        not_examined: Vec::new(),
        not_decidable: Vec::new(),
        residual: Vec::new(),
        held_out_differs: Vec::new(),
        held_out: HeldOut {
            recordings: vec!["a.csv".into()],
            rms_before: before.into(),
            rms_after: after.into(),
            rms_floor: vec![0.1; before.len()],
        },
        shifts: Vec::new(),
        registered_models: Vec::new(),
        warnings: Vec::new(),
        notes: Vec::new(),
    }
}

#[test]
fn an_unchanged_target_is_said_to_be_unchanged_whatever_the_structure_lacks() {
    let lacking = finding("stribeck", Family::F, &[1], &["calibration", "target"]);
    let mut found = verdict(Answer::NoMismatch, vec![lacking], &[1.0, 1.0], &[1.0, 0.5]);
    found.structure = Some(Answer::Named);
    assert!(headline(&found, Asked::Change).starts_with("nothing has changed"));
    let groups = groups(&found, Asked::Change);
    let seen: Vec<(&str, usize)> = groups.iter().map(|g| (g.title, g.findings.len())).collect();
    assert_eq!(seen, [("changed in the target", 0), ("missing in all recordings", 1)]);
    // Without a target there is nothing that could have changed.
    found.verdict = Answer::Named;
    assert_eq!(headline(&found, Asked::Lack), "the model lacks Stribeck friction on joint 1");
    let alone = super::groups(&found, Asked::Lack);
    assert_eq!((alone.len(), alone[0].title), (1, ""));
}

#[test]
fn changes_stand_apart_from_what_is_missing_and_from_faults() {
    let effects = vec![
        finding("dropped_samples", Family::Q, &[0], &["target"]),
        finding("payload", Family::I, &[0, 1], &["target"]),
        finding("stribeck", Family::F, &[1], &["calibration", "target"]),
    ];
    let found = verdict(Answer::Named, effects, &[1.0, 1.0], &[0.4, 0.5]);
    let groups = groups(&found, Asked::Change);
    let seen: Vec<(Place, usize)> = groups.iter().map(|g| (g.place, g.findings[0].0)).collect();
    assert_eq!(seen, [(Place::Changed, 2), (Place::Missing, 3), (Place::Fault, 1)]);
    assert_eq!(
        headline(&found, Asked::Change),
        "changed since calibration: a load of undetermined mass on a link; in all recordings the model lacks Stribeck friction on joint 1"
    );
    let mut removed = found.clone();
    let number = |value: f64| ParameterValue { value: value.into(), std: serde_json::Value::Null };
    removed.effects[1].parameters.insert("mass_kg".into(), number(-2.764));
    removed.effects[1].parameters.insert("link".into(), number(5.0));
    let said = "changed since calibration: a load of 2.764 kg removed from link 5";
    assert!(headline(&removed, Asked::Change).starts_with(said));
    assert_eq!(claim(groups[0].findings[0].1, Asked::Change), "payload (k = 1)");
    let nothing = verdict(Answer::NoMismatch, Vec::new(), &[0.1], &[0.1]);
    assert!(headline(&nothing, Asked::Change).starts_with("nothing has changed"));
    assert!(!headline(&nothing, Asked::Lack).contains("changed"));
}

#[test]
fn a_change_beyond_chance_that_held_out_data_do_not_confirm_is_no_all_clear() {
    let mut found = verdict(Answer::NoMismatch, Vec::new(), &[0.1], &[0.1]);
    let mut of = finding("coulomb", Family::F, &[3], &["target"]);
    (of.evidence.p_null, of.evidence.p_confirm) = (Some(1e-9), Some(0.4));
    let fails = vec!["chance alone makes such a finding with a probability of 0.4".to_owned()];
    found.indications.push(Indication { finding: of, fails, usual: false });
    let said = headline(&found, Asked::Change);
    assert!(
        said.starts_with("no change is confirmed: the target indicates") && said.contains("joint 3"),
        "{said}"
    );
    assert!(said.contains("which fails a test; nothing is missing"), "{said}");
    assert_eq!(nothing(&found), "nothing that is confirmed");
    assert_ne!(NoiseReport::of(&found).tone(&found, Asked::Change), crate::Tone::Good);
    // Evidence that fails another test, or that too few rows could confirm, is no all-clear, either.
    for p_confirm in [Some(0.01), None] {
        found.indications[0].finding.evidence.p_confirm = p_confirm;
        assert!(headline(&found, Asked::Change).starts_with("no change is confirmed"));
    }
    // One of many days is none, and is told.
    found.indications[0].usual = true;
    assert!(headline(&found, Asked::Change).starts_with("nothing has changed by more than"));
    assert_eq!(nothing(&found), "nothing by more than is usual");
    found.indications[0].usual = false;
    // A change that chance explains is none.
    found.indications[0].finding.evidence.p_null = Some(0.2);
    assert!(headline(&found, Asked::Change).starts_with("nothing has changed"));
    assert_eq!(nothing(&found), "nothing");
}

#[test]
fn what_held_out_data_contradict_is_contradicted_beside_the_claim() {
    let effects = vec![
        finding("viscous", Family::V, &[0], &["target"]),
        finding("coulomb", Family::F, &[1, 2], &["target"]),
    ];
    let found = verdict(Answer::Named, effects, &[1.67, 1.0, 1.0], &[2.08, 0.9, 1.2]);
    let said = objection(&found, &found.effects[0], "Nm").unwrap();
    assert!(said.contains("joint 0 (1.67 → 2.08 Nm)") && !said.contains("others"), "{said}");
    let said = objection(&found, &found.effects[1], "Nm").unwrap();
    assert!(said.contains("joint 2") && said.contains("not on the others"), "{said}");
    assert!(headline(&found, Asked::Change).ends_with("predicted worse with it"));
    let held = verdict(Answer::Named, found.effects.clone(), &[1.67, 1.0, 1.0], &[1.0, 0.9, 0.8]);
    assert_eq!(objection(&held, &held.effects[0], "Nm"), None);
    assert!(!headline(&held, Asked::Change).contains("worse"));
}

#[test]
fn a_headline_names_changes_first_then_what_is_missing_each_by_its_evidence() {
    let with_score = |score: f64, mut of: Finding| {
        of.evidence.score = score;
        of
    };
    let both = ["calibration", "target"];
    let effects = vec![
        with_score(10.0, finding("viscous", Family::V, &[0], &both)),
        with_score(90.0, finding("stribeck", Family::F, &[1], &both)),
        with_score(20.0, finding("coulomb", Family::F, &[2], &["target"])),
        with_score(80.0, finding("torque_constant", Family::D, &[0], &["target"])),
        with_score(999.0, finding("external_contact", Family::X, &[0], &["calibration"])),
    ];
    let mut found = verdict(Answer::Named, effects, &[1.0; 3], &[0.5; 3]);
    found.structure = Some(Answer::PartlyExplained);
    let title =
        |id: &str| effects::find(id).map_or("", |e| e.title).split(" (").next().unwrap_or("").to_owned();
    assert_eq!(
        headline(&found, Asked::Change),
        format!(
            "changed since calibration: {} on joint 0, and {} on joint 2; in all recordings the model lacks {} on joint 1, and {} on \
             joint 0, and something that no claim explains",
            title("torque_constant"),
            title("coulomb"),
            title("stribeck"),
            title("viscous")
        )
    );
}

#[test]
fn a_finding_in_the_calibration_recordings_alone_is_no_change_since_calibration() {
    let alone = vec![finding("external_contact", Family::X, &[0], &["calibration"])];
    for answer in [Answer::NoMismatch, Answer::Named, Answer::PartlyExplained, Answer::Unexplained] {
        let found = verdict(answer, alone.clone(), &[1.0], &[0.1]);
        let said = headline(&found, Asked::Change);
        assert!(!said.contains("changed since calibration"), "{answer:?}: {said}");
    }
    let found = verdict(Answer::Named, alone, &[1.0], &[0.1]);
    assert!(
        headline(&found, Asked::Change).starts_with("in the calibration recordings and not in the target: ")
    );
}

#[test]
fn held_out_data_of_another_state_come_before_all_else() {
    let mut found = verdict(Answer::HeldOutDiffers, Vec::new(), &[0.1, 6.6], &[0.1, 6.6]);
    found.held_out_differs = vec![HeldOutDifference { joint: 1, rms: 6.6, expected_rms: 0.1 }];
    let said = headline(&found, Asked::Lack);
    assert!(
        said.starts_with(
            "the held-out data (a.csv) differ from the fitted ones on joint 1 (66.0 times the expected error)"
        ),
        "{said}"
    );
    assert!(!said.contains("nothing"), "{said}");
}

#[test]
fn joints_with_names_are_called_by_them() {
    let mut found = verdict(
        Answer::Named,
        vec![finding("stribeck", Family::F, &[0, 1], &["calibration"])],
        &[1.0, 1.0],
        &[0.1, 1.2],
    );
    found.joint_names = ["shoulder", "elbow"].map(str::to_owned).to_vec();
    assert!(
        headline(&found, Asked::Lack).contains(" on shoulder and elbow –"),
        "{}",
        headline(&found, Asked::Lack)
    );
    let said = objection(&found, &found.effects[0], "Nm").unwrap();
    assert!(said.contains("grows on elbow (1.00 → 1.20 Nm)") && !said.contains("joint"), "{said}");
}

#[test]
fn gears_that_would_show_are_one_line() {
    let gear = |joint, below_nm_rad, beyond_rad| VisibleGear { joint, below_nm_rad, beyond_rad };
    let mut found = verdict(Answer::NoMismatch, Vec::new(), &[0.1], &[0.1]);
    assert_eq!(visible_gears(&found), None);
    found.gears_visible =
        vec![gear(0, Some(2.13e4), Some(1e-4)), gear(1, Some(900.0), Some(3.4e-4)), gear(2, None, None)];
    let said = visible_gears(&found).unwrap();
    assert_eq!(
        said,
        "gears softer than 9.0e2 to 2.1e4 Nm/rad or play beyond ± 1.0e-4 to 3.4e-4 rad would show on 2 of 3 joints"
    );
}
