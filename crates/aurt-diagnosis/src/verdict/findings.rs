//! From what was selected, and from faults and contacts, to the findings of a verdict.

use std::collections::BTreeMap;

use aurt_calibration::with_deviation;
use serde_json::{Value, json};

use crate::contact::Contact;
use crate::evidence::problem::TotalFit;
use crate::hypotheses::candidates::Candidate;
use crate::hypotheses::effects;
use crate::hypotheses::effects::{OwnFriction, ParameterValue};
use crate::hypotheses::group::Switch;
use crate::hypotheses::registered::REGISTERED;
use crate::investigation::Investigation;
use crate::recordings::faults::Fault;
use crate::recordings::rows::Role;
use crate::request::Question;
use crate::search::selection::Chosen;
use crate::transmission::Shaking;
use crate::verdict::confidence::confidence;
use crate::verdict::{Alternative, Evidence, Finding};

/// A rival whose torque leaves less than this share outside the model that has the finding cannot be told
/// from it.
const INSEPARABLE: f64 = 0.25;

/// At most this many alternatives stand beside a finding.
const ALTERNATIVES: usize = 2;

/// Whole-arm effects are said to concern joints that lose at least this share of the largest loss.
const CONCERNED: f64 = 0.08;

/// A fault is as certain as its probability says, but no verdict is surer than this.
const SUREST: f64 = 0.99;

/// Findings for the faults that suffice to explain a mismatch, those of one kind together.
pub(crate) fn fault_findings(question: &Question<'_>, investigation: &Investigation) -> Vec<Finding> {
    let mut findings: Vec<Finding> = Vec::new();
    let barred = |effect: &str| question.without.iter().any(|w| w == effect);
    for fault in investigation.faults.iter().filter(|f| f.suffices && !barred(f.effect)) {
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
                threshold: 8.0,
                ..Evidence::default()
            },
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

/// Findings for contacts with the surroundings.
pub(crate) fn contact_findings(question: &Question<'_>, investigation: &Investigation) -> Vec<Finding> {
    let one = |contact: &Contact| {
        let recording = &question.recordings[contact.recording];
        let kind = if recording.role == Role::Target { "target" } else { "calibration" };
        let [from, to] = contact.window_s;
        let number = |value: Value| ParameterValue { value, std: Value::Null };
        Finding {
            effect: "external_contact".to_owned(),
            family: effects::Family::X,
            joints: contact.joints.clone(),
            present_in: vec![kind.to_owned()],
            recording: Some(recording.data.name.clone()),
            window_s: Some(contact.window_s),
            confidence: confidence(contact.score, false),
            parameters: BTreeMap::from([
                ("link".to_owned(), number(json!(contact.link))),
                ("force_n".to_owned(), number(json!(contact.force_n))),
                ("window_s".to_owned(), number(json!(contact.window_s))),
            ]),
            alternatives: Vec::new(),
            evidence: Evidence {
                score: contact.score,
                threshold: question.selection.score,
                ..Evidence::default()
            },
            sentence: format!(
                "a contact at link {} of {} from {from:.1} to {to:.1} s, felt by joints {}",
                contact.link,
                recording.data.name,
                list(&contact.joints)
            ),
        }
    };
    if question.without.iter().any(|w| w == "external_contact") {
        return Vec::new();
    }
    investigation.contacts.iter().map(one).collect()
}

/// The finding for a delay that was undone.
pub(crate) fn delay_finding(question: &Question<'_>, investigation: &Investigation) -> Option<Finding> {
    let delay = investigation.late.as_ref()?.delay;
    let effect = effects::find("time_delay")?;
    let mut finding = Finding {
        effect: effect.id().to_owned(),
        family: effect.family(),
        joints: (0..question.model.joints()).collect(),
        present_in: present_in(question, investigation, delay.target_only),
        recording: None,
        window_s: None,
        confidence: confidence(delay.score, false),
        parameters: BTreeMap::from([(
            "delay_s".to_owned(),
            ParameterValue { value: json!(delay.delay_s), std: json!(delay.std_s) },
        )]),
        alternatives: Vec::new(),
        evidence: Evidence { score: delay.score, threshold: question.selection.score, ..Evidence::default() },
        sentence: String::new(),
    };
    finding.sentence = sentence(&finding);
    Some(finding)
}

/// Findings for play and ringing that may be named.
pub(crate) fn shaking_findings(question: &Question<'_>, investigation: &Investigation) -> Vec<Finding> {
    let targets = question.recordings.iter().any(|r| r.role == Role::Target);
    let one = |shaking: &Shaking| {
        let effect = effects::find(shaking.effect)?;
        let [in_calibration, in_target] = shaking.present;
        let kinds = [("calibration", in_calibration), ("target", in_target || (targets && in_calibration))];
        let number = |value: Value| ParameterValue { value, std: Value::Null };
        let mut parameters = BTreeMap::new();
        if let (Some(stiffness), Some(frequency)) = (shaking.stiffness_nm_rad, shaking.frequency_hz) {
            parameters.insert("stiffness_nm_rad".to_owned(), number(json!(stiffness)));
            parameters.insert("frequency_hz".to_owned(), number(json!(frequency)));
        }
        if let Some(crossings) = shaking.crossings {
            parameters.insert("load_reversals".to_owned(), number(json!(crossings)));
            parameters.insert("energy_ratio".to_owned(), number(json!(shaking.contrast)));
        }
        let joint = shaking.joint;
        let sentence = match (shaking.frequency_hz, shaking.crossings) {
            (Some(frequency), _) => format!(
                "{} on joint {joint}: it rings at {frequency:.1} Hz, in bursts, along its own inertia",
                effect.title()
            ),
            (None, crossings) => format!(
                "{} on joint {joint}: impacts where its load changes sign ({} times), {:.1} times as strong as elsewhere",
                effect.title(),
                crossings.unwrap_or(0),
                shaking.contrast
            ),
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
            sentence,
        })
    };
    let known = |s: &&Shaking| !question.without.iter().any(|w| w == s.effect);
    investigation.shaking.iter().filter(known).filter_map(one).collect()
}

