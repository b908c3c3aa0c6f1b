//! The column names that recorders and robots are known to use.

use std::collections::BTreeMap;

use aurt_traits::MeasurementUnit;

/// Names of a time column, the preferred first.
pub(crate) const TIME: [&str; 6] = ["timestamp", "time", "t", "timestamp_s", "time_s", "t_s"];

/// Prefixes of joint positions, the preferred first.
pub(super) const POSITION: [&str; 5] = ["actual_q", "q", "position", "pos", "joint_position"];

/// Prefixes of joint velocities, the preferred first.
pub(super) const VELOCITY: [&str; 7] = ["actual_qd", "qd", "dq", "velocity", "vel", "joint_velocity", "qdot"];

/// Prefixes of motor currents, the preferred first.
pub(super) const CURRENT: [&str; 4] = ["actual_current", "current", "motor_current", "joint_current"];

/// Prefixes of joint torques, the preferred first.
pub(super) const TORQUE: [&str; 5] = ["actual_torque", "torque", "tau", "effort", "joint_torque"];

/// Prefixes of what was commanded; never taken for what was measured.
pub(super) const COMMANDED: [&str; 8] = [
    "target_q",
    "desired_q",
    "q_d",
    "target_qd",
    "target_current",
    "desired_current",
    "target_moment",
    "target_torque",
];

/// The columns of a header, grouped by their names without joint number.
pub(super) struct Families {
    /// Per prefix (lower case) the columns with their number; `None` for a name without number.
    groups: BTreeMap<String, Vec<(Option<usize>, usize)>>,
}

impl Families {
    pub(super) fn of(names: &[String]) -> Self {
        let mut groups: BTreeMap<String, Vec<(Option<usize>, usize)>> = BTreeMap::new();
        for (column, name) in names.iter().enumerate() {
            let parts = NameParts::of(name);
            groups.entry(parts.prefix).or_default().push((parts.number, column));
        }
        Self { groups }
    }

    /// The prefixes among `prefixes` that the header has, in that order.
    pub(super) fn present<'p>(&self, prefixes: &[&'p str]) -> Vec<&'p str> {
        prefixes.iter().filter(|p| self.groups.contains_key(**p)).copied().collect()
    }

    /// Columns of `joints` joints under a name that is none of those known here, in the order of their joints.
    pub(super) fn unknown(&self, joints: usize) -> Option<Vec<usize>> {
        let known = |prefix: &str| {
            [&POSITION[..], &VELOCITY, &CURRENT, &TORQUE, &COMMANDED]
                .iter()
                .any(|list| list.contains(&prefix))
        };
        let unknown = self.groups.keys().filter(|prefix| joints > 1 && !known(prefix));
        unknown.filter_map(|prefix| self.columns(prefix)?.ok()).find(|columns| columns.len() == joints)
    }

    /// The columns of that name that have no joint number.
    pub(super) fn unnumbered(&self, name: &str) -> Vec<usize> {
        let group = self.groups.get(name).into_iter().flatten();
        group.filter(|(number, _)| number.is_none()).map(|(_, column)| *column).collect()
    }

    /// The columns of a prefix in the order of their joints, or what is wrong with their numbering.
    /// Numbers start at 0 or at 1 and have no holes; a name without number is a single joint's.
    pub(super) fn columns(&self, prefix: &str) -> Option<Result<Vec<usize>, String>> {
        let group = self.groups.get(&prefix.trim().to_lowercase())?;
        let mut numbered: Vec<(usize, usize)> =
            group.iter().filter_map(|(n, c)| n.map(|n| (n, *c))).collect();
        if numbered.is_empty() {
            return Some(match group.as_slice() {
                [(_, column)] => Ok(vec![*column]),
                _ => Err(format!("there are {} columns named `{prefix}`", group.len())),
            });
        }
        numbered.sort_unstable();
        let first = numbered[0].0;
        if first > 1 {
            return Some(Err(format!(
                "the columns `{prefix}` are numbered from {first} on, not from 0 or 1"
            )));
        }
        for (expected, (number, _)) in (first..).zip(&numbered) {
            if *number != expected {
                return Some(Err(if *number < expected {
                    format!("there are two columns `{prefix}` with number {number}")
                } else {
                    format!("among the columns `{prefix}` number {expected} is missing")
                }));
            }
        }
        Some(Ok(numbered.into_iter().map(|(_, column)| column).collect()))
    }
}

/// The unit of a measurement column: the one written after its name, or the one that its name implies.
pub(super) fn unit_of(name: &str) -> Option<MeasurementUnit> {
    let parts = NameParts::of(name);
    match parts.unit.as_deref() {
        Some(unit) if TORQUE_UNITS.contains(&unit) => return Some(MeasurementUnit::NewtonMetre),
        Some(unit) if CURRENT_UNITS.contains(&unit) => return Some(MeasurementUnit::Ampere),
        _ => {}
    }
    if CURRENT.contains(&parts.prefix.as_str()) {
        return Some(MeasurementUnit::Ampere);
    }
    TORQUE.contains(&parts.prefix.as_str()).then_some(MeasurementUnit::NewtonMetre)
}

/// Ways to write the unit of time.
pub(super) const TIME_UNITS: [&str; 3] = ["s", "sec", "seconds"];
/// Ways to write the unit of position.
pub(super) const POSITION_UNITS: [&str; 2] = ["rad", "radians"];
/// Ways to write the unit of velocity.
pub(super) const VELOCITY_UNITS: [&str; 4] = ["rad/s", "rad/sec", "rad s^-1", "rad*s^-1"];
/// Ways to write the unit of torque.
pub(super) const TORQUE_UNITS: [&str; 5] = ["nm", "n m", "n*m", "n·m", "n.m"];
/// Ways to write the unit of current.
pub(super) const CURRENT_UNITS: [&str; 3] = ["a", "amp", "ampere"];

/// A column name taken apart, in lower case.
pub(super) struct NameParts {
    /// The name without joint number and unit.
    pub(super) prefix: String,
    /// The joint number: `q_3`, `q[3]`, `q_[3]`, `q(3)` and `q3` all have 3.
    pub(super) number: Option<usize>,
    /// What stands in brackets at the end and is no number, as in `q_3 [rad]`.
    pub(super) unit: Option<String>,
}

impl NameParts {
    pub(super) fn of(name: &str) -> Self {
        let mut name = name.trim().to_lowercase();
        let mut unit = None;
        if let Some((before, inside)) = bracketed(&name) {
            if let Ok(number) = inside.trim().parse() {
                return Self { prefix: stem(before), number: Some(number), unit: None };
            }
            unit = Some(inside.trim().to_owned()).filter(|u| !u.is_empty());
            name = before.trim_end().to_owned();
        }
        if let Some((before, Ok(number))) = bracketed(&name).map(|(b, i)| (b, i.trim().parse())) {
            return Self { prefix: stem(before), number: Some(number), unit };
        }
        let without = name.trim_end_matches(|c: char| c.is_ascii_digit());
        match name[without.len()..].parse() {
            Ok(number) if !without.is_empty() => Self { prefix: stem(without), number: Some(number), unit },
            _ => Self { prefix: name, number: None, unit },
        }
    }
}

/// What stands before and in a pair of brackets that ends the name.
fn bracketed(name: &str) -> Option<(&str, &str)> {
    [('[', ']'), ('(', ')')]
        .into_iter()
        .find_map(|(open, close)| name.strip_suffix(close).and_then(|inner| inner.rsplit_once(open)))
}

fn stem(name: &str) -> String {
    name.trim_end().trim_end_matches(['_', '.', '-']).to_owned()
}
