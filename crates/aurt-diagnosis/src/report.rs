//! From an investigation to a verdict.

use std::collections::BTreeMap;

use aurt_traits::ColumnGroup;
use serde_json::{Value, json};

use crate::{
    Alternative, Answer, Candidate, Contact, Evidence, Finding, HeldOut, Investigation, JointResidual,
    NotDecidable, Question, RecordingRows, Role, Shift, Verdict,
    baseline::weighted_fit,
    confidence::confidence,
    diagnose::residuals,
    effects::{self, ParameterValue, Presence},
    localise,
    problem::{Switch, TotalFit},
    selection::Chosen,
};

/// A joint whose residual exceeds the noise floor by this factor (root mean square) shows structure.
pub const STRUCTURE: f64 = 1.5;

/// A rival whose torque leaves less than this share outside the model that has the finding cannot be told
/// from it.
const INSEPARABLE: f64 = 0.25;

/// At most this many alternatives stand beside a finding.
const ALTERNATIVES: usize = 2;

/// Whole-arm effects are said to concern joints that lose at least this share of the largest loss.
const CONCERNED: f64 = 0.08;

/// The verdict of an investigation.
#[must_use]
pub fn verdict(question: &Question<'_>, investigation: &Investigation) -> Verdict {
    let chosen = &investigation.selection.chosen;
    let all = all_switches(investigation, chosen);
    let (fit, weights) = weighted_fit(&investigation.problem, &all, &investigation.floor);
    let baseline = (
        &investigation.base_switches,
        weighted_fit(&investigation.problem, &investigation.base_switches, &investigation.floor).0,
    );
    let mut effects = findings(question, investigation, chosen, &all, &fit, &weights);
    effects.sort_by(|a, b| {
        let changed = |f: &Finding| f.present_in.len() == 1 && f.present_in[0] == "target";
        changed(b).cmp(&changed(a)).then(b.evidence.score.total_cmp(&a.evidence.score))
    });
    let residual = joint_residuals(investigation, &all, &fit, baseline.0, &baseline.1);
    let faults = fault_findings(question, investigation);
    let faulty = !faults.is_empty();
    let touched = contact_findings(question, investigation);
    let found = faulty || !touched.is_empty();
    effects.splice(0..0, faults.into_iter().chain(touched));
    let mut verdict = Verdict {
        verdict: if found { Answer::Named } else { answer(&effects, &residual) },
        effects,
        not_decidable: not_decidable(question, investigation),
        residual,
        held_out: held_out(investigation, &all, &fit),
        shifts: shifts(investigation, &all, &fit, &baseline.1),
        notes: Vec::new(),
    };
    verdict.notes.extend(
        investigation
            .faults
            .iter()
            .filter(|f| !f.suffices)
            .map(|f| format!("{}: {}", f.recording, f.sentence)),
    );
    if question.recordings.iter().any(|r| r.simulated.is_some()) {
        verdict.notes.push(
            "what is questioned is the prediction of another simulator; nothing of it was refitted".into(),
        );
    } else if investigation.baseline.frozen {
        verdict
            .notes
            .push("the model in question was taken as given; its coefficients were not refitted".into());
    }
    verdict
}

/// A fault is as certain as its probability says, but no verdict is surer than this.
const SUREST: f64 = 0.99;

/// Findings for the faults that suffice to explain a mismatch, those of one kind together.
fn fault_findings(question: &Question<'_>, investigation: &Investigation) -> Vec<Finding> {
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
                    (name.clone(), ParameterValue { value: value.clone(), std: std.clone() })
                })
                .collect(),
            alternatives: Vec::new(),
            evidence: Evidence { score: -fault.log10_probability * std::f64::consts::LN_10, threshold: 8.0 },
            sentence: fault.sentence.clone(),
        });
    }
    findings
}

/// Findings for contacts with the surroundings.
fn contact_findings(question: &Question<'_>, investigation: &Investigation) -> Vec<Finding> {
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
            confidence: confidence(contact.score),
            parameters: BTreeMap::from([
                ("link".to_owned(), number(json!(contact.link))),
                ("force_n".to_owned(), number(json!(contact.force_n))),
                ("window_s".to_owned(), number(json!(contact.window_s))),
            ]),
            alternatives: Vec::new(),
            evidence: Evidence { score: contact.score, threshold: question.selection.score },
            sentence: format!(
                "a contact at link {} of {} from {from:.1} to {to:.1} s, felt by joints {}",
                contact.link,
                recording.data.name,
                list(&contact.joints)
            ),
        }
    };
    investigation.contacts.iter().map(one).collect()
}

/// Coefficients of the final model.
fn all_switches(investigation: &Investigation, chosen: &[Chosen]) -> Vec<Switch> {
    let mut all = investigation.base_switches.clone();
    for switch in chosen.iter().flat_map(|c| &investigation.groups[c.group].switches) {
        if !all.iter().any(|s| s.column == switch.column && s.target_only == switch.target_only) {
            all.push(*switch);
        }
    }
    all
}

