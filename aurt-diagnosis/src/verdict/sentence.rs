//! Findings in words.

use aurt_calibration::with_deviation;
use aurt_traits::MeasurementUnit;

use crate::effects;
use crate::verdict::Finding;

/// An effect in a sentence: what it is, on which joints, in which recordings, and its first parameters.
pub(crate) fn sentence(finding: &Finding, unit: MeasurementUnit) -> String {
    let changed = finding.present_in == ["target"];
    let when = if changed { ", in the target recordings only" } else { "" };
    let effect = effects::find(&finding.effect);
    let phrase = effect.and_then(|e| e.phrase).and_then(|phrase| phrase(&finding.parameters, unit));
    if let Some(phrase) = phrase {
        return format!("{phrase}, seen on {}{when}", joint_list(&finding.joints));
    }
    let title = effect.map_or(finding.effect.as_str(), |e| e.title);
    let plural = match (effect.is_some_and(|e| e.is_whole_arm), finding.joints.len()) {
        (true, _) => "seen on joints",
        (false, 1) => "on joint",
        (false, _) => "on joints",
    };
    let joints = joint_numbers(&finding.joints);
    let key: Vec<String> = finding
        .parameters
        .iter()
        .filter_map(|(name, p)| {
            let parameter = effect.and_then(|e| e.parameter(name));
            let name = parameter.map_or_else(|| name.clone(), |p| p.name_in(unit));
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

/// "joint 2", "joints 1, 2".
pub(crate) fn joint_list(joints: &[usize]) -> String {
    format!("joint{} {}", if joints.len() == 1 { "" } else { "s" }, joint_numbers(joints))
}

fn joint_numbers(joints: &[usize]) -> String {
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
