//! Mistakes that can be undone in a setup.

use aurt_rbd::{Joint, MdhRows};

/// A mistake of a setup. What it holds is what undoes it.
#[derive(Debug, Clone, PartialEq)]
pub enum Mistake {
    /// Gravity points elsewhere, or has another size.
    Gravity { to_m_s2: [f64; 3] },
    /// Links and joints are others.
    Geometry { what: Table, joints: Vec<Joint> },
    /// A recording is to be read otherwise.
    Reading {
        what: Reading,
        /// The recording, by its place among the subject's; all if none.
        file: Option<usize>,
    },
}

/// What can be wrong with links and joints.
#[derive(Debug, Clone, PartialEq)]
pub enum Table {
    /// `mdh_rows` is the other way.
    Rows(MdhRows),
    /// All lengths are in another unit: what they are multiplied with.
    Lengths(f64),
    /// The rows stand from tip to base.
    Reversed,
    Exchanged,
    /// α has the other sign everywhere.
    Mirrored,
    /// It is another robot, known by this name.
    Known(&'static str),
    /// A joint's zero is elsewhere: what is added to its angle, rad.
    Zero {
        joint: usize,
        offset_rad: f64,
        in_table: bool,
    },
}

/// What can be wrong with the reading of a recording.
#[derive(Debug, Clone, PartialEq)]
pub enum Reading {
    Degrees,
    Turns,
    /// Positions are those of motors behind a gear of this ratio.
    Geared(f64),
    PositionSign(usize),
    MeasurementSign(usize),
    /// A joint's axis points the other way: its position and its measurement have the other sign.
    AxisSign(usize),
    AllMeasurementSigns,
    /// Joints stand in another order: joint j is column `order[j]`.
    Order {
        of: Columns,
        order: Vec<usize>,
    },
    /// Measurements are of this much later than positions, s.
    Delay(f64),
    /// Time runs slower or faster: what stamps are multiplied with.
    Time(f64),
    /// A joint's measurement is in another unit or behind another constant: what it is multiplied with.
    Gain {
        joint: usize,
        factor: f64,
    },
    /// The torque constants of two joints are exchanged.
    Constants {
        joints: [usize; 2],
        /// What the first one's measurement is multiplied with, and the other's divided by.
        factor: f64,
    },
    /// It is only so in a stretch.
    During {
        what: Box<Reading>,
        /// From and to when, s from the first stamp; an end without a number is that of the recording.
        span_s: [Option<f64>; 2],
    },
}

/// Columns whose order can be wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Columns {
    Position,
    Measurement,
    Both,
}

impl Columns {
    pub(super) const fn positions(self) -> bool {
        matches!(self, Self::Position | Self::Both)
    }

    pub(super) const fn measurements(self) -> bool {
        matches!(self, Self::Measurement | Self::Both)
    }
}

pub(super) fn pairs(joints: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..joints).flat_map(move |a| (a + 1..joints).map(move |b| [a, b]))
}

pub(super) fn exchanged(order: &[usize], [a, b]: [usize; 2]) -> Vec<usize> {
    let mut order = order.to_vec();
    order.swap(a, b);
    order
}

impl Mistake {
    /// The one recording that it is in.
    pub fn file(&self) -> Option<usize> {
        match self {
            Self::Reading { file, .. } => *file,
            Self::Gravity { .. } | Self::Geometry { .. } => None,
        }
    }

    /// The joints whose columns it is in; none where it is in no column of some joints alone.
    pub(super) fn own_joints(&self) -> Vec<usize> {
        match self {
            Self::Reading { what, .. } => what.own_joints(),
            Self::Gravity { .. } | Self::Geometry { .. } => Vec::new(),
        }
    }

    pub fn is_delay(&self) -> bool {
        matches!(self, Self::Reading { what: Reading::Delay(_), .. })
    }

    /// Whether two mistakes are about the same thing, so that one of them is enough.
    pub fn is_about_what(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Gravity { .. }, Self::Gravity { .. }) => true,
            (Self::Geometry { what: a, .. }, Self::Geometry { what: b, .. }) => match (a, b) {
                (Table::Zero { joint: a, .. }, Table::Zero { joint: b, .. }) => a == b,
                (Table::Zero { .. }, _) | (_, Table::Zero { .. }) => false,
                _ => true,
            },
            (Self::Reading { what: a, file: f }, Self::Reading { what: b, file: g }) => {
                (f == g || f.is_none() || g.is_none()) && a.is_about_what(b)
            }
            _ => false,
        }
    }
}

impl Reading {
    fn own_joints(&self) -> Vec<usize> {
        match self {
            Self::PositionSign(joint)
            | Self::MeasurementSign(joint)
            | Self::AxisSign(joint)
            | Self::Gain { joint, .. } => vec![*joint],
            Self::Constants { joints, .. } => joints.to_vec(),
            Self::Order { order, .. } => (0..order.len()).filter(|j| order[*j] != *j).collect(),
            Self::During { what, .. } => what.own_joints(),
            _ => Vec::new(),
        }
    }

    fn is_about_what(&self, other: &Self) -> bool {
        let scale = |r: &Self| matches!(r, Self::Degrees | Self::Turns | Self::Geared(_));
        match (self, other) {
            (Self::During { what: a, span_s: s }, Self::During { what: b, span_s: t }) => {
                s == t && a.is_about_what(b)
            }
            (a, b) if scale(a) && scale(b) => true,
            (Self::Order { .. }, Self::Order { .. })
            | (Self::Delay(_), Self::Delay(_))
            | (Self::Time(_), Self::Time(_)) => true,
            (Self::Gain { joint: a, .. }, Self::Gain { joint: b, .. }) => a == b,
            (Self::Gain { joint, .. }, Self::Constants { joints, .. })
            | (Self::Constants { joints, .. }, Self::Gain { joint, .. }) => joints.contains(joint),
            (a, b) => a == b,
        }
    }
}
