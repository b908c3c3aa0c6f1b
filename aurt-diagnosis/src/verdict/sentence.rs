//! Findings in words.

use aurt_calibration::with_deviation;

use serde_json::Value;

use crate::effects;
use crate::request::Question;
use crate::verdict::Finding;
use crate::vocabulary::Wording;

/// An effect in a sentence: what it is, on which joints, in which recordings, and its parameters in the order of the vocabulary.
pub(crate) fn sentence(finding: &Finding, question: &Question<'_>) -> String {
    let (unit, names) = (question.unit, question.names());
    let changed = finding.present_in == ["target"];
    let when = if changed { ", in the target recordings only" } else { "" };
    let effect = effects::find(&finding.effect);
    let slides = !finding.joints.is_empty()
        && finding.joints.iter().all(|joint| question.model.rigid_body().slides(*joint));
    let joints = names.joint_list(&finding.joints);
    if let Some(wording) = effect.and_then(|e| e.wording) {
        let Wording { phrase, detail } = wording(&finding.parameters, unit, names);
        let detail = if detail.is_empty() { detail } else { format!(" ({detail})") };
        return format!("{phrase}, seen on {joints}{when}{detail}");
    }
    let title = effect.map_or(finding.effect.as_str(), |e| e.title);
    let on = if effect.is_some_and(|e| e.is_whole_arm) { "seen on" } else { "on" };
    let place = |name: &String| effect.and_then(|e| e.parameters.iter().position(|p| p.name == *name));
    let mut parameters: Vec<_> = finding.parameters.iter().collect();
    parameters.sort_by_key(|(name, _)| place(name).unwrap_or(usize::MAX));
    let key: Vec<String> = parameters
        .into_iter()
        .filter_map(|(name, p)| {
            let parameter = effect.and_then(|e| e.parameter(name));
            let name = parameter.map_or_else(|| name.clone(), |p| p.name_in(unit, slides));
            let values: Option<Vec<String>> = match (p.value.as_array(), p.std.as_array()) {
                (Some(values), Some(stds)) if values.len() == finding.joints.len() => {
                    values.iter().zip(stds).map(|(value, std)| number(value, std)).collect()
                }
                _ => number(&p.value, &p.std).map(|value| vec![value]),
            };
            Some(format!("{name} = {}", values?.join(", ")))
        })
        .collect();
    let key = if key.is_empty() { String::new() } else { format!(" ({})", key.join(", ")) };
    format!("{title} {on} {joints}{when}{key}")
}

/// A value with its deviation, if there is one.
fn number(value: &Value, std: &Value) -> Option<String> {
    let value = value.as_f64()?;
    Some(std.as_f64().map_or_else(|| short(value), |std| with_deviation(value, std)))
}

/// A value of which no deviation is known: numbers of things as they are, others to four digits.
fn short(value: f64) -> String {
    if value.fract() == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let digits = (3.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn values_without_a_deviation_have_four_digits() {
        assert_eq!([short(5.0), short(0.593_439_36), short(-1234.56)], ["5", "0.5934", "-1235"]);
    }
}
