//! What "badly excited" means, in one place: `aurt check` says it before a calibration, the calibration after.

use std::collections::BTreeMap;

use aurt_traits::RobotNames;

use crate::rows::Observed;
use crate::{CalibratedParameter, Rest};

/// A standard deviation above this share of the value: the interval then includes zero.
const LARGE_RELATIVE_STD_DEV_PERCENT: f64 = 50.0;

/// A standard deviation above this share of the largest value of the same unit is large. Below it the parameter is known to
/// be small, which motions need not be blamed for.
const LARGE_AMONG_ITS_KIND_PERCENT: f64 = 10.0;

/// Above this condition number some combination of parameters is hardly excited (Gautier and Khalil 1992 aim at 100 or
/// less).
const LARGE_CONDITION_NUMBER: f64 = 100.0;

/// The parameters that motions determine badly, in words: those whose standard deviation exceeds half their value and a
/// tenth of the largest value of their kind.
pub fn badly_excited(parameters: &[CalibratedParameter]) -> Option<String> {
    let mut largest: BTreeMap<&str, f64> = BTreeMap::new();
    for p in parameters {
        let known = largest.entry(p.unit.as_str()).or_insert(0.0);
        *known = known.max(p.value.abs());
    }
    let is_vague = |p: &&CalibratedParameter| {
        let kind = largest.get(p.unit.as_str()).copied().unwrap_or(0.0);
        p.relative_std_dev_percent.is_some_and(|r| r > LARGE_RELATIVE_STD_DEV_PERCENT)
            && p.std_dev.is_some_and(|s| 100.0 * s > LARGE_AMONG_ITS_KIND_PERCENT * kind)
    };
    let vague: Vec<&str> = parameters.iter().filter(is_vague).map(|p| p.name.as_str()).collect();
    (!vague.is_empty()).then(|| {
        format!(
            "badly excited (standard deviation above {LARGE_RELATIVE_STD_DEV_PERCENT} % of the value and \
             {LARGE_AMONG_ITS_KIND_PERCENT} % of the largest of its unit): {}",
            vague.join(", ")
        )
    })
}

/// What a condition number says against the motions, if it does.
pub fn hardly_excited(condition_number: f64) -> Option<String> {
    (condition_number > LARGE_CONDITION_NUMBER).then(|| {
        format!(
            "the condition number is {condition_number:.0}, above {LARGE_CONDITION_NUMBER}: a combination of parameters is \
             hardly excited"
        )
    })
}

/// The warning of rows at rest that friction was fitted to.
pub(crate) fn at_rest(rows: &Observed<'_>, names: RobotNames<'_>) -> Option<String> {
    let options = rows.options;
    let share = |joint: usize| {
        let [mut rests, mut all] = [0, 0];
        let rest = options.rest_velocity(&**rows.model.rigid_body(), joint);
        for segment in rows.recordings.iter().flat_map(|r| &r.data.segments) {
            let speeds = segment.motion.view().velocity_rad_s(joint);
            rests += speeds.iter().filter(|v| v.abs() <= rest).count();
            all += speeds.len();
        }
        if rests < all { rests as f64 / all as f64 } else { 0.0 }
    };
    let shares: Vec<f64> = (0..rows.model.joints()).map(share).collect();
    let joints: Vec<usize> = (0..shares.len()).filter(|j| shares[*j] > Rest::MOST_KEPT).collect();
    (options.rest == Rest::Keep && !joints.is_empty()).then(|| {
        format!(
            "{} rest in up to {:.0} % of the rows, where the sign of the velocity is that of noise, so that their friction comes out too small; \
             leave these rows out with `rest = \"exclude\"` of [calibration]",
            names.joint_list(&joints),
            100.0 * shares.iter().copied().fold(0.0, f64::max)
        )
    })
}

/// Warnings about parameters that the recordings determine badly or not at all; `inseparable` are those that no motion
/// would determine, with the combinations that are.
pub(crate) fn warnings(
    parameters: &[CalibratedParameter],
    inseparable: &[(&str, String)],
    condition_number: f64,
) -> Vec<String> {
    let is_inseparable = |name: &str| inseparable.iter().any(|(own, _)| *own == name);
    let silent: Vec<&str> = parameters
        .iter()
        .filter(|p| !p.excited && !is_inseparable(&p.name))
        .map(|p| p.name.as_str())
        .collect();
    let out_of_reach = (!silent.is_empty()).then(|| {
        format!(
            "not determined by the calibration recordings and set to zero: {}; the model is not valid for motions that need \
             them",
            silent.join(", ")
        )
    });
    let structure = (!inseparable.is_empty()).then(|| {
        let each: Vec<String> =
            inseparable.iter().map(|(name, sums)| format!("{name} (determined: {sums})")).collect();
        format!(
            "structurally inseparable and set to zero: {}; no motion separates them, and predictions are not affected",
            each.join("; ")
        )
    });
    [out_of_reach, structure, badly_excited(parameters), hardly_excited(condition_number)]
        .into_iter()
        .flatten()
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(name: &str, unit: &str, value: f64, std: f64) -> CalibratedParameter {
        CalibratedParameter {
            name: name.into(),
            unit: unit.into(),
            value,
            std_dev: Some(std),
            relative_std_dev_percent: Some(100.0 * std / value.abs()),
            interval_95: None,
            excited: true,
        }
    }

    #[test]
    fn what_is_known_to_be_small_is_not_blamed_on_the_motions() {
        let parameters = [
            parameter("ZZ_1", "kg m^2", 5.0, 0.01),
            parameter("XY_1", "kg m^2", 0.01, 0.02),
            parameter("ZZ_5", "kg m^2", 1.2, 0.9),
            parameter("F_v1_5", "Nm s/rad", 0.3, 0.2),
        ];
        let said = badly_excited(&parameters).unwrap();
        assert!(said.ends_with(": ZZ_5, F_v1_5"), "{said}");
        assert_eq!(badly_excited(&parameters[..2]), None);
    }

    #[test]
    fn the_condition_number_has_a_limit() {
        assert_eq!(hardly_excited(99.0), None);
        assert!(hardly_excited(250.4).unwrap().contains("250, above 100"));
        let silent = CalibratedParameter { excited: false, ..parameter("m_5", "kg", 0.0, 0.0) };
        let said =
            |inseparable: &[(&str, String)]| warnings(std::slice::from_ref(&silent), inseparable, 10.0);
        assert!(said(&[]).len() == 1 && said(&[])[0].contains("not valid for motions"));
        let said = said(&[("m_5", "m_4 + m_5".to_owned())]);
        assert!(said.len() == 1 && said[0].contains("m_5 (determined: m_4 + m_5); no motion"), "{said:?}");
    }
}