/// Named effects must account for this share of the excess power over the noise floor, at the joint where the
/// mismatch is largest; else what they describe is not what is missing.
const ACCOUNTED: f64 = 0.7;

fn answer(effects: &[Finding], residual: &[JointResidual]) -> Answer {
    let structure_left = residual.iter().any(|r| r.structure_left);
    let Some(first) = effects.first() else {
        return if structure_left { Answer::Unexplained } else { Answer::NoMismatch };
    };
    let excess = |rms: f64, floor: f64| (rms * rms - floor * floor).max(0.0);
    let worst = residual.iter().max_by(|a, b| {
        let ratio = |r: &JointResidual| r.baseline_rms / r.floor_rms.max(f64::MIN_POSITIVE);
        ratio(a).total_cmp(&ratio(b))
    });
    let accounted = worst.map_or(1.0, |r| {
        let before = excess(r.baseline_rms, r.floor_rms);
        if before > 0.0 { 1.0 - excess(r.unexplained_rms, r.floor_rms) / before } else { 1.0 }
    });
    if structure_left && accounted < ACCOUNTED {
        Answer::Unexplained
    } else if first.alternatives.is_empty() {
        Answer::Named
    } else {
        Answer::Ambiguous
    }
}

fn findings(
    question: &Question<'_>,
    investigation: &Investigation,
    chosen: &[Chosen],
    all: &[Switch],
    fit: &TotalFit,
    weights: &[f64],
) -> Vec<Finding> {
    let mut merged: Vec<(Finding, Vec<Vec<usize>>)> = Vec::new();
    for one in chosen {
        let group = &investigation.groups[one.group];
        let candidate = &investigation.candidates[group.candidate];
        let Some(effect) = effects::find(group.effect) else { continue };
        let fitted = fitted_coefficients(investigation, candidate, group.target_only(), all, fit);
        let parameters = effect.parameters(&candidate.proposal, &fitted);
        let joints = if effect.whole_arm() { concerned(one) } else { group.joints.clone() };
        let finding = Finding {
            effect: group.effect.to_owned(),
            family: effect.family(),
            joints,
            present_in: present_in(question, investigation, group.target_only()),
            recording: None,
            window_s: None,
            confidence: confidence(one.score),
            parameters: parameters
                .into_iter()
                .map(|(name, (value, std))| (name, ParameterValue { value, std }))
                .collect(),
            alternatives: alternatives(investigation, chosen, one, all, weights),
            evidence: Evidence { score: one.score, threshold: question.selection.score },
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
    first.confidence = first.confidence.max(other.confidence);
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

fn present_in(question: &Question<'_>, investigation: &Investigation, target_only: bool) -> Vec<String> {
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
fn fitted_coefficients(
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
                Some(std) => format!("{name} = {value:.4} ± {std:.2e}"),
                None => format!("{name} = {value}"),
            })
        })
        .take(4)
        .collect();
    let key = if key.is_empty() { String::new() } else { format!(" ({})", key.join(", ")) };
    format!("{title} {plural} {joints}{when}{key}")
}

