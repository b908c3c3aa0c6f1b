//! The column names that recorders and robots are known to use; `docs/formats.md` tells whose they are.

use std::collections::BTreeMap;

use aurt_traits::MeasurementUnit;

use crate::recorded_as::TimeUnit;

/// Names of a time column in s, the preferred first.
pub(super) const TIME: [&str; 8] =
    ["timestamp", "time", "t", "timestamp_s", "time_s", "t_s", "__time", "elapsed_time"];

/// Names of a time column that is in another unit.
pub(super) const TIME_IN: [(&str, TimeUnit); 11] = [
    ("timestamp_ms", TimeUnit::Millisecond),
    ("time_ms", TimeUnit::Millisecond),
    ("t_ms", TimeUnit::Millisecond),
    ("ipoc", TimeUnit::Millisecond),
    ("timestamp_us", TimeUnit::Microsecond),
    ("time_us", TimeUnit::Microsecond),
    ("t_us", TimeUnit::Microsecond),
    ("timestamp_ns", TimeUnit::Nanosecond),
    ("time_ns", TimeUnit::Nanosecond),
    ("t_ns", TimeUnit::Nanosecond),
    ("%time", TimeUnit::Nanosecond),
];

/// Names of two columns that hold the seconds of a stamp and its nanoseconds.
pub(super) const TIME_PAIRS: [[&str; 2]; 5] = [
    ["header_stamp_sec", "header_stamp_nanosec"],
    ["header_stamp_secs", "header_stamp_nsecs"],
    ["sec", "nanosec"],
    ["secs", "nsecs"],
    ["zeitinsec", "zeitinnanosec"],
];

/// Whether an array of that name holds time stamps.
pub fn is_time_name(name: &str) -> bool {
    let prefix = NameParts::of(name).prefix;
    TIME.contains(&prefix.as_str()) || TIME_IN.iter().any(|(known, _)| *known == prefix)
}

/// The position of [libfranka's log](https://github.com/frankaemika/libfranka), whose `time` is in ms.
pub(super) const LIBFRANKA: &str = "state_q";

/// Positions, and velocities with them, that are documented to be in degrees.
pub(super) const DEGREES: [&str; 5] =
    ["actuators_position", "actuators_velocity", "aipos_a", "angles", "realtime_joint_speeds"];

pub(super) const COUNTS: [&str; 1] = ["present_position"];

/// Motor currents in units of the drive, which no name tells.
pub(super) const DRIVE_UNITS: [&str; 2] = ["present_current", "macur_a"];

/// Prefixes of joint positions, the preferred first as in the lists that follow.
pub(super) const POSITION: [&str; 15] = [
    "actual_q",
    "q",
    "position",
    "pos",
    "joint_position",
    "joint_positions",
    "joint_pos",
    LIBFRANKA,
    "actuators_position",
    "aipos_a",
    "axisqmsr",
    "observation_state",
    "observation_position",
    "angles",
    "present_position",
];

pub(super) const VELOCITY: [&str; 13] = [
    "actual_qd",
    "qd",
    "dq",
    "velocity",
    "vel",
    "joint_velocity",
    "qdot",
    "joint_velocities",
    "joint_vel",
    "state_dq",
    "actuators_velocity",
    "observation_velocity",
    "realtime_joint_speeds",
];

pub(super) const CURRENT: [&str; 11] = [
    "actual_current",
    "current",
    "motor_current",
    "joint_current",
    "joint_currents",
    "current_motor",
    "actuators_current_motor",
    "macur_a",
    "observation_current",
    "currents",
    "present_current",
];

pub(super) const TORQUE: [&str; 16] = [
    "actual_torque",
    "torque",
    "tau",
    "effort",
    "joint_torque",
    "joint_torques",
    "joint_effort",
    "actual_current_as_torque",
    "tau_j",
    "state_tau_j",
    "actuators_torque",
    "geartorque_a",
    "axistaumsr",
    "observation_effort",
    "observation_torque",
    "joints_torque",
];

