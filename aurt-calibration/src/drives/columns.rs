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

/// What masses, first moments and inertias of a description are good for, as a share, unless it is stated: drawings know
/// neither cables nor screws, and a centre of mass that is a millimetre off is 2 % of a link of 10 cm.
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
#[must_use]
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

/// The numbers that are given, and not estimated, but no better known than some deviation: those of
/// [`Selection::deviations`], the masses of a description, and v_S where the excess of break-away is estimated.
pub(crate) fn given(arm: &DrivenArm, selection: &Selection) -> Result<Vec<Column>, DriveError> {
    let names = arm.names();
    let is_estimated = |name: &str| selection.estimate.iter().any(|key| key == name || key == stem(name));
    let known = |key: &str| names.iter().any(|n| n == key || stem(n) == key);
    let mut deviations: Vec<(String, f64)> =
        selection.deviations.iter().filter(|(key, _)| known(key)).cloned().collect();
    if arm.standard_parameters.iter().any(|p| *p != 0.0)
        && deviations.iter().all(|d| stem(&d.0) != "mass_scale")
    {
        deviations.push(("mass_scale".to_owned(), MASS_SCALE));
    }
    let mut keys: Vec<String> = deviations.iter().map(|d| d.0.clone()).collect();
    if is_estimated("static_nm") {
        keys.push("stribeck_velocity_rad_s".to_owned());
    }
    let of_key =
        |key: &String| names.iter().filter(|n| *n == key || stem(n) == key).cloned().collect::<Vec<_>>();
    let estimate = keys.iter().flat_map(of_key).filter(|name| !is_estimated(name)).collect();
    columns(arm, &Selection { estimate, shared: Vec::new(), deviations })
}
