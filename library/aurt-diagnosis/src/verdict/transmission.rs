//! From gears that give way or have play to findings.

use std::collections::BTreeMap;

use serde_json::json;

use crate::hypotheses::effects;
use crate::hypotheses::effects::ParameterValue;
use crate::investigation::Investigation;
use crate::recordings::rows::Role;
use crate::request::Question;
use crate::transmission::Shaking;
use crate::verdict::confidence::confidence;
use crate::verdict::{Evidence, Finding, Indication};

/// Findings for gears that pass all tests.
pub(crate) fn shaking_findings(question: &Question<'_>, investigation: &Investigation) -> Vec<Finding> {
    let confirmed = investigation.shaking.iter().filter(|s| s.confirmed);
    confirmed.filter_map(|s| finding(question, s)).collect()
}

/// Gears that pass only part of the tests, each with those that it fails.
pub(crate) fn shaking_indications(question: &Question<'_>, investigation: &Investigation) -> Vec<Indication> {
    let rest = investigation.shaking.iter().filter(|s| !s.confirmed);
    rest.filter_map(|s| Some(Indication { finding: finding(question, s)?, fails: s.fails.clone() })).collect()
}

fn finding(question: &Question<'_>, shaking: &Shaking) -> Option<Finding> {
    let targets = question.recordings.iter().any(|r| r.role == Role::Target);
    let effect = effects::find(shaking.effect)?;
    let [in_calibration, in_target] = shaking.present;
    let kinds = [("calibration", in_calibration), ("target", in_target || (targets && in_calibration))];
    let number = |[value, std]: [f64; 2]| ParameterValue {
        value: json!(value),
        std: json!(std.is_finite().then_some(std)),
    };
    let mut parameters = BTreeMap::from([
        ("stiffness_nm_rad".to_owned(), number(shaking.stiffness_nm_rad)),
        ("damping_nm_s".to_owned(), number(shaking.damping_nm_s)),
    ]);
    let joint = shaking.joint;
    let play = shaking.gap_rad[0] > 0.0;
    let sentence = if play {
        parameters.insert("gap_rad".to_owned(), number(shaking.gap_rad));
        format!(
            "{} on joint {joint}: a link that is free within ± {:.2e} rad of its motor predicts what the rigid model leaves",
            effect.title(),
            shaking.gap_rad[0]
        )
    } else {
        let hz = ParameterValue { value: json!(shaking.frequency_hz), std: json!(null) };
        parameters.insert("frequency_hz".to_owned(), hz);
        format!(
            "{} on joint {joint}: a link on a spring of {:.3e} Nm/rad, {:.1} Hz, predicts what the rigid model leaves",
            effect.title(),
            shaking.stiffness_nm_rad[0],
            shaking.frequency_hz
        )
    };
    Some(Finding {
        effect: shaking.effect.to_owned(),
        family: effect.family(),
        joints: vec![joint],
        present_in: kinds.iter().filter(|(_, is)| *is).map(|(kind, _)| (*kind).to_owned()).collect(),
        recording: None,
        window_s: None,
        confidence: confidence(shaking.score, false),
        parameters,
        alternatives: Vec::new(),
        evidence: Evidence {
            score: shaking.score,
            threshold: question.selection.score,
            ..Evidence::default()
        },
        stability: None,
        sentence,
    })
}
