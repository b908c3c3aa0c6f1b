//! The structures that drives and joints can have.

use aurt_calibration::drives::{DriveRecording, DrivenArm, Selection, stem};
use aurt_traits::UNLIMITED;

/// A structure of a drive, a joint or its surroundings: what a model with it has that one without it lacks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Structure {
    /// Its name; that of the effect of `aurt explain` where there is one.
    pub id: &'static str,
    /// What it is.
    pub title: &'static str,
    /// What to record to be sure.
    pub decider: &'static str,
    /// Its numbers; the first is that to which it is added.
    keys: &'static [&'static str],
    absent: Absent,
    scope: Scope,
}

/// The value of numbers that do nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Absent {
    Zero,
    Unlimited,
    One,
    Least,
    /// It is a part of the arm.
    Part,
    /// No drive is without it: what is given of it may be wrong.
    Never,
}

/// How many values there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Scope {
    Joint,
    /// The firmware's: one value for all joints where it is added.
    Firmware,
    LastLink,
}

const fn of(
    id: &'static str,
    title: &'static str,
    keys: &'static [&'static str],
    decider: &'static str,
) -> Structure {
    Structure { id, title, decider, keys, absent: Absent::Zero, scope: Scope::Joint }
}

/// All of them.
pub const STRUCTURES: [Structure; 17] = [
    Structure {
        scope: Scope::Firmware,
        ..of("time_delay", "a delay of the command", &["delay_s"], "steps and fast sines of the command")
    },
    of(
        "dead_band",
        "a dead band of the firmware",
        &["dead_band_rad"],
        "slow motion of a joint without load, in both directions",
    ),
    Structure {
        scope: Scope::Firmware,
        absent: Absent::Unlimited,
        ..of(
            "speed_limit",
            "a speed limit of the firmware",
            &["speed_limit_rad_s"],
            "large steps of the command",
        )
    },
    Structure {
        scope: Scope::Firmware,
        absent: Absent::Unlimited,
        ..of(
            "acceleration_limit",
            "an acceleration limit of the firmware",
            &["acceleration_limit_rad_s2"],
            "steps of the command of several sizes",
        )
    },
    Structure {
        absent: Absent::Unlimited,
        ..of(
            "saturation",
            "a limit of the torque",
            &["torque_limit_nm"],
            "large steps under the greatest load",
        )
    },
    of(
        "integral",
        "an integral part of the firmware",
        &["integral_nm_per_rad_s"],
        "poses held for seconds under load",
    ),
    of(
        "command_offset",
        "a zero of the firmware that is not the joint's",
        &["command_offset_rad"],
        "poses from both sides",
    ),
    of(
        "coulomb",
        "dry friction",
        &["coulomb_nm", "coulomb_per_load", "static_nm"],
        "slow motion in both directions",
    ),
    of(
        "load_dependent_friction",
        "dry friction in proportion to the load",
        &["coulomb_per_load"],
        "slow motion with the arm stretched and folded",
    ),
    of("stribeck", "an excess of break-away over sliding", &["static_nm"], "slow ramps from rest"),
    of(
        "viscous",
        "viscous friction or back-EMF",
        &["viscous_nm_s_per_rad", "back_emf_nm_s_per_rad", "damping_nm_s_per_rad"],
        "constant speeds, slow and fast",
    ),
    of(
        "viscous_asymmetry",
        "viscous friction that differs between directions",
        &["viscous_asymmetry_nm_s_per_rad"],
        "the same speeds in both directions",
    ),
    of(
        "coulomb_asymmetry",
        "dry friction that differs between directions, or a constant torque",
        &["torque_offset_nm"],
        "slow motion in both directions through the same poses",
    ),
    Structure {
        absent: Absent::Least,
        ..of("rotor_inertia", "the inertia of rotor and gear", &["rotor_inertia_kg_m2"], "fast reversals")
    },
    Structure {
        absent: Absent::One,
        scope: Scope::LastLink,
        ..of("payload", "a load on the last link", &["mass_scale"], "the same motion with a known weight")
    },
    Structure {
        absent: Absent::Never,
        ..of(
            "torque_constant",
            "a gain of the firmware, supply or torque constant",
            &["gain_nm_per_rad", "torque_constant_nm_per_a", "torque_nm_per_v"],
            "the same motion with a known weight",
        )
    },
    Structure {
        absent: Absent::Part,
        ..of(
            "floor",
            "a floor under the last link",
            &["floor_height_m", "floor_stiffness_n_per_m", "floor_friction"],
            "the same motion higher above the floor",
        )
    },
];

