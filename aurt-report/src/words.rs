//! What a verdict says, in the order in which a person asks: has something changed, what is missing, does it hold.

use aurt::Asked;
use aurt_diagnosis::vocabulary::Family;
use aurt_diagnosis::{
    Answer, Finding, Indication, JointResidual, NotDecidable, Verdict, VisibleGear, effects,
};
use aurt_traits::RobotNames;

use crate::noise_report::{JointNoise, NoiseReport, NoiseState};
use crate::rendering::number::significant;
use crate::rendering::text::listed;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// In the targets and not in the other recordings.
    Changed,
    Missing,
    /// In the calibration recordings and not in the targets.
    Before,
    /// It is the recordings', not the robot's.
    Fault,
}

/// Findings of one place, each with its number in the verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct Group<'v> {
    pub place: Place,
    /// What stands over them; empty where there is nothing to tell apart.
    pub title: &'static str,
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

/// The words of an empty group: nothing, as far as names and tests go.
pub fn nothing(verdict: &Verdict) -> &'static str {
    match verdict.verdict {
        Answer::Unexplained => "nothing that was identified",
        _ if !verdict.indicated_changes(false).is_empty() => "nothing that is confirmed",
        _ if !verdict.indicated_changes(true).is_empty() => "nothing by more than is usual",
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

pub fn headline(verdict: &Verdict, asked: Asked) -> String {
    let mut words = match asked {
        Asked::Change => changed(verdict, asked),
        Asked::Lack | Asked::Beyond => missing(verdict, asked),
    };
    if fails_on_held_out(verdict, asked) {
        words.push_str(" – but held-out data are predicted worse with it");
    }
    match held_out_differs(verdict) {
        Some(difference) if verdict.verdict == Answer::HeldOutDiffers => format!("{difference}; {words}"),
        Some(difference) => format!("{words}; {difference}"),
        None => words,
    }
}

/// The joints on which the held-out recordings are another state of the robot, with factors.
fn held_out_differs(verdict: &Verdict) -> Option<String> {
    let joints: Vec<usize> = verdict.held_out_differs.iter().map(|d| d.joint).collect();
    if joints.is_empty() {
        return None;
    }
    let factor = |joint: usize| {
        let difference = verdict.held_out_differs.iter().find(|d| d.joint == joint);
        difference.map_or(String::new(), |d| match d.rms / d.expected_rms {
            // The model is so uncertain there that no error would be unexpected.
            factor if factor < 1.0 => " (the error exceeds the measurement itself)".into(),
            factor => format!(" ({factor:.1} times the expected error)"),
        })
    };
    Some(format!(
        "the held-out data ({}) differ from the fitted ones on {}",
        verdict.held_out.recordings.join(", "),
        verdict.names().joint_list_with(&joints, factor)
    ))
}

/// What a reader who is told of nothing may want to know next.
pub const HOW_LARGE: &str =
    "`aurt sensitivity` gives, for each effect, the largest size that these recordings could hide.";

/// What has changed, then what is missing in all recordings.
fn changed(verdict: &Verdict, asked: Asked) -> String {
    let of = |wanted: Place| {
        brief(verdict, verdict.effects.iter().filter(|f| place(f, asked) == wanted).collect())
    };
    let [changes, missing, before, fault] =
        [Place::Changed, Place::Missing, Place::Before, Place::Fault].map(of);
    let nameless = "something that no claim explains";
    let unconfirmed = unconfirmed_change(verdict);
    let difference = match (verdict.verdict, changes, before) {
        (Answer::NoMismatch, ..) => unconfirmed.clone().unwrap_or_else(|| "nothing has changed".to_owned()),
        (Answer::HeldOutDiffers, ..) if unconfirmed.is_some() => {
            "no change of the target is confirmed".to_owned()
        }
        (Answer::HeldOutDiffers, ..) => "no change was found in the target".to_owned(),
        (Answer::Named, Some(changes), _) => format!("changed since calibration: {changes}"),
        (Answer::Named, None, Some(before)) => {
            format!("in the calibration recordings and not in the target: {before}")
        }
        (Answer::Named, None, None) => match fault.clone() {
            Some(fault) => format!("a fault of the recordings explains the difference: {fault}"),
            None => "the cause was identified".to_owned(),
        },
        (Answer::PartlyExplained, Some(changes), _) => {
            format!("changed since calibration: {changes}, and {nameless}")
        }
        (Answer::Unexplained, Some(changes), _) => {
            format!("something has changed that no known effect explains; part of it resembles {changes}")
        }
        (Answer::PartlyExplained | Answer::Unexplained, None, Some(before)) => format!(
            "something has changed that no known effect explains; in the calibration recordings and not in the target: {before}"
        ),
        (Answer::PartlyExplained | Answer::Unexplained, None, None) => {
            "something has changed in the target that no known effect explains".to_owned()
        }
    };
    let lack = match (verdict.structure, missing) {
        (None | Some(Answer::NoMismatch), None) if verdict.verdict == Answer::NoMismatch => {
            return match unconfirmed {
                Some(difference) => {
                    let lack = clean(verdict, "nothing is missing", "no missing effect was found");
                    format!("{difference}; {lack}")
                }
                None => clean(
                    verdict,
                    "nothing has changed and nothing is missing",
                    "no change and no missing effect was found",
                ),
            };
        }
        (Some(Answer::Named), None) if fault.is_some() && verdict.verdict == Answer::NoMismatch => {
            "a fault of the recordings explains the residual".to_owned()
        }
        (Some(Answer::PartlyExplained), Some(missing)) => {
            format!("the model lacks {missing}, and {nameless}")
        }
        (Some(Answer::Unexplained), Some(missing)) => {
            format!("the model lacks {nameless}; part of it resembles {missing}")
        }
        (_, Some(missing)) => format!("the model lacks {missing}"),
        (Some(Answer::PartlyExplained | Answer::Unexplained), None) => format!("the model lacks {nameless}"),
        (_, None) => return difference,
    };
    format!("{difference}; in all recordings {lack}")
}

/// A change that the target shows beyond chance and that fails a test, in words, or that there are none but usual ones.
fn unconfirmed_change(verdict: &Verdict) -> Option<String> {
    let indicated = verdict.indicated_changes(false);
    let fail = if indicated.len() == 1 { "fails a test" } else { "fail a test" };
    let unconfirmed = brief(verdict, indicated)
        .map(|named| format!("no change is confirmed: the target indicates {named}, which {fail}"));
    let has_usual = !verdict.indicated_changes(true).is_empty();
    let usual = "nothing has changed by more than recordings of an unchanged robot differ by";
    unconfirmed.or_else(|| has_usual.then(|| usual.to_owned()))
}

fn missing(verdict: &Verdict, asked: Asked) -> String {
    let found = brief(verdict, verdict.effects.iter().filter(|f| place(f, asked) != Place::Fault).collect());
    match (verdict.verdict, found) {
        (Answer::NoMismatch, _) => clean(verdict, "nothing is missing", "no missing effect was found"),
        (Answer::HeldOutDiffers, _) => "no missing effect was found in the fitted recordings".to_owned(),
        (Answer::Named, None) => "a fault of the recordings explains the difference".to_owned(),
        (Answer::Named, Some(found)) => format!("the model lacks {found}"),
        (Answer::PartlyExplained, found) => {
            let found = found.unwrap_or_else(|| "something".to_owned());
            format!("the model lacks {found}, and something that no claim explains")
        }
        (Answer::Unexplained, Some(found)) => {
            format!("the model lacks something that no known effect explains; part of it resembles {found}")
        }
        (Answer::Unexplained, None) => "the model lacks something that no known effect explains".to_owned(),
    }
}

/// The headline of a verdict without claims: `nothing` only where noise explains the error of every joint.
fn clean(verdict: &Verdict, nothing: &str, unclaimed: &str) -> String {
    let beyond = NoiseReport::of(verdict).beyond_noise();
    if beyond.is_empty() {
        return format!("{nothing}: the residual is noise");
    }
    let floor = if beyond.len() == 1 { "its noise floor" } else { "their noise floor" };
    format!("{unclaimed}; the error of {} exceeds {floor}", verdict.names().joint_list(&beyond))
}

/// The finding with the most evidence in a few words, and the other one, or how many more there are.
fn brief(verdict: &Verdict, mut found: Vec<&Finding>) -> Option<String> {
    found.sort_by(|a, b| b.evidence.score.total_cmp(&a.evidence.score));
    let title = |id: &str| {
        let title = effects::find(id).map_or(id, |e| e.title);
        title.split(" (").next().unwrap_or(title).to_owned()
    };
    let short = |finding: &Finding| {
        let effect = effects::find(&finding.effect);
        let named = match effect.and_then(|e| e.wording) {
            Some(wording) => wording(&finding.parameters, verdict.unit, verdict.names()).phrase,
            None if effect.is_some_and(|e| e.is_whole_arm) || finding.family == Family::Q => {
                title(&finding.effect)
            }
            None => format!("{} on {}", title(&finding.effect), verdict.names().joint_list(&finding.joints)),
        };
        match finding.alternatives.first() {
            Some(other) => format!("{named} or {}", title(&other.effect)),
            None => named,
        }
    };
    match found[..] {
        [] => None,
        [one] => Some(short(one)),
        [one, other] => Some(format!("{}, and {}", short(one), short(other))),
        [first, ..] => Some(format!("{}, and {} more effects", short(first), found.len() - 1)),
    }
}

/// The indications of a verdict in a line each; those of joints or parts that read alike are told once.
pub fn all_indicated(verdict: &Verdict, asked: Asked) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for indication in &verdict.indications {
        let line = indicated(indication, asked);
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    lines
}

/// An indication in a line: what it would be, and what it fails.
fn indicated(indication: &Indication, asked: Asked) -> String {
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

/// A joint's residual in a few words: the coordinate that it follows, or its distance from noise.
pub fn follows(residual: &JointResidual, error: Option<&JointNoise>) -> String {
    let times = error.and_then(|e| e.after).unwrap_or(residual.unexplained_rms / residual.floor_rms);
    match (&residual.follows, error.map(|e| e.state)) {
        (Some(feature), _) => format!("{feature} ({:.0} % of the rest)", 100.0 * residual.follows_share),
        (None, Some(NoiseState::Structured)) => {
            format!("unknown, {:.2} × noise", residual.unexplained_rms / residual.floor_rms)
        }
        (None, Some(NoiseState::AboveNoise)) => format!("no claim, {times:.2} × noise"),
        (None, Some(NoiseState::WithinNoise | NoiseState::NotJudged) | None) => String::new(),
    }
}

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
            format!("{} ({before} → {after} {unit})", verdict.names().joint(*j))
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
pub fn undecidable(effect: &NotDecidable, names: RobotNames<'_>) -> String {
    if effect.joints.is_empty() {
        return effect.effect.clone();
    }
    format!("{} ({})", effect.effect, names.joint_list(&effect.joints))
}

/// The band in which model and measurement are compared; `None` in a verdict that does not have it.
pub fn band(verdict: &Verdict) -> Option<String> {
    let f_dyn_hz = verdict.settings.f_dyn_hz?;
    Some(format!("all errors are of dynamics up to {f_dyn_hz} Hz (f_dyn)"))
}

/// The gears that would have shown, from the least to the most of all joints, in a sentence.
pub fn visible_gears(verdict: &Verdict) -> Option<String> {
    let gears = &verdict.gears_visible;
    let range = |of: &dyn Fn(&VisibleGear) -> Option<f64>| {
        let least = gears.iter().filter_map(of).min_by(f64::total_cmp)?;
        let most = gears.iter().filter_map(of).max_by(f64::total_cmp)?;
        let [least, most] = [least, most].map(|value| format!("{value:.1e}"));
        Some(if least == most { least } else { format!("{least} to {most}") })
    };
    let softer = range(&|g| g.below_nm_rad).map(|stiffness| format!("gears softer than {stiffness} Nm/rad"));
    let wider = range(&|g| g.beyond_rad).map(|play| format!("play beyond ± {play} rad"));
    let visible: Vec<String> = [softer, wider].into_iter().flatten().collect();
    let shows = gears.iter().filter(|g| g.below_nm_rad.is_some() || g.beyond_rad.is_some()).count();
    let on =
        if shows == gears.len() { String::new() } else { format!(" on {shows} of {} joints", gears.len()) };
    (!visible.is_empty()).then(|| format!("{} would show{on}", visible.join(" or ")))
}

#[cfg(test)]
pub(crate) mod tests;
