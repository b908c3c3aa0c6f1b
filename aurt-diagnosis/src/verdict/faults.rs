//! Findings for faults of the recordings.

use crate::faults::Fault;
use crate::investigation::Investigation;
use crate::parameters::ParameterValue;
use crate::recordings::rows::Role;
use crate::request::Question;
use crate::verdict::{Evidence, Finding};
use crate::vocabulary::Unit;

/// A fault is as certain as its probability says, but no verdict is surer than this.
const SUREST: f64 = 0.99;

/// Findings for the faults that suffice to explain a mismatch, those of one kind together.
pub(crate) fn fault_findings(question: &Question<'_>, investigation: &Investigation) -> Vec<Finding> {
    let mut findings: Vec<Finding> = Vec::new();
    for fault in investigation.faults.iter().filter(|f| f.suffices) {
        let role = question.recordings.iter().find(|r| r.data.name == fault.recording).map(|r| r.role);
        let kind = match role {
            Some(Role::Validation) | None => continue,
            Some(Role::Calibration) => "calibration",
            Some(Role::Target) => "target",
        };
        if let Some(first) = findings.iter_mut().find(|f| f.effect == fault.effect.id) {
            first.joints.extend(&fault.joints);
            first.joints.sort_unstable();
            first.joints.dedup();
            if !first.present_in.iter().any(|k| k == kind) {
                first.present_in.push(kind.to_owned());
            }
            if first.recording.as_ref() != Some(&fault.recording) {
                first.recording = None;
                first.window_s = None;
            }
            continue;
        }
        let window = match fault.windows_s.as_slice() {
            [only] => Some(*only),
            _ => None,
        };
        findings.push(Finding {
            present_in: vec![kind.to_owned()],
            recording: Some(fault.recording.clone()),
            window_s: window,
            parameters: fault
                .parameters
                .iter()
                .map(|(name, parameter)| {
                    let measured = fault.effect.parameter(name).is_some_and(|p| p.unit == Unit::Measurement);
                    let fitted = measured.then(|| in_unit_of_fit(question, fault, parameter)).flatten();
                    (name.clone(), fitted.unwrap_or_else(|| parameter.clone()))
                })
                .collect(),
            sentence: fault.sentence.clone(),
            ..Finding::new(
                fault.effect,
                fault.joints.clone(),
                Evidence::of(-fault.log10_probability * std::f64::consts::LN_10, question.selection.score),
                (1.0 - 10.0_f64.powf(fault.log10_probability)).min(SUREST),
            )
        });
    }
    findings
}

/// A limit of a recorded measurement, after the gains that the fit is made with.
fn in_unit_of_fit(question: &Question<'_>, fault: &Fault, limit: &ParameterValue) -> Option<ParameterValue> {
    let recording = question.recordings.iter().find(|r| r.data.name == fault.recording)?;
    let gains = recording.options.gains.as_ref()?;
    Some(ParameterValue::exact(limit.value.as_f64()? * gains[*fault.joints.first()?].abs()))
}