/// What directions of numbers that recordings leave open need: each number's structure says what to record.
pub fn deciders(names: &[String]) -> Vec<&'static str> {
    let mut found: Vec<&str> = Vec::new();
    for name in names {
        let own = match stem(name) {
            "gain_nm_per_rad" | "torque_constant_nm_per_a" | "torque_nm_per_v" => {
                Some("a known weight at the joint")
            }
            key => STRUCTURES.iter().rev().find(|s| s.keys.contains(&key)).map(|s| s.decider),
        };
        found.extend(own.filter(|own| !found.contains(own)));
    }
    found
}

impl Structure {
    /// The places of its numbers in [`DrivenArm::numbers`].
    fn places(&self, arm: &DrivenArm, keys: &[&str]) -> Vec<usize> {
        let last = (self.scope == Scope::LastLink).then(|| format!("_{}", arm.joints.len() - 1));
        let names = arm.names();
        let own =
            |name: &String| keys.contains(&stem(name)) && last.as_ref().is_none_or(|l| name.ends_with(l));
        (0..names.len()).filter(|k| own(&names[*k])).collect()
    }

    /// Whether an arm can have it.
    pub fn fits(&self, arm: &DrivenArm) -> bool {
        let needs_masses = matches!(self.absent, Absent::Least | Absent::One);
        let has_masses = arm.standard_parameters.iter().any(|p| *p != 0.0);
        (has_masses || !needs_masses) && !self.places(arm, self.keys).is_empty()
    }

    /// Whether an arm has it.
    pub fn is_in(&self, arm: &DrivenArm) -> bool {
        let numbers = arm.numbers();
        self.places(arm, self.keys)
            .into_iter()
            .any(|p| self.nothing(numbers[p].bounds).is_none_or(|n| numbers[p].value != n))
    }

    fn nothing(&self, bounds: [f64; 2]) -> Option<f64> {
        match self.absent {
            Absent::Zero => Some(0.0),
            Absent::Unlimited => Some(UNLIMITED),
            Absent::One => Some(1.0),
            Absent::Least => Some(bounds[0]),
            Absent::Part | Absent::Never => None,
        }
    }

    /// Whether an arm can be without it.
    pub(super) fn is_optional(&self) -> bool {
        self.absent != Absent::Never
    }

    /// Takes it out of an arm; numbers that no arm is without keep their values.
    pub(super) fn remove(&self, arm: &mut DrivenArm) {
        if self.absent == Absent::Part {
            arm.floor = None;
            return;
        }
        let numbers = arm.numbers();
        let mut values: Vec<f64> = numbers.iter().map(|n| n.value).collect();
        for place in self.places(arm, self.keys) {
            values[place] = self.nothing(numbers[place].bounds).unwrap_or(values[place]);
        }
        arm.set_numbers(&values);
    }

    /// Whether one of its numbers is estimated.
    pub(super) fn is_selected(&self, selection: &Selection) -> bool {
        selection.estimate.iter().any(|key| self.has(key))
    }

    /// Takes its numbers out of what is estimated.
    pub(super) fn unselect(&self, selection: &Selection) -> Selection {
        let mut left = selection.clone();
        left.estimate.retain(|key| !self.keys.contains(&stem(key)));
        left
    }

