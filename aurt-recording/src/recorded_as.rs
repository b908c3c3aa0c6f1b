use std::f64::consts::{PI, TAU};
use std::path::PathBuf;

use aurt_traits::MeasurementUnit;

use crate::error::RecordingError;

/// The unit of positions and, per second, of velocities.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleUnit {
    /// rad.
    Radian,
    /// Degrees.
    Degree,
}

impl AngleUnit {
    /// Both, as experiments write them.
    pub const NAMES: [(&str, Self); 2] = [("rad", Self::Radian), ("deg", Self::Degree)];
}

/// The unit of time stamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeUnit {
    /// s.
    Second,
    /// ms.
    Millisecond,
    /// µs.
    Microsecond,
    /// ns.
    Nanosecond,
}

impl TimeUnit {
    /// All of them as experiments write them, the longest first.
    pub const NAMES: [(&str, Self); 4] =
        [("s", Self::Second), ("ms", Self::Millisecond), ("us", Self::Microsecond), ("ns", Self::Nanosecond)];

    /// How experiments write it.
    pub const fn key(self) -> &'static str {
        Self::NAMES[self as usize].0
    }

    /// Its length in s.
    pub const fn seconds(self) -> f64 {
        1.0 / self.per_second()
    }

    const fn per_second(self) -> f64 {
        [1.0, 1e3, 1e6, 1e9][self as usize]
    }

    /// How it is written.
    pub const fn symbol(self) -> &'static str {
        if matches!(self, Self::Microsecond) { "µs" } else { self.key() }
    }
}

/// The unit of motor currents.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CurrentUnit {
    /// A.
    Ampere,
    /// mA.
    Milliampere,
}

/// What a recording consists of beside its stamps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Joint positions.
    Position,
    /// Joint velocities.
    Velocity,
    /// Joint torques or motor currents.
    Measurement,
}

/// Rows that are left out on request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DroppedRows {
    /// Those that lack a number that is needed: an empty cell, NaN, an infinite number.
    NotANumber,
}

/// What a file does not tell of itself: units, sampling rate, encoders, gears, and what to read of a bag.
/// Whatever is `None` is as usual: rad, s, A, joint side.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RecordedAs {
    /// Unit of the positions of joints that turn; velocities are in this unit per second. Joints that slide are in m.
    pub angle: Option<AngleUnit>,
    /// Unit of the time stamps.
    pub time: Option<TimeUnit>,
    /// Unit of motor currents.
    pub current: Option<CurrentUnit>,
    /// Rows per second, in Hz; the clock of files without time stamps. Stamps that there are, are not read.
    pub rate_hz: Option<f64>,
    /// Counts that positions advance by in a turn, for all joints (one number) or for each. Velocities are in counts/s.
    pub counts_per_revolution: Option<Vec<f64>>,
    /// Turns of the motor per turn of the joint, for all joints (one number) or for each, where positions and velocities
    /// are the motor's. A negative ratio turns the sign. Measurements stay as they are.
    pub gear_ratio: Option<Vec<f64>>,
    /// The topic of a bag that is read.
    pub topic: Option<String>,
    /// The robot's joints by name, in the robot's order; for formats that name joints.
    pub joint_names: Option<Vec<String>>,
    /// Rows that are left out; `None`: a row that lacks a number is an error.
    pub drop: Option<DroppedRows>,
    /// What is taken of the file; `None`: all that it has.
    pub take: Option<Vec<Quantity>>,
    /// Files that hold other quantities of the same motion.
    pub joined: Vec<JoinedFile>,
}

/// A file with other quantities of the motion whose positions another file has.
#[derive(Debug, Clone, PartialEq)]
pub struct JoinedFile {
    /// The file.
    pub file: PathBuf,
    /// Unit of the measurement; `None`: that of the recording, else from the column names.
    pub unit: Option<MeasurementUnit>,
    /// Columns that are not to be found by their names.
    pub columns: ColumnSelection,
    /// What the file does not tell of itself.
    pub recorded: RecordedAs,
    /// What is added to its stamps, in s, so that they are of the first file's clock.
    pub clock_offset_s: f64,
}

/// What a number is multiplied with and then divided by. Both steps are exact where the unit allows it, so that
/// 2 ms become the number that is written 0.002.
pub(crate) type Factor = [f64; 2];