pub(crate) fn findings(
    question: &Question<'_>,
    investigation: &Investigation,
    chosen: &[Chosen],
    all: &[Switch],
    fit: &TotalFit,
    weights: &[f64],
) -> Vec<Finding> {
    let mut model_coefficients = investigation.baseline.coefficients.clone();
    for (switch, value) in investigation.base_switches.iter().zip(&fit.coefficients) {
        model_coefficients[switch.column] = *value;
    }
    let mut merged: Vec<(Finding, Vec<Vec<usize>>)> = Vec::new();
    for one in chosen {
        let group = &investigation.groups[one.group];
        let candidate = &investigation.candidates[group.candidate];
        let Some(effect) = effects::find(group.effect) else { continue };
        let fitted = fitted_coefficients(investigation, candidate, group.target_only(), all, fit);
        let own = OwnFriction::of(question.model, candidate.proposal.joints[0], &model_coefficients);
        let parameters = effect.parameters_beside(&candidate.proposal, &fitted, &own);
        let joints = match (effect.whole_arm(), effect.concerns_all()) {
            (true, false) => concerned(one),
            _ => group.joints.clone(),
        };
        let alternatives = alternatives(investigation, chosen, one, all, weights);
        let finding = Finding {
            effect: group.effect.to_owned(),
            family: effect.family(),
            joints,
            present_in: present_in(question, investigation, group.target_only()),
            recording: None,
            window_s: None,
            confidence: confidence(one.score, !alternatives.is_empty()),
            parameters: parameters
                .into_iter()
                .map(|(name, (value, std))| (name, ParameterValue { value, std }))
                .collect(),
            alternatives,
            evidence: Evidence {
                score: one.score,
                threshold: one.threshold,
                p_null: one.p_null,
                p_confirm: one.p_confirm,
            },
            sentence: String::new(),
        };
        let twin = merged.iter_mut().find(|(f, _)| {
            f.effect == finding.effect
                && f.present_in == finding.present_in
                && !effect.whole_arm()
                && finding.joints.len() == 1
        });
        match twin {
            Some((first, parts)) => {
                parts.push(finding.joints.clone());
                merge(first, finding, parts.len());
            }
            None => merged.push((finding.clone(), vec![finding.joints])),
        }
    }
    merged
        .into_iter()
        .map(|(mut finding, _)| {
            sort_by_joint(&mut finding);
            finding.sentence = sentence(&finding);
            finding
        })
        .collect()
}

/// Puts a further joint's finding of the same effect into one; parameters become lists along the joints.
fn merge(first: &mut Finding, other: Finding, parts: usize) {
    for (name, parameter) in &mut first.parameters {
        let (value, std) = other
            .parameters
            .get(name)
            .map_or((Value::Null, Value::Null), |p| (p.value.clone(), p.std.clone()));
        append(&mut parameter.value, value, parts);
        append(&mut parameter.std, std, parts);
    }
    for (name, parameter) in other.parameters {
        first.parameters.entry(name).or_insert_with(|| {
            let list = |last: Value| {
                let mut list = vec![Value::Null; parts - 1];
                list.push(last);
                Value::Array(list)
            };
            ParameterValue { value: list(parameter.value), std: list(parameter.std) }
        });
    }
    first.joints.extend(other.joints);
    first.evidence.score = first.evidence.score.max(other.evidence.score);
    first.confidence = first.confidence.min(other.confidence);
    for alternative in other.alternatives {
        if first.alternatives.len() < ALTERNATIVES
            && !first.alternatives.iter().any(|a| a.effect == alternative.effect)
        {
            first.alternatives.push(alternative);
        }
    }
}

