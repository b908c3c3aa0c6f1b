//! From what was selected to the findings of a verdict.

use aurt_calibration::possible_body;
use serde_json::{Value, json};

use crate::effects::{self, time_delay};
use crate::hypotheses::candidates::Candidate;
use crate::investigation::{Fitted, Indicated, Investigation, concerned};
use crate::parameters::{FittedColumn, ParameterValue, Parameters};
use crate::recordings::rows::{RecordingRows, Role};
use crate::request::Question;
use crate::search::selection::{Chosen, Rival};
use crate::verdict::confidence::confidence;
use crate::verdict::sentence::sentence;
use crate::verdict::{Alternative, Evidence, Finding, Indication};
use crate::vocabulary::{Effect, OwnFriction};

/// A rival whose torque leaves less than this share outside the model that has the finding cannot be told
/// from it.
const INSEPARABLE: f64 = 0.25;

/// At most this many alternatives stand beside a finding.
const ALTERNATIVES: usize = 2;

/// The finding for a delay that was undone.
pub(crate) fn delay_finding(question: &Question<'_>, investigation: &Investigation) -> Option<Finding> {
    let delay = investigation.late.as_ref()?.delay;
    let evidence = Evidence::of(delay.score, question.selection.score);
    let joints = (0..question.model.joints()).collect();
    let mut finding = Finding {
        present_in: present_in(question, investigation, delay.target_only),
        parameters: Parameters::from([(
            "delay_s".to_owned(),
            ParameterValue::new(delay.delay_s, delay.std_s),
        )]),
        ..Finding::new(&time_delay::EFFECT, joints, evidence, confidence(delay.score, false))
    };
    finding.sentence = sentence(&finding, question);
    Some(finding)
}

