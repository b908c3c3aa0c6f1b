//! Findings for faults of the recordings.

use serde_json::{Value, json};

use crate::hypotheses::effects;
use crate::hypotheses::effects::ParameterValue;
use crate::investigation::Investigation;
use crate::recordings::faults::Fault;
use crate::recordings::rows::Role;
use crate::request::Question;
use crate::verdict::{Evidence, Finding};

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
        if let Some(first) = findings.iter_mut().find(|f| f.effect == fault.effect) {
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
        let Some(effect) = effects::find(fault.effect) else { continue };
        let window = match fault.windows_s.as_slice() {
            [only] => Some(*only),
            _ => None,
        };
        findings.push(Finding {
            effect: fault.effect.to_owned(),
            family: effect.family(),
            joints: fault.joints.clone(),
            present_in: vec![kind.to_owned()],
            recording: Some(fault.recording.clone()),
            window_s: window,
            confidence: (1.0 - 10.0_f64.powf(fault.log10_probability)).min(SUREST),
            parameters: fault
                .parameters
                .iter()
                .map(|(name, (value, std))| {
                    let value =
                        if name == "limit" { in_unit_of_fit(question, fault, value) } else { value.clone() };
                    (name.clone(), ParameterValue { value, std: std.clone() })
                })
                .collect(),
            alternatives: Vec::new(),
            evidence: Evidence {
                score: -fault.log10_probability * std::f64::consts::LN_10,
                threshold: question.selection.score,
                ..Evidence::default()
            },
            stability: None,
            sentence: fault.sentence.clone(),
        });
    }
    findings
}

/// A limit of a recorded measurement, after the gains that the fit is made with.
fn in_unit_of_fit(question: &Question<'_>, fault: &Fault, value: &Value) -> Value {
    let recording = question.recordings.iter().find(|r| r.data.name == fault.recording);
    let gains = recording.and_then(|r| r.options.gains.as_ref());
    match (value.as_f64(), gains, fault.joints.first()) {
        (Some(limit), Some(gains), Some(joint)) => json!(limit * gains[*joint].abs()),
        _ => value.clone(),
    }
}
