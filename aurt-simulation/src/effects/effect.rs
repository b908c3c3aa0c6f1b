//! What an effect is, and what effects change.

use std::fmt::Debug;

use serde_json::Value;

use crate::error::{Complaints, SimulationError};
use crate::plant::Machine;
use crate::robots::Robot;
use crate::sensors::{ClockFaults, Instrument};

/// What effects change.
#[derive(Debug)]
pub struct Setup {
    /// Bodies, drives and what acts on them.
    pub machine: Machine,
    pub instrument: Instrument,
    /// What goes wrong with the recording's rows.
    pub faults: ClockFaults,
}

/// Physics beyond a robot's own.
pub trait Effect: Debug + Send + Sync {
    /// Identifier, snake_case.
    fn identifier(&self) -> &'static str;

    /// The joints that the effect names; for effects of the whole arm, all.
    fn joints(&self) -> Vec<usize>;

    /// Its parameters by their canonical names: one value, or one for each of [`Self::joints`].
    fn parameters(&self) -> Vec<(&'static str, Vec<f64>)>;

    /// When it acts, if it does not always.
    fn window_s(&self) -> Option<[f64; 2]> {
        None
    }

    /// Terms of the robot's own friction that the effect stands for, so that an experiment that is not to know
    /// of it has to leave them out.
    fn hidden(&self) -> Hidden {
        Hidden::Nothing
    }

    /// Makes the effect stronger or weaker, about in proportion, within what a real machine could have.
    fn scale(&mut self, factor: Factor<'_>, robot: &Robot);

    /// Checks that the effect can be on this robot.
    fn validate(&self, robot: &Robot) -> Result<(), SimulationError>;

    /// Puts the effect into the machine, its sensors or its logger.
    ///
    /// # Errors
    /// [`SimulationError::Conflict`] with an effect that is there already.
    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError>;

    /// All its fields, readable by [`read_effect`](super::read_effect).
    fn fields(&self) -> Value;
}

/// By how much effects are to change their size.
#[derive(Debug, Clone, Copy)]
pub enum Factor<'a> {
    /// By the same factor on all joints.
    Uniform(f64),
    /// By a factor for each of the robot's joints.
    PerJoint(&'a [f64]),
}

impl Factor<'_> {
    pub fn on(&self, joint: usize) -> f64 {
        match self {
            Self::Uniform(factor) => *factor,
            Self::PerJoint(factors) => factors.get(joint).copied().unwrap_or(1.0),
        }
    }

    /// Multiplies values, one for each of some joints, within the bounds on a joint.
    pub fn scale(&self, joints: &[usize], values: &mut [f64], bounds: impl Fn(usize) -> [f64; 2]) {
        for (joint, value) in joints.iter().zip(values) {
            let [low, high] = bounds(*joint);
            *value = (*value * self.on(*joint)).clamp(low, high);
        }
    }
}

/// A term of equation (6) that an effect stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hidden {
    Nothing,
    Coulomb,
    Viscous,
}

/// Complains about joints that the robot does not have, none at all, or one named twice.
pub fn check_joints(complaints: &mut Complaints, effect: &str, joints: &[usize], robot: &Robot) {
    for (i, joint) in joints.iter().enumerate() {
        complaints.part(format!("`{effect}`"), "joint", *joint, (&robot.name, robot.joints()));
        if joints[..i].contains(joint) {
            let reason = "it is named twice";
            complaints.0.push(SimulationError::value(
                format!("a joint of `{effect}`"),
                *joint as f64,
                reason,
            ));
        }
    }
    if joints.is_empty() {
        let what = format!("joints of `{effect}`");
        complaints.0.push(SimulationError::Count { what, expected: 1, found: 0 });
    }
}

/// Complains unless there is one value per joint, each between `low` and `high`.
pub fn check_values(
    complaints: &mut Complaints,
    effect: &str,
    name: &str,
    joints: &[usize],
    values: &[f64],
    (low, high): (f64, f64),
) {
    if values.len() != joints.len() {
        let what = format!("`{name}` of `{effect}`");
        complaints.0.push(SimulationError::Count { what, expected: joints.len(), found: values.len() });
    }
    for (joint, value) in joints.iter().zip(values) {
        complaints.within(format!("`{name}` of `{effect}` on joint {joint}"), *value, low, high);
    }
}

/// Two effects that cannot act on one joint together.
pub fn conflict(first: &str, second: &str, joint: usize, reason: &str) -> SimulationError {
    SimulationError::Conflict { first: first.into(), second: second.into(), joint, reason: reason.into() }
}