/// Findings for what was selected and earned its place, those of one effect on several joints together.
pub(crate) fn findings(
    question: &Question<'_>,
    investigation: &Investigation,
    fitted: &Fitted,
) -> Vec<Finding> {
    let chosen = &investigation.selection.chosen;
    let mut merged: Vec<(Finding, Vec<Vec<usize>>)> = Vec::new();
    for one in chosen {
        if one.withheld.is_some() {
            continue;
        }
        let Some(finding) = finding(question, investigation, one, fitted) else { continue };
        let whole_arm = effects::find(&finding.effect).is_some_and(|e| e.is_whole_arm);
        let twin = merged.iter_mut().find(|(f, _)| {
            f.effect == finding.effect
                && f.present_in == finding.present_in
                && !whole_arm
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
            finding.sentence = sentence(&finding, question);
            finding
        })
        .collect()
}

/// What was selected and fails a test, each for itself.
pub(crate) fn indications(question: &Question<'_>, investigation: &Investigation) -> Vec<Indication> {
    let withheld = investigation.selection.chosen.iter().filter_map(|c| {
        let fails = vec![c.withheld.clone()?];
        let usual = investigation.groups[c.group].target_only();
        Some(Indicated { chosen: c.clone(), fails, lacks_confirmation: false, usual })
    });
    let mut found: Vec<Indication> = investigation
        .indicated
        .iter()
        .cloned()
        .chain(withheld)
        .filter_map(|indicated| {
            let kept = investigation.selection.chosen.iter().map(|c| &investigation.groups[c.group]);
            let own = &investigation.groups[indicated.chosen.group];
            let fitted = Fitted::new(investigation, investigation.switches_of(kept.chain([own])));
            let mut finding = finding(question, investigation, &indicated.chosen, &fitted)?;
            finding.sentence = sentence(&finding, question);
            Some(Indication { finding, fails: indicated.fails, usual: indicated.usual })
        })
        .collect();
    found.sort_by(|a, b| b.finding.evidence.score.total_cmp(&a.finding.evidence.score));
    found
}

/// The finding for one group.
fn finding(
    question: &Question<'_>,
    investigation: &Investigation,
    one: &Chosen,
    fitted: &Fitted,
) -> Option<Finding> {
    let group = &investigation.groups[one.group];
    if !group.is_named() {
        return None;
    }
    let candidate = &investigation.candidates[group.candidate];
    let effect = group.effect;
    let own = fitted.own(&investigation.baseline.coefficients, &investigation.base_switches);
    let columns = possible(investigation, fitted, candidate, group.target_only());
    let friction = OwnFriction::of(question.model, candidate.proposal.joints[0], &own);
    let parameters = effect.estimated(&candidate.proposal, &columns, &friction);
    let joints = match (effect.is_whole_arm, effect.concerns_all_joints) {
        (true, false) => concerned(one),
        _ => group.joints.clone(),
    };
    let mut alternatives = alternatives(investigation, one, fitted);
    alternatives.extend(same_under_load(question, investigation, one, &own));
    alternatives.truncate(ALTERNATIVES);
    let confidence = confidence(one.score, !alternatives.is_empty());
    Some(Finding {
        present_in: present_in(question, investigation, group.target_only()),
        parameters: reported(effect, parameters),
        alternatives,
        ..Finding::new(effect, joints, one.into(), confidence)
    })
}

/// The fitted columns of a candidate; those of a whole body are of the nearest body that can exist, in the metric of their
/// uncertainty.
fn possible(
    investigation: &Investigation,
    fitted: &Fitted,
    candidate: &Candidate,
    target_only: bool,
) -> Vec<FittedColumn> {
    const SYMBOLS: [&str; 10] = ["XX", "XY", "XZ", "YY", "YZ", "ZZ", "mX", "mY", "mZ", "m"];
    let mut columns = fitted.columns(candidate, target_only);
    let symbol = |name: &str| name.split_once('_').map(|(symbol, _)| symbol.to_owned());
    if columns.len() != SYMBOLS.len()
        || columns.iter().zip(SYMBOLS).any(|((name, ..), s)| symbol(name).as_deref() != Some(s))
    {
        return columns;
    }
    let places: Option<Vec<usize>> =
        candidate.columns.iter().map(|c| fitted.place(*c, target_only)).collect();
    let correlation = places
        .and_then(|places| investigation.problem.correlation(&fitted.switches, &fitted.weights, &places));
    let Some(mut covariance) = correlation else { return columns };
    for (k, c) in covariance.iter_mut().enumerate() {
        *c *= columns[k / 10].2 * columns[k % 10].2;
    }
    let estimate: [f64; 10] = std::array::from_fn(|k| columns[k].1);
    if let Some(body) = possible_body(&estimate, &covariance) {
        columns.iter_mut().zip(body.standard).for_each(|(column, value)| column.1 = value);
    }
    columns
}

/// Parameters as a finding reports them: the deviation of what is measured in units of torque has that of the drives' gains in
/// it.
pub(crate) fn reported(effect: &Effect, parameters: Parameters) -> Parameters {
    let of = |(name, ParameterValue { value, std }): (String, ParameterValue)| {
        let gains = effect.parameter(&name).is_some_and(|p| p.unit.follows_gains());
        let std = if gains { with_gain(&value, std) } else { std };
        (name, ParameterValue { value, std })
    };
    parameters.into_iter().map(of).collect()
}

/// Torque constants are known to about this share, one standard deviation, where no experiment says more: makers give
/// them without tolerances, and those of equal drives differ by some per cent.
const GAIN_STD: f64 = 0.02;

/// A deviation with that of the drives' gains in it: what is measured in units of torque is off by as much as they are.
fn with_gain(value: &Value, std: Value) -> Value {
    match (value, std) {
        (Value::Array(values), Value::Array(stds)) => {
            values.iter().zip(stds).map(|(value, std)| with_gain(value, std)).collect()
        }
        (value, std) => match (value.as_f64(), std.as_f64()) {
            (Some(value), Some(known)) => json!(known.hypot(GAIN_STD * value)),
            _ => std,
        },
    }
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
    // What stands in for an effect does so on all joints that have it.
    first.alternatives.retain_mut(|a| {
        let on_other = other.alternatives.iter().find(|b| b.effect == a.effect);
        a.joints.extend(on_other.iter().flat_map(|b| &b.joints));
        on_other.is_some()
    });
}

fn append(list: &mut Value, value: Value, parts: usize) {
    match list {
        Value::Array(values) if values.len() == parts - 1 && parts > 2 => values.push(value),
        first => *first = json!([first.take(), value]),
    }
}

/// Orders joints ascending, and the lists along them.
fn sort_by_joint(finding: &mut Finding) {
    for alternative in &mut finding.alternatives {
        alternative.joints.sort_unstable();
        alternative.joints.dedup();
    }
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

/// The claim's rivals of other effects that describe the recordings as well: alternatives to it.
pub(crate) fn open_rivals<'i>(
    investigation: &Investigation,
    one: &'i Chosen,
    fitted: &Fitted,
) -> Vec<&'i Rival> {
    let chosen = &investigation.selection.chosen;
    let effect = |rival: &Rival| investigation.groups[rival.group].effect;
    let mut found: Vec<&Rival> = Vec::new();
    for rival in &one.rivals {
        let group = &investigation.groups[rival.group];
        // What the vocabulary has a word for keeps it.
        if !group.is_named() {
            continue;
        }
        if chosen.iter().any(|c| c.group == rival.group) || found.iter().any(|r| effect(r) == group.effect) {
            continue;
        }
        let free = investigation.problem.free_share(&fitted.switches, &group.switches, &fitted.weights);
        let inseparable = rival.as_good && free.iter().all(|share| *share <= INSEPARABLE);
        if (rival.open || inseparable) && found.len() < ALTERNATIVES {
            found.push(rival);
        }
    }
    found
}