fn list(joints: &[usize]) -> String {
    joints.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// Effects all of whose candidates the baseline absorbs, in every kind of recording in which they are tried.
fn not_decidable(question: &Question<'_>, investigation: &Investigation) -> Vec<NotDecidable> {
    let mut absorbed: BTreeMap<&'static str, BTreeMap<usize, f64>> = BTreeMap::new();
    let target = investigation.problem.has_target();
    for (candidate, free) in investigation.candidates.iter().zip(&investigation.free) {
        if candidate.proposal.joints.len() > 1 && candidate.effect == "joint_coupling_friction" {
            continue;
        }
        let share = match candidate.proposal.presence {
            Presence::Change if target => free[1],
            Presence::Change => 0.0,
            Presence::Any => free[0].max(free[1]),
        };
        let joint =
            if candidate.proposal.joints.len() > 1 { usize::MAX } else { candidate.proposal.joints[0] };
        let largest = absorbed.entry(candidate.effect).or_default().entry(joint).or_insert(0.0);
        *largest = largest.max(share);
    }
    let joints = question.model.joints();
    let mut found = Vec::new();
    for (effect, shares) in absorbed {
        let hidden: Vec<(usize, f64)> =
            shares.into_iter().filter(|(_, s)| *s < question.selection.free_share).collect();
        if hidden.is_empty() {
            continue;
        }
        let largest = hidden.iter().map(|(_, s)| *s).fold(0.0, f64::max);
        let concerned = if hidden.iter().any(|(j, _)| *j == usize::MAX) {
            (0..joints).collect()
        } else {
            hidden.iter().map(|(j, _)| *j).collect()
        };
        let decider = effects::find(effect).map_or("", |e| e.decider());
        found.push(NotDecidable {
            effect: effect.to_owned(),
            joints: concerned,
            absorbed: 1.0 - largest * largest,
            record: decider.to_owned(),
        });
    }
    found
}

fn joint_residuals(
    investigation: &Investigation,
    all: &[Switch],
    fit: &TotalFit,
    base: &[Switch],
    base_fit: &TotalFit,
) -> Vec<JointResidual> {
    let fitted: Vec<usize> =
        (0..investigation.rows.len()).filter(|r| investigation.rows[*r].role != Role::Validation).collect();
    let rows: Vec<&RecordingRows> = fitted.iter().map(|r| &investigation.rows[*r]).collect();
    let layout = &investigation.layout;
    let after: Vec<Vec<Vec<f64>>> =
        rows.iter().map(|r| residuals(r, layout, all, &fit.coefficients)).collect();
    let before: Vec<Vec<Vec<f64>>> =
        rows.iter().map(|r| residuals(r, layout, base, &base_fit.coefficients)).collect();
    let views: Vec<&[Vec<f64>]> = after.iter().map(Vec::as_slice).collect();
    (0..layout.rows.len())
        .map(|joint| {
            let counted: f64 = rows.iter().map(|r| r.joints[joint].counted(0, r.rows())).sum();
            let power = |parts: &[Vec<Vec<f64>>]| {
                let sum: f64 = parts.iter().flat_map(|p| &p[joint]).map(|r| r * r).sum();
                (sum / counted.max(1.0)).sqrt()
            };
            let floor_rms = investigation.floor[joint].sqrt();
            let unexplained_rms = power(&after);
            let structure_left = unexplained_rms > STRUCTURE * floor_rms;
            let load: Vec<Vec<f64>> = rows.iter().map(|r| rigid_body_load(investigation, r, joint)).collect();
            let follows = if structure_left { localise::follows(&rows, &views, joint, &load) } else { None };
            let windows_s = rows
                .iter()
                .zip(&after)
                .flat_map(|(r, residual)| localise::windows(r, &residual[joint], floor_rms))
                .collect();
            JointResidual {
                joint,
                baseline_rms: power(&before),
                unexplained_rms,
                floor_rms,
                structure_left,
                follows_share: follows.as_ref().map_or(0.0, |(_, s)| *s),
                follows: follows.map(|(name, _)| name),
                windows_s,
            }
        })
        .collect()
}

/// The rigid-body torque of the baseline at each row of a joint.
fn rigid_body_load(investigation: &Investigation, rows: &RecordingRows, joint: usize) -> Vec<f64> {
    let rigid = investigation.model.group(ColumnGroup::RigidBody);
    let mut load = vec![0.0; rows.rows()];
    for (k, column) in investigation.layout.rows[joint].iter().enumerate().filter(|(_, c)| rigid.contains(c))
    {
        let coefficient = investigation.baseline.coefficients.get(*column).copied().unwrap_or(0.0);
        for (l, value) in load.iter_mut().zip(rows.joints[joint].column(k)) {
            *l += coefficient * value;
        }
    }
    load
}

/// Improvement on the held-out rows. Before: the baseline as fitted to the calibration recordings (or given).
fn held_out(investigation: &Investigation, all: &[Switch], fit: &TotalFit) -> HeldOut {
    let joints = investigation.layout.rows.len();
    let own: Vec<Switch> = investigation.base_switches.clone();
    let (mut before, mut after, mut floor) = (vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]);
    let mut counts = vec![0.0; joints];
    for (r, start, end) in &investigation.partition.held_out {
        let rows = &investigation.rows[*r];
        let base = residuals(rows, &investigation.layout, &own, &investigation.baseline.coefficients);
        let full = residuals(rows, &investigation.layout, all, &fit.coefficients);
        for j in 0..joints {
            let sum = |series: &[f64]| series[*start..*end].iter().map(|v| v * v).sum::<f64>();
            let counted = rows.joints[j].counted(*start, *end);
            before[j] += sum(&base[j]);
            after[j] += sum(&full[j]);
            floor[j] += investigation.floors[*r][j] * counted;
            counts[j] += counted;
        }
    }
    let rms =
        |sums: Vec<f64>| sums.into_iter().zip(&counts).map(|(s, n)| (s / f64::max(*n, 1.0)).sqrt()).collect();
    HeldOut {
        recordings: investigation.partition.held_out_names.clone(),
        rms_before: rms(before),
        rms_after: rms(after),
        rms_floor: rms(floor),
    }
}

/// Parameters of the baseline that moved most, in standard deviations.
fn shifts(investigation: &Investigation, all: &[Switch], fit: &TotalFit, base: &TotalFit) -> Vec<Shift> {
    let mut shifts: Vec<Shift> = (0..investigation.base_switches.len())
        .filter(|k| base.variance[*k].is_finite() && fit.variance[*k].is_finite())
        .map(|k| {
            let std = fit.variance[k].sqrt().max(f64::MIN_POSITIVE);
            Shift {
                parameter: investigation.model.parameters()[all[k].column].name.clone(),
                before: base.coefficients[k],
                after: fit.coefficients[k],
                in_std: (fit.coefficients[k] - base.coefficients[k]).abs() / std,
            }
        })
        .filter(|s| s.in_std > 3.0)
        .collect();
    shifts.sort_by(|a, b| b.in_std.total_cmp(&a.in_std));
    shifts.truncate(12);
    shifts
}