impl RecordedAs {
    /// The same, with what it does not say from `general`.
    #[must_use]
    pub fn or(self, general: &Self) -> Self {
        Self {
            angle: self.angle.or(general.angle),
            time: self.time.or(general.time),
            current: self.current.or(general.current),
            rate_hz: self.rate_hz.or(general.rate_hz),
            counts_per_revolution: self
                .counts_per_revolution
                .or_else(|| general.counts_per_revolution.clone()),
            gear_ratio: self.gear_ratio.or_else(|| general.gear_ratio.clone()),
            topic: self.topic.or_else(|| general.topic.clone()),
            joint_names: self.joint_names.or_else(|| general.joint_names.clone()),
            drop: self.drop.or(general.drop),
            take: self.take,
            joined: self.joined,
        }
    }

    /// What it says of quantities, which may lie in several files: nothing of a file's own stamps, topic and columns.
    pub fn of_quantities(&self) -> Self {
        Self {
            angle: self.angle,
            current: self.current,
            counts_per_revolution: self.counts_per_revolution.clone(),
            gear_ratio: self.gear_ratio.clone(),
            joint_names: self.joint_names.clone(),
            ..Self::default()
        }
    }

    pub(crate) fn drops_rows(&self) -> bool {
        self.drop == Some(DroppedRows::NotANumber)
    }

    pub(crate) fn takes(&self, quantity: Quantity) -> bool {
        self.take.as_ref().is_none_or(|take| take.contains(&quantity))
    }

    pub(crate) fn validate(&self) -> Result<(), RecordingError> {
        if let Some(value) = self.rate_hz.filter(|rate| !(rate.is_finite() && *rate > 0.0)) {
            return Err(RecordingError::option("rate_hz", value, "it is rows per second, above zero"));
        }
        let lists =
            [("counts_per_revolution", &self.counts_per_revolution), ("gear_ratio", &self.gear_ratio)];
        for (option, list) in lists {
            let bad = list.iter().flatten().find(|v| !v.is_finite() || **v == 0.0);
            if let Some(value) = bad.copied() {
                return Err(RecordingError::option(option, value, "it must be finite and not zero"));
            }
        }
        Ok(())
    }

    pub(crate) fn time_factor(&self) -> Factor {
        [1.0, self.time.map_or(1.0, TimeUnit::per_second)]
    }

    pub(crate) fn current_factor(&self) -> Factor {
        [1.0, if self.current == Some(CurrentUnit::Milliampere) { 1e3 } else { 1.0 }]
    }

    /// The factor of each joint's positions and velocities. The unit of angles is none of a joint that slides.
    pub(crate) fn position_factors(&self, sliding: &[bool]) -> Result<Vec<Factor>, RecordingError> {
        let joints = sliding.len();
        let of_joint = |what: &str, list: &Option<Vec<f64>>| match list.as_deref() {
            None => Ok(vec![1.0; joints]),
            Some([one]) => Ok(vec![*one; joints]),
            Some(list) if list.len() == joints => Ok(list.to_vec()),
            Some(list) => Err(RecordingError::count(
                format!("`{what}` (one number, or one for each joint)"),
                joints,
                list.len(),
            )),
        };
        let counts = of_joint("counts_per_revolution", &self.counts_per_revolution)?;
        let gears = of_joint("gear_ratio", &self.gear_ratio)?;
        let of_unit = |slides: bool| match (&self.counts_per_revolution, self.angle) {
            (Some(_), _) => [TAU, 1.0],
            (None, Some(AngleUnit::Degree)) if !slides => [PI, 180.0],
            (None, _) => [1.0, 1.0],
        };
        let factor = |((counts, gear), slides): ((&f64, &f64), &bool)| {
            let [up, down] = of_unit(*slides);
            [up, down * counts * gear]
        };
        Ok(counts.iter().zip(&gears).zip(sliding).map(factor).collect())
    }
}

/// A column of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ColumnRef {
    /// By its place, counting from 0.
    Index(usize),
    /// By its name in the header (case does not matter).
    Name(String),
}

/// The columns of a quantity, one for each joint in the order of the joints.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ColumnsRef {
    /// From `first` to `last`, both included, counting from 0.
    Range {
        /// The column of joint 0.
        first: usize,
        /// The column of the last joint.
        last: usize,
    },
    /// One by one.
    List(Vec<ColumnRef>),
    /// All columns whose names are this and a joint number, e.g. `target_q` for `target_q_0`, `target_q_1`, ….
    Prefix(String),
}

/// Which columns hold what. Whatever is `None` is looked for by its usual names.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ColumnSelection {
    /// Time stamps in s.
    pub time: Option<ColumnRef>,
    /// Joint angles in rad.
    pub position: Option<ColumnsRef>,
    /// Joint velocities in rad/s.
    pub velocity: Option<ColumnsRef>,
    /// Joint torques or motor currents.
    pub measurement: Option<ColumnsRef>,
}