fn alternatives(investigation: &Investigation, one: &Chosen, fitted: &Fitted) -> Vec<Alternative> {
    let alternative = |rival: &Rival| {
        let group = &investigation.groups[rival.group];
        Alternative {
            effect: group.effect.id.to_owned(),
            joints: group.joints.clone(),
            score: rival.score,
            record: group.effect.decider.to_owned(),
        }
    };
    open_rivals(investigation, one, fitted).into_iter().map(alternative).collect()
}

/// The effect that the claim's recordings cannot tell from it, as its joint is loaded in them.
fn same_under_load(
    question: &Question<'_>,
    investigation: &Investigation,
    one: &Chosen,
    own: &[f64],
) -> Option<Alternative> {
    let group = &investigation.groups[one.group];
    let [joint] = group.joints[..] else { return None };
    let is_load = question.model.is_load();
    let acts = |rows: &&RecordingRows| !group.target_only() || rows.role != Role::Calibration;
    let mut load_nm = Vec::new();
    for rows in investigation.rows.iter().filter(acts).map(|rows| &rows.joints[joint]) {
        let mut load = vec![0.0; rows.measurement.len()];
        for (k, column) in investigation.layout.rows[joint].iter().enumerate() {
            if is_load.get(*column) == Some(&true) {
                load.iter_mut().zip(rows.column(k)).for_each(|(sum, x)| *sum += own[*column] * x);
            }
        }
        load_nm.extend(load.into_iter().zip(&rows.counts).filter(|(_, counts)| **counts).map(|(l, _)| l));
    }
    let other = (group.effect.same_under)(&load_nm).filter(|other| question.considers(other))?;
    Some(Alternative {
        effect: other.id.to_owned(),
        joints: vec![joint],
        score: one.score,
        record: other.decider.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alternatives_of_joints_together_have_all_of_them() {
        let other = |effect: &str, joint| Alternative {
            effect: effect.to_owned(),
            joints: vec![joint],
            score: 30.0,
            record: String::new(),
        };
        let on = |joint: usize, others: &[&str]| Finding {
            alternatives: others.iter().map(|effect| other(effect, joint)).collect(),
            ..Finding::new(effects::find("coulomb_asymmetry").unwrap(), vec![joint], Evidence::default(), 0.9)
        };
        let mut first = on(4, &["current_offset", "coulomb"]);
        merge(&mut first, on(1, &["current_offset"]), 2);
        sort_by_joint(&mut first);
        assert_eq!(first.joints, [1, 4]);
        let alternatives: Vec<_> =
            first.alternatives.iter().map(|a| (&a.effect[..], &a.joints[..])).collect();
        assert_eq!(alternatives, [("current_offset", &[1, 4][..])]);
    }
}
