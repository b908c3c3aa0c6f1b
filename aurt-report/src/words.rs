//! What a verdict says, in the order in which a person asks: has something changed, what is missing, does it hold.

use aurt::Asked;
use aurt_diagnosis::{
    Answer, Finding, Indication, JointResidual, NotDecidable, Verdict, effects, vocabulary::Family,
};

use crate::rendering::{joints::label, number::significant, text::listed};

/// Where a finding was seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// In the targets and not in the other recordings.
    Changed,
    /// In all recordings.
    Missing,
    /// In the calibration recordings and not in the targets.
    Before,
    /// It is the recordings', not the robot's.
    Fault,
}

/// Findings of one place, each with its number in the verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct Group<'v> {
    /// Where they were seen.
    pub place: Place,
    /// What stands over them; empty where there is nothing to tell apart.
    pub title: &'static str,
    /// The findings.
    pub findings: Vec<(usize, &'v Finding)>,
}

fn place(finding: &Finding, asked: Asked) -> Place {
    let only = |kind: &str| finding.present_in.iter().all(|k| k == kind);
    match asked {
        _ if finding.family == Family::Q => Place::Fault,
        Asked::Change if only("target") => Place::Changed,
        Asked::Change if only("calibration") => Place::Before,
        _ => Place::Missing,
    }
}

const fn title(place: Place, asked: Asked) -> &'static str {
    match (place, asked) {
        (Place::Changed, _) => "changed in the target",
        (Place::Missing, Asked::Change) => "missing in all recordings",
        (Place::Missing, Asked::Beyond) => "in the target, beyond the model",
        (Place::Missing, Asked::Lack) => "",
        (Place::Before, _) => "in the calibration recordings only",
        (Place::Fault, _) => "faults of the recordings",
    }
}

/// The findings by where they were seen. Where a change was asked for, its group is there even if it is empty.
pub fn groups(verdict: &Verdict, asked: Asked) -> Vec<Group<'_>> {
    let of = |wanted: Place| Group {
        place: wanted,
        title: title(wanted, asked),
        findings: (1..).zip(&verdict.effects).filter(|(_, f)| place(f, asked) == wanted).collect(),
    };
    [Place::Changed, Place::Missing, Place::Before, Place::Fault]
        .map(of)
        .into_iter()
        .filter(|g| !g.findings.is_empty() || (asked == Asked::Change && g.place == Place::Changed))
        .collect()
}

/// What an empty group says: nothing, as far as names go.
pub const fn nothing(answer: Answer) -> &'static str {
    match answer {
        Answer::Unexplained => "nothing that was identified",
        _ => "nothing",
    }
}

/// A finding's sentence below its group's title, which says where it was seen.
pub fn claim(finding: &Finding, asked: Asked) -> String {
    match asked {
        Asked::Change => finding.sentence.replacen(", in the target recordings only", "", 1),
        Asked::Lack | Asked::Beyond => finding.sentence.clone(),
    }
}

/// The answer in words.
pub fn headline(verdict: &Verdict, asked: Asked) -> String {
    let mut words = match asked {
        Asked::Change => changed(verdict, asked),
        Asked::Lack | Asked::Beyond => missing(verdict, asked),
    };
    if fails_on_held_out(verdict, asked) {
        words.push_str(" – but held-out data are predicted worse with it");
    }
    words
}

/// What a reader who is told of nothing may want to know next.
pub const HOW_LARGE: &str =
    "`aurt sensitivity` says how large an effect could be and stay hidden in these recordings.";

/// What has changed; and, where nothing has, what is missing in all recordings.
fn changed(verdict: &Verdict, asked: Asked) -> String {
    let differs = |f: &Finding| matches!(place(f, asked), Place::Changed | Place::Before);
    let [changes, faults] = [brief(verdict, differs), brief(verdict, |f| place(f, asked) == Place::Fault)];
    let only_before = changes.is_some() && !verdict.effects.iter().any(|f| place(f, asked) == Place::Changed);
    match (verdict.verdict, changes) {
        (Answer::NoMismatch, _) => match verdict.structure {
            None | Some(Answer::NoMismatch) => {
                "nothing has changed and nothing is missing: the residual is noise".to_owned()
            }
            Some(Answer::Named) if faults.is_some() && !has_physics(verdict) => {
                "nothing has changed; a fault of the recordings explains the residual".to_owned()
            }
            Some(Answer::Named) => {
                "nothing has changed; what the model lacks in all recordings was identified".to_owned()
            }
            Some(Answer::PartlyExplained) => {
                "nothing has changed; part of what the model lacks in all recordings was identified".to_owned()
            }
            Some(Answer::Unexplained) => {
                "nothing has changed; the model lacks something in all recordings that no known effect explains"
                    .to_owned()
            }
        },
        (Answer::Named, Some(changes)) if only_before => {
            format!("in the calibration recordings and not in the target: {changes}")
        }
        (Answer::Named, Some(changes)) => format!("changed since calibration: {changes}"),
        (Answer::PartlyExplained, changes) => {
            let changes = changes.unwrap_or_else(|| "something".to_owned());
            format!("changed since calibration: {changes}, and something that no known effect explains")
        }
        (Answer::Named, None) => match faults {
            Some(fault) => format!("a fault of the recordings explains the difference: {fault}"),
            None => "the cause was identified".to_owned(),
        },
        (Answer::Unexplained, Some(changes)) => {
            format!("something has changed that no known effect explains; part of it resembles {changes}")
        }
        (Answer::Unexplained, None) => {
            "something has changed in the target that no known effect explains".to_owned()
        }
    }
}

