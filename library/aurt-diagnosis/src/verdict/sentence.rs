//! Findings in words.

use aurt_calibration::with_deviation;
use aurt_traits::MeasurementUnit;

use crate::hypotheses::effects;
use crate::verdict::Finding;

/// An effect in a sentence: what it is, on which joints, in which recordings, and its first parameters.
pub(crate) fn sentence(finding: &Finding, unit: MeasurementUnit) -> String {
    let in_nm = sentence_in_nm(finding);
    if unit == MeasurementUnit::NewtonMetre { in_nm } else { in_amperes(&in_nm) }
}

/// A sentence about torques as one about currents: what is in Nm is in A, and what is in kg is in A/Nm kg.
#[must_use]
pub fn in_amperes(sentence: &str) -> String {
    sentence
        .replace("_nm", "_a")
        .replace("_kg", "_a_per_nm_kg")
        .replace(" kg", " A/Nm kg")
        .replace(" Nm", " A")
}

fn sentence_in_nm(finding: &Finding) -> String {
    let changed = finding.present_in == ["target"];
    let when = if changed { ", in the target recordings only" } else { "" };
    let phrase = effects::find(&finding.effect).and_then(|e| e.phrase(&finding.parameters));
    if let Some(phrase) = phrase {
        return format!("{phrase}, seen on {}{when}", joint_list(&finding.joints));
    }
    let title = effects::find(&finding.effect).map_or(finding.effect.as_str(), |e| e.title());
    let whole = effects::find(&finding.effect).is_some_and(|e| e.whole_arm());
    let plural = match (whole, finding.joints.len()) {
        (true, _) => "seen on joints",
        (false, 1) => "on joint",
        (false, _) => "on joints",
    };
    let joints = joint_numbers(&finding.joints);
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

/// "joint 2", "joints 1, 2".
pub(crate) fn joint_list(joints: &[usize]) -> String {
    format!("joint{} {}", if joints.len() == 1 { "" } else { "s" }, joint_numbers(joints))
}

fn joint_numbers(joints: &[usize]) -> String {
    joints.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::{in_amperes, short};

    #[test]
    fn masses_of_a_model_in_amperes_are_not_kilograms() {
        let said = in_amperes("a payload of 0.2506 ± 0.0050 kg on link 5 (amplitude_nm = 4.2)");
        assert_eq!(said, "a payload of 0.2506 ± 0.0050 A/Nm kg on link 5 (amplitude_a = 4.2)");
    }

    #[test]
    fn values_without_a_deviation_have_four_digits() {
        assert_eq!([short(5.0), short(0.593_439_36), short(-1234.56)], ["5", "0.5934", "-1235"]);
    }
}
