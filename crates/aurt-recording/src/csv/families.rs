//! The column names that recorders and robots are known to use.

use std::collections::BTreeMap;

use aurt_traits::MeasurementUnit;

/// Names of a time column, the preferred first.
pub(super) const TIME: [&str; 6] = ["timestamp", "time", "t", "timestamp_s", "time_s", "t_s"];

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
            let (prefix, number) = split_number(name);
            groups.entry(prefix).or_default().push((number, column));
        }
        Self { groups }
    }

    /// The prefixes among `prefixes` that the header has, in that order.
    pub(super) fn present<'p>(&self, prefixes: &[&'p str]) -> Vec<&'p str> {
        prefixes.iter().filter(|p| self.groups.contains_key(**p)).copied().collect()
    }

    /// The columns of a prefix in the order of their joints, or what is wrong with their numbering.
    /// Numbers start at 0 or at 1 and have no holes; a name without number is a single joint's.
    pub(super) fn columns(&self, prefix: &str) -> Option<Result<Vec<usize>, String>> {
        let group = self.groups.get(&prefix.to_lowercase())?;
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

/// The unit that a measurement of this prefix has.
pub(super) fn unit_of(prefix: &str) -> Option<MeasurementUnit> {
    if CURRENT.contains(&prefix) {
        return Some(MeasurementUnit::Ampere);
    }
    TORQUE.contains(&prefix).then_some(MeasurementUnit::NewtonMetre)
}

/// A column name in lower case without its joint number, and the number: `q_3`, `q[3]`, `q_[3]`, `q(3)` and `q3`
/// are all ("q", 3). A unit in brackets after the name is left out.
pub(super) fn split_number(name: &str) -> (String, Option<usize>) {
    let mut name = name.trim().to_lowercase();
    for (open, close) in [('[', ']'), ('(', ')')] {
        let Some(inner) = name.strip_suffix(close) else { continue };
        let Some((before, inside)) = inner.rsplit_once(open) else { continue };
        let before = before.trim_end().trim_end_matches('_').to_owned();
        if let Ok(number) = inside.trim().parse() {
            return (before, Some(number));
        }
        name = before;
        break;
    }
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let number = name[stem.len()..].parse().ok();
    if number.is_none() || stem.is_empty() {
        return (name, None);
    }
    (stem.trim_end_matches('_').to_owned(), number)
}