/// What a model lacks, where that is the only question.
fn missing(verdict: &Verdict, asked: Asked) -> String {
    let found = brief(verdict, |f| place(f, asked) != Place::Fault);
    match (verdict.verdict, found) {
        (Answer::NoMismatch, _) => "nothing is missing: the residual is noise".to_owned(),
        (Answer::Named, None) => "a fault of the recordings explains the difference".to_owned(),
        (Answer::Named, Some(found)) => format!("the model lacks {found}"),
        (Answer::PartlyExplained, found) => {
            let found = found.unwrap_or_else(|| "something".to_owned());
            format!("the model lacks {found}, and something that no known effect explains")
        }
        (Answer::Unexplained, Some(found)) => {
            format!("the model lacks something that no known effect explains; part of it resembles {found}")
        }
        (Answer::Unexplained, None) => "the model lacks something that no known effect explains".to_owned(),
    }
}

fn has_physics(verdict: &Verdict) -> bool {
    verdict.effects.iter().any(|f| f.family != Family::Q)
}

/// The first of some findings in a few words, and how many more there are.
fn brief(verdict: &Verdict, which: impl Fn(&Finding) -> bool) -> Option<String> {
    let mut found = verdict.effects.iter().filter(|f| which(f));
    let first = found.next()?;
    let effect = effects::find(&first.effect);
    let phrase = effect.and_then(|e| e.phrase).and_then(|phrase| phrase(&first.parameters, verdict.unit));
    let named = phrase.unwrap_or_else(|| {
        let title = effect.map_or(first.effect.as_str(), |e| e.title);
        let title = title.split(" (").next().unwrap_or(title);
        let joints: Vec<String> = first.joints.iter().map(ToString::to_string).collect();
        match (effect.is_some_and(|e| e.is_whole_arm) || first.family == Family::Q, joints.len()) {
            (true, _) => title.to_owned(),
            (false, 1) => format!("{title} on {}", label(&verdict.joint_names, first.joints[0])),
            (false, _) => format!("{title} on joints {}", listed(&joints)),
        }
    });
    let named = match first.alternatives.first() {
        Some(other) => {
            let title = effects::find(&other.effect).map_or(other.effect.as_str(), |e| e.title);
            format!("{named} or {}", title.split(" (").next().unwrap_or(title))
        }
        None => named,
    };
    Some(match found.count() {
        0 => named,
        1 => format!("{named}, and one more effect"),
        more => format!("{named}, and {more} more effects"),
    })
}

/// An indication in a line: what it would be, and what it fails.
pub fn indicated(indication: &Indication, asked: Asked) -> String {
    format!("{}: not claimed, since {}", claim(&indication.finding, asked), indication.fails.join("; "))
}

/// How much of the held-out error that trees can predict the claims explain, in a sentence with the interval of two deviations.
pub fn explained(verdict: &Verdict) -> Option<String> {
    let share = verdict.explained?;
    let of = |value: f64| format!("{:.0}", 100.0 * value.clamp(0.0, 1.0));
    let [low, high] = [-2.0, 2.0].map(|deviations| of(share.value + deviations * share.std));
    let interval = if low == high { String::new() } else { format!(" ({low} to {high} %)") };
    Some(format!("the claims explain {} %{interval} of the held-out error beyond noise", of(share.value)))
}

/// What is left of a joint's residual, in a few words: the coordinate that it follows, or how far it is from noise.
/// Where no claim is made, none is made either way: 1.4 times the noise is not "nothing".
pub fn follows(residual: &JointResidual) -> String {
    let times = residual.unexplained_rms / residual.floor_rms;
    match (&residual.follows, residual.structure_left) {
        (Some(what), _) => format!("{what} ({:.0} % of the rest)", 100.0 * residual.follows_share),
        (None, true) => format!("unknown, {times:.2} × noise"),
        (None, false) if times > NEAR_NOISE => format!("no claim, {times:.2} × noise"),
        (None, false) => String::new(),
    }
}