/// Prefixes of what was commanded; never taken for what was measured.
pub(super) const COMMANDED: [&str; 16] = [
    "target_q",
    "desired_q",
    "q_d",
    "target_qd",
    "target_current",
    "desired_current",
    "target_moment",
    "target_torque",
    "state_q_d",
    "cmd_q_d",
    "cmd_tau_j_d",
    "tau_j_d",
    "aspos_a",
    "axisqcmd",
    "action",
    "goal_position",
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
        let group = self.groups.get(&stem(&prefix.trim().to_lowercase()))?;
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

pub(super) const TIME_UNITS: [&str; 3] = ["s", "sec", "seconds"];
pub(super) const POSITION_UNITS: [&str; 2] = ["rad", "radians"];
pub(super) const VELOCITY_UNITS: [&str; 4] = ["rad/s", "rad/sec", "rad s^-1", "rad*s^-1"];
/// Units of the positions, velocities and measurements of joints that slide.
pub(super) const SLIDING_UNITS: [&str; 6] = ["m", "m/s", "n", "a", "amp", "ampere"];
pub(super) const TORQUE_UNITS: [&str; 5] = ["nm", "n m", "n*m", "n·m", "n.m"];
pub(super) const CURRENT_UNITS: [&str; 3] = ["a", "amp", "ampere"];

/// A column name taken apart, in lower case.
pub(super) struct NameParts {
    /// The name without topic, joint number and unit; dots and spaces in it are underscores.
    pub(super) prefix: String,
    /// The joint number: `q_3`, `q[3]`, `q_[3]`, `q(3)`, `q3` and `joint_3.q` all have 3.
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
            _ => match numbered_within(&name) {
                Some((prefix, number)) => Self { prefix, number: Some(number), unit },
                None => Self { prefix: stem(&name), number: None, unit },
            },
        }
    }
}

/// The quantity and the joint of a name such as `joint_3.position` or `actuators[3].torque`.
fn numbered_within(name: &str) -> Option<(String, usize)> {
    // Kortex has degrees where others have radians: its name stays.
    const WORDS: [(&str, &str); 6] = [
        ("actuators", "actuators_"),
        ("actuator", "actuators_"),
        ("joint", ""),
        ("axis", ""),
        ("motor", ""),
        ("j", ""),
    ];
    let name = name.rsplit('/').next()?;
    let (kept, rest) = WORDS.iter().find_map(|(word, kept)| Some((kept, name.strip_prefix(word)?)))?;
    let rest = rest.trim_start_matches(['_', '[', '(', ' ', '.']);
    let quantity = rest.trim_start_matches(|c: char| c.is_ascii_digit());
    let number = rest[..rest.len() - quantity.len()].parse().ok()?;
    let quantity = stem(quantity.trim_start_matches([']', ')']).trim_start_matches(['_', '.', ' ']));
    (!quantity.is_empty()).then(|| (format!("{kept}{quantity}"), number))
}

/// A name in lower case, without a unit in brackets at its end.
pub(super) fn without_unit(name: &str) -> String {
    let name = name.trim().to_lowercase();
    bracketed(&name).map_or(name.as_str(), |(before, _)| before).trim_end().to_owned()
}

/// What stands before and in a pair of brackets that ends the name.
fn bracketed(name: &str) -> Option<(&str, &str)> {
    [('[', ']'), ('(', ')')]
        .into_iter()
        .find_map(|(open, close)| name.strip_suffix(close).and_then(|inner| inner.rsplit_once(open)))
}

/// A name as it is compared: without topic and separators at the end, and without the robot that KUKA's recorder adds.
fn stem(name: &str) -> String {
    let name = name.rsplit('/').next().unwrap_or(name);
    let name = name.trim_end().trim_end_matches(['_', '.', '-']).replace([' ', '.'], "_");
    let recorder = ["axisqmsr", "axistaumsr", "axisqcmd"];
    recorder.iter().find(|known| name.starts_with(&format!("{known}_"))).map_or(name, |k| (*k).to_owned())
}
