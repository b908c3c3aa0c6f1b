//! Physics beyond a robot's own, one effect a file.

use std::fmt::Debug;

use crate::plant::Machine;
use crate::sensors::{ClockFaults, Instrument};
use crate::{Robot, SimulationError};

/// What effects change.
#[derive(Debug)]
pub struct Setup {
    /// Bodies, drives and what acts on them.
    pub machine: Machine,
    /// Sensors.
    pub instrument: Instrument,
    /// What goes wrong with the recording's rows.
    pub faults: ClockFaults,
}

/// Physics beyond a robot's own.
pub trait Effect: Debug + Send + Sync {
    /// Identifier, snake_case.
    fn identifier(&self) -> &'static str;

    /// Checks that the effect can be on this robot.
    ///
    /// # Errors
    /// Every complaint.
    fn validate(&self, robot: &Robot) -> Result<(), SimulationError>;

    /// Puts the effect into the machine, its sensors or its logger.
    ///
    /// # Errors
    /// [`SimulationError::Conflict`] with an effect that is there already.
    fn install(&self, setup: &mut Setup) -> Result<(), SimulationError>;
}