fn append(list: &mut Value, value: Value, parts: usize) {
    match list {
        Value::Array(values) if values.len() == parts - 1 && parts > 2 => values.push(value),
        first => *first = json!([first.take(), value]),
    }
}

/// Orders joints ascending, and the lists along them.
fn sort_by_joint(finding: &mut Finding) {
    let n = finding.joints.len();
    if finding.joints.is_sorted() {
        return;
    }
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by_key(|i| finding.joints[*i]);
    finding.joints = order.iter().map(|i| finding.joints[*i]).collect();
    for parameter in finding.parameters.values_mut() {
        for value in [&mut parameter.value, &mut parameter.std] {
            if let Value::Array(list) = value
                && list.len() == n
            {
                *list = order.iter().map(|i| list[*i].clone()).collect();
            }
        }
    }
}

/// The joints whose error a whole-arm effect explains.
fn concerned(chosen: &Chosen) -> Vec<usize> {
    let largest = chosen.joint_loss.iter().copied().fold(0.0, f64::max);
    (0..chosen.joint_loss.len()).filter(|j| chosen.joint_loss[*j] > CONCERNED * largest).collect()
}

pub(crate) fn present_in(
    question: &Question<'_>,
    investigation: &Investigation,
    target_only: bool,
) -> Vec<String> {
    let targets = question.recordings.iter().any(|r| r.role == Role::Target);
    let mut kinds = Vec::new();
    if !targets || (!target_only && investigation.problem.has_reference()) {
        kinds.push("calibration".to_owned());
    }
    if targets {
        kinds.push("target".to_owned());
    }
    kinds
}

/// (name, value, standard deviation) of a candidate's coefficients; those that the baseline absorbs are zero.
pub(crate) fn fitted_coefficients(
    investigation: &Investigation,
    candidate: &Candidate,
    target_only: bool,
    all: &[Switch],
    fit: &TotalFit,
) -> Vec<(String, f64, f64)> {
    candidate
        .columns
        .iter()
        .zip(&candidate.names)
        .map(|(column, name)| {
            let place = all.iter().position(|s| s.column == *column && s.target_only == target_only);
            let (value, std) = place.map_or((0.0, f64::INFINITY), |k| {
                let correlated = 1.0 / investigation.mean_independent_share.max(0.01);
                (fit.coefficients[k], (fit.variance[k] * correlated).sqrt())
            });
            (name.clone(), value, std)
        })
        .collect()
}

fn alternatives(
    investigation: &Investigation,
    chosen: &[Chosen],
    one: &Chosen,
    all: &[Switch],
    weights: &[f64],
) -> Vec<Alternative> {
    let mut found: Vec<Alternative> = Vec::new();
    for (rival, score) in &one.rivals {
        let group = &investigation.groups[*rival];
        // What the vocabulary has a word for keeps it.
        if group.effect == REGISTERED {
            continue;
        }
        if chosen.iter().any(|c| c.group == *rival) || found.iter().any(|a| a.effect == group.effect) {
            continue;
        }
        let free = investigation.problem.free_share(all, &group.switches, weights);
        let separable = free.iter().any(|share| *share > INSEPARABLE);
        if !separable && found.len() < ALTERNATIVES {
            let decider = effects::find(group.effect).map_or("", |e| e.decider());
            found.push(Alternative {
                effect: group.effect.to_owned(),
                joints: group.joints.clone(),
                score: *score,
                record: decider.to_owned(),
            });
        }
    }
    found
}

fn sentence(finding: &Finding) -> String {
    let title = effects::find(&finding.effect).map_or(finding.effect.as_str(), |e| e.title());
    let whole = effects::find(&finding.effect).is_some_and(|e| e.whole_arm());
    let plural = match (whole, finding.joints.len()) {
        (true, _) => "seen on joints",
        (false, 1) => "on joint",
        (false, _) => "on joints",
    };
    let joints = list(&finding.joints);
    let changed = finding.present_in == ["target"];
    let when = if changed { ", in the target recordings only" } else { "" };
    let key: Vec<String> = finding
        .parameters
        .iter()
        .filter_map(|(name, p)| {
            let value = p.value.as_f64()?;
            Some(match p.std.as_f64() {
                Some(std) => format!("{name} = {}", with_deviation(value, std)),
                None => format!("{name} = {}", short(value)),
            })
        })
        .take(4)
        .collect();
    let key = if key.is_empty() { String::new() } else { format!(" ({})", key.join(", ")) };
    format!("{title} {plural} {joints}{when}{key}")
}

/// A value of which no deviation is known: numbers of things as they are, others to four digits.
fn short(value: f64) -> String {
    if value.fract() == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let digits = (3.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}

fn list(joints: &[usize]) -> String {
    joints.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn values_without_a_deviation_have_four_digits() {
        assert_eq!([short(5.0), short(0.593_439_36), short(-1234.56)], ["5", "0.5934", "-1235"]);
    }
}