/// A residual up to this multiple of the noise floor is noise as far as anyone can tell.
const NEAR_NOISE: f64 = 1.25;

/// Whether a joint's error was measured on held-out data, before and after.
fn is_judged(verdict: &Verdict, joint: usize) -> bool {
    let known = |of: &[f64]| of.get(joint).is_some_and(|v| v.is_finite());
    known(&verdict.held_out.rms_before) && known(&verdict.held_out.rms_after)
}

/// Whether held-out data speak against what the headline is about, the first finding of the first group: the error grows
/// on at least half of its joints.
fn fails_on_held_out(verdict: &Verdict, asked: Asked) -> bool {
    let groups = groups(verdict, asked);
    let Some((_, first)) = groups.iter().find_map(|g| g.findings.first()) else { return false };
    let judged: Vec<usize> = first.joints.iter().copied().filter(|j| is_judged(verdict, *j)).collect();
    let worse = judged.iter().filter(|j| verdict.held_out.is_worse(**j)).count();
    !judged.is_empty() && 2 * worse >= judged.len()
}

/// What held-out data say against a finding, where they do: on which of its joints the error grows.
pub fn objection(verdict: &Verdict, finding: &Finding, unit: &str) -> Option<String> {
    let held = &verdict.held_out;
    let judged: Vec<usize> = finding.joints.iter().copied().filter(|j| is_judged(verdict, *j)).collect();
    let worse: Vec<String> = judged
        .iter()
        .filter(|j| held.is_worse(**j))
        .map(|j| {
            let [before, after] = [&held.rms_before, &held.rms_after].map(|of| significant(of[*j], 3));
            format!("{} ({before} → {after} {unit})", label(&verdict.joint_names, *j))
        })
        .collect();
    if worse.is_empty() {
        return None;
    }
    let all = worse.len() == judged.len();
    let rest = if all { String::new() } else { ", and not on the others".into() };
    Some(format!(
        "does not hold on held-out data: with all findings in the model, the error grows on {}{rest}",
        listed(&worse)
    ))
}

/// An effect that these recordings cannot decide, with its joints.
pub fn undecidable(effect: &NotDecidable) -> String {
    let joints: Vec<String> = effect.joints.iter().map(ToString::to_string).collect();
    match joints.len() {
        0 => effect.effect.clone(),
        1 => format!("{} (joint {})", effect.effect, joints[0]),
        _ => format!("{} (joints {})", effect.effect, listed(&joints)),
    }
}

#[cfg(test)]
mod tests {
    use aurt_diagnosis::{Evidence, HeldOut, ParameterValue};
    use aurt_traits::MeasurementUnit;

    use super::*;

    fn finding(effect: &str, family: Family, joints: &[usize], present_in: &[&str]) -> Finding {
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
            stability: None,
            sentence: format!("{effect}{only} (k = 1)"),
        }
    }

    fn verdict(answer: Answer, effects: Vec<Finding>, before: &[f64], after: &[f64]) -> Verdict {
        Verdict {
            schema: aurt_diagnosis::SCHEMA,
            settings: aurt_diagnosis::SelectionOptions::default(),
            explained: None,
            remainder: Vec::new(),
            joint_names: Vec::new(),
            unit: MeasurementUnit::NewtonMetre,
            verdict: answer,
            structure: None,
            effects,
            indications: Vec::new(),
            not_examined: Vec::new(),
            not_decidable: Vec::new(),
            residual: Vec::new(),
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
        assert_eq!(headline(&found, Asked::Change), "changed since calibration: a load attached to a link");
        let mut removed = found.clone();
        let number = |value: f64| ParameterValue { value: value.into(), std: serde_json::Value::Null };
        removed.effects[1].parameters.insert("mass_kg".into(), number(-2.764));
        removed.effects[1].parameters.insert("link".into(), number(5.0));
        let said = "changed since calibration: a load of 2.764 kg removed from link 5";
        assert_eq!(headline(&removed, Asked::Change), said);
        assert_eq!(claim(groups[0].findings[0].1, Asked::Change), "payload (k = 1)");
        let nothing = verdict(Answer::NoMismatch, Vec::new(), &[1.0], &[1.0]);
        assert!(headline(&nothing, Asked::Change).starts_with("nothing has changed"));
        assert!(!headline(&nothing, Asked::Lack).contains("changed"));
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
}