    /// Puts it into an arm at values at which it acts.
    pub(super) fn add(&self, arm: &mut DrivenArm, recordings: &[DriveRecording]) {
        let (numbers, names) = (arm.numbers(), arm.names());
        let mut values: Vec<f64> = numbers.iter().map(|n| n.value).collect();
        let gain = |joint: &str| names.iter().position(|n| *n == format!("gain_nm_per_rad{joint}"));
        for place in self.places(arm, &self.keys[..1]) {
            let joint = &names[place][stem(&names[place]).len()..];
            let start = match self.id {
                "speed_limit" => fastest(recordings)[0],
                "acceleration_limit" => fastest(recordings)[1],
                // Below the greatest torque that the law of control has asked for.
                "saturation" => {
                    let most = joint[1..].parse().map_or(0.0, |j: usize| largest_error(recordings, j));
                    gain(joint).map_or(values[place], |g| 0.7 * most * values[g])
                }
                _ => self.nothing(numbers[place].bounds).unwrap_or_default() + 0.3 * numbers[place].deviation,
            };
            values[place] = start.clamp(numbers[place].bounds[0], numbers[place].bounds[1]);
        }
        arm.set_numbers(&values);
    }

    /// Adds the first of its numbers that the arm has to what is estimated.
    pub(super) fn select(&self, arm: &DrivenArm, selection: &Selection) -> Selection {
        let mut more = selection.clone();
        let own = self.keys.iter().find(|key| !self.places(arm, &[key]).is_empty());
        let key = (*own.unwrap_or(&self.keys[0])).to_owned();
        match self.scope {
            Scope::LastLink => more.estimate.push(format!("{key}_{}", arm.joints.len() - 1)),
            Scope::Firmware => {
                more.estimate.push(key.clone());
                more.shared.push(key);
            }
            Scope::Joint => more.estimate.push(key),
        }
        more
    }

    /// Whether a name is that of one of its numbers.
    pub fn has(&self, name: &str) -> bool {
        self.keys.contains(&stem(name))
    }

    /// The value at which a number of it does nothing; none of the floor, which is there or not.
    pub fn neutral(&self) -> Option<f64> {
        self.nothing([0.0; 2])
    }
}

/// The greatest speed and acceleration over a tenth of a second, of the fastest joint: a limit that all share acts on it
/// first, and often on it alone. Two windows of each joint may be outliers.
fn fastest(recordings: &[DriveRecording]) -> [f64; 2] {
    const OVER_S: f64 = 0.1;
    let joints = recordings.first().map_or(0, |r| r.position_rad.len());
    let mut own = vec![[Vec::new(), Vec::new()]; joints];
    for recording in recordings {
        let span_s = recording.time_s[recording.time_s.len() - 1] - recording.time_s[0];
        let w = (OVER_S * recording.time_s.len() as f64 / span_s).ceil().max(1.0) as usize;
        let over_s = w as f64 * span_s / (recording.time_s.len() - 1) as f64;
        for (q, [speeds, accelerations]) in recording.position_rad.iter().zip(&mut own) {
            let at = |k: usize| q[(k + w).min(q.len() - 1)] - q[k];
            speeds.extend((0..q.len()).map(|k| at(k).abs() / over_s));
            let change = |k: usize| (at((k + w).min(q.len() - 1)) - at(k)).abs();
            accelerations.extend((0..q.len().saturating_sub(w)).map(|k| change(k) / over_s.powi(2)));
        }
    }
    let third = |mut values: Vec<f64>| {
        values.sort_by(|a, b| b.total_cmp(a));
        values.get(2).copied().unwrap_or_default()
    };
    own.into_iter()
        .map(|series| series.map(third))
        .fold([0.0; 2], |m, s| [f64::max(m[0], s[0]), f64::max(m[1], s[1])])
}

/// The greatest difference of command and position of a joint.
fn largest_error(recordings: &[DriveRecording], joint: usize) -> f64 {
    let of = |r: &DriveRecording| -> Vec<f64> {
        r.command[joint].iter().zip(&r.position_rad[joint]).map(|(c, q)| (c - q).abs()).collect()
    };
    quantile(recordings.iter().flat_map(of).collect(), 0.995)
}

fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get((share * values.len() as f64) as usize).copied().unwrap_or_default()
}
