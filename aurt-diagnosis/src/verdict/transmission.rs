//! From gears that give way or have play to findings.

use aurt_calibration::with_deviation;

use crate::investigation::Investigation;
use crate::parameters::{ParameterValue, Parameters};
use crate::recordings::rows::Role;
use crate::request::Question;
use crate::transmission::Shaking;
use crate::verdict::confidence::confidence;
use crate::verdict::{Evidence, Finding, Indication};

/// Findings for gears that pass all tests.
pub(crate) fn shaking_findings(question: &Question<'_>, investigation: &Investigation) -> Vec<Finding> {
    let confirmed = investigation.shaking.iter().filter(|s| s.confirmed);
    confirmed.map(|s| finding(question, s)).collect()
}

/// Whether a gear of all recordings that fails a test is beyond chance, and none passes: something is there that is not known.
pub(crate) fn is_gear_hinted(question: &Question<'_>, investigation: &Investigation) -> bool {
    let gears = &investigation.shaking;
    let is_rare = |g: &Shaking| g.present[0] && g.p <= question.selection.level;
    gears.iter().any(is_rare) && gears.iter().all(|g| !g.confirmed)
}

/// Gears that pass only part of the tests, each with those that it fails; none of those that the pose of the link shows.
pub(crate) fn shaking_indications(question: &Question<'_>, investigation: &Investigation) -> Vec<Indication> {
    let chosen = || investigation.selection.chosen.iter().map(|c| &investigation.groups[c.group]);
    let is_claimed = |s: &&Shaking| chosen().any(|g| g.effect == s.effect && g.joints == [s.joint]);
    let rest = investigation.shaking.iter().filter(|s| !s.confirmed && !is_claimed(s));
    rest.map(|s| Indication { finding: finding(question, s), fails: s.fails.clone(), usual: false }).collect()
}

fn finding(question: &Question<'_>, shaking: &Shaking) -> Finding {
    let targets = question.recordings.iter().any(|r| r.role == Role::Target);
    let [in_calibration, in_target] = shaking.present;
    let kinds = [("calibration", in_calibration), ("target", in_target || (targets && in_calibration))];
    let number = |[value, std]: [f64; 2]| ParameterValue::new(value, std);
    let sized = |[value, std]: [f64; 2]| with_deviation(value, std);
    let mut parameters = Parameters::from([
        ("stiffness_nm_rad".to_owned(), number(shaking.stiffness_nm_rad)),
        ("damping_nm_s".to_owned(), number(shaking.damping_nm_s)),
    ]);
    let joint = question.names().joint(shaking.joint);
    let slides = question.model.rigid_body().slides(shaking.joint);
    let unit = |of| question.unit.express_of_joint(of, slides);
    let play = shaking.gap_rad[0] > 0.0;
    let sentence = if play {
        parameters.insert("gap_rad".to_owned(), number(shaking.gap_rad));
        format!(
            "{} on {joint}: a play of ± ({}) {} predicts the residual of the rigid model",
            shaking.effect.title,
            sized(shaking.gap_rad),
            unit("rad")
        )
    } else {
        parameters.insert("frequency_hz".to_owned(), ParameterValue::exact(shaking.frequency_hz));
        format!(
            "{} on {joint}: a stiffness of {} {} ({:.1} Hz) predicts the residual of the rigid model",
            shaking.effect.title,
            sized(shaking.stiffness_nm_rad),
            unit("Nm/rad"),
            shaking.frequency_hz
        )
    };
    let evidence = Evidence { p: Some(shaking.p), ..Evidence::of(shaking.score, question.selection.score) };
    Finding {
        present_in: kinds.iter().filter(|(_, is)| *is).map(|(kind, _)| (*kind).to_owned()).collect(),
        parameters,
        sentence,
        ..Finding::new(shaking.effect, vec![shaking.joint], evidence, confidence(shaking.score, false))
    }
}
