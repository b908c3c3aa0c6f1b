//! Which numbers of an arm are estimated.

use aurt_traits::UNLIMITED;

use crate::drives::{DriveError, DrivenArm};

/// What is estimated, and what is known beforehand.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Selection {
    /// Keys of numbers: `delay_s` stands for that of every joint, `delay_s_2` for that of joint 2.
    pub estimate: Vec<String>,
    /// Keys of those among them that have one value for all joints.
    pub shared: Vec<String>,
    /// Standard deviations of what is known beforehand, by key, instead of the numbers' own; of numbers that are given, and not
    /// estimated, those of what is given.
    pub deviations: Vec<(String, f64)>,
}

/// Standard deviation of the masses, first moments and inertias of a description, as a share, unless one is stated: drawings
/// know neither cables nor screws, and a millimetre is 2 % of the distance of the centre of mass of a link of 10 cm.
const MASS_SCALE: f64 = 0.02;

/// A number that is estimated, of one joint or of several that share it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Column {
    pub name: String,
    pub unit: String,
    /// Places in [`DrivenArm::numbers`].
    pub places: Vec<usize>,
    pub start: f64,
    pub deviation: f64,
    pub bounds: [f64; 2],
}

/// A name of [`DrivenArm::names`] without its joint.
pub fn stem(name: &str) -> &str {
    name.rsplit_once('_').filter(|(_, end)| end.parse::<usize>().is_ok()).map_or(name, |s| s.0)
}

pub(crate) fn columns(arm: &DrivenArm, selection: &Selection) -> Result<Vec<Column>, DriveError> {
    let names = arm.names();
    let numbers = arm.numbers();
    let mut columns: Vec<Column> = Vec::new();
    for key in &selection.estimate {
        let places: Vec<usize> =
            (0..names.len()).filter(|k| names[*k] == *key || stem(&names[*k]) == *key).collect();
        if places.is_empty() {
            let mut known: Vec<&str> = names.iter().map(|n| stem(n)).collect();
            known.sort();
            known.dedup();
            return Err(DriveError::Unknown { name: key.clone(), known: known.join(", ") });
        }
        let shared = selection.shared.contains(key);
        let groups: Vec<Vec<usize>> =
            if shared { vec![places] } else { places.into_iter().map(|p| vec![p]).collect() };
        for places in groups {
            let number = &numbers[places[0]];
            let name = if shared { key.clone() } else { names[places[0]].clone() };
            if number.value.abs() >= UNLIMITED {
                return Err(DriveError::NoStart { name });
            }
            let stated = selection.deviations.iter().find(|(k, _)| *k == name || *k == stem(&name));
            let column = Column {
                unit: number.parameter.unit.clone(),
                start: number.value,
                deviation: stated.map_or(number.deviation, |(_, d)| *d),
                bounds: number.bounds,
                name,
                places,
            };
            if !columns.iter().any(|c| c.places == column.places) {
                columns.push(column);
            }
        }
    }
    Ok(columns)
}

/// The numbers that are given with a deviation, and not estimated: those of [`Selection::deviations`], the masses of a
/// description, and v_S where the excess of break-away is estimated. A limit that is none has no deviation.
pub(crate) fn given(arm: &DrivenArm, selection: &Selection) -> Result<Vec<Column>, DriveError> {
    let is_of = |key: &str, name: &str| key == name || key == stem(name);
    let is_estimated = |name: &str| selection.estimate.iter().any(|key| is_of(key, name));
    let mut deviations = selection.deviations.clone();
    if arm.standard_parameters.iter().any(|p| *p != 0.0) {
        // The first that fits a name counts, which is one that is stated.
        deviations.push(("mass_scale".to_owned(), MASS_SCALE));
    }
    let is_uncertain = |name: &str| {
        let joint = name.strip_prefix("stribeck_velocity_rad_s");
        let of_excess = || joint.is_some_and(|joint| is_estimated(&format!("static_nm{joint}")));
        deviations.iter().any(|(key, _)| is_of(key, name)) || of_excess()
    };
    let numbers = arm.names().into_iter().zip(arm.numbers());
    let given = numbers
        .filter(|(name, number)| number.value.abs() < UNLIMITED && is_uncertain(name) && !is_estimated(name));
    let estimate = given.map(|(name, _)| name).collect();
    columns(arm, &Selection { estimate, shared: Vec::new(), deviations })
}
