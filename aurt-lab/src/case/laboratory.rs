use super::layout::{RecordingSettings, Slot};
use crate::effects::Undeclared;
use aurt_simulation::effects::{Effect, Shapes};
use aurt_simulation::plant::Controller;
use aurt_simulation::robots::Robot;
use aurt_simulation::sensors::{Instrument, Logger};
use aurt_simulation::{Scenario, SimulationError};

/// What surrounds the robot of a case: its controller, its sensors and logger, how recordings are made and the experiment
/// is written, and the physics that the experiment neglects.
#[derive(Debug, Clone)]
pub(super) struct Laboratory {
    pub controller: Controller,
    pub instrument: Instrument,
    pub logger: Logger,
    /// Highest frequency of the dynamics that the experiment states, Hz.
    pub f_dyn_hz: f64,
    pub shapes: Shapes,
    /// What acts in every recording and is declared nowhere.
    pub undeclared: Option<Undeclared>,
    /// The speed below which strengths count a joint as resting; see [`crate::fit::NoiseFreeFit`].
    pub rest_rad_s: Option<f64>,
    /// In how many recordings at most an effect is measured, and how many draws of joints and sizes are tried.
    pub effort: (usize, usize),
}

/// Highest frequency of the robots' dynamics that the experiments of the clean world state, Hz.
pub(super) const CLEAN_F_DYN_HZ: f64 = 10.0;

impl Laboratory {
    /// The clean world's: the robot's own sensors, an even clock, an experiment that neglects nothing.
    pub fn clean(robot: &Robot, settings: &RecordingSettings) -> Self {
        Self {
            controller: Controller::default(),
            instrument: Instrument::of(robot),
            logger: Logger { rate_hz: settings.rate_hz, ..Logger::default() },
            f_dyn_hz: CLEAN_F_DYN_HZ,
            shapes: Shapes::Usual,
            undeclared: None,
            rest_rad_s: None,
            effort: (usize::MAX, 6),
        }
    }

    /// The recording of a slot with the given effects. What is undeclared comes last and takes them as they are.
    pub fn scenario(&self, robot: &Robot, slot: &Slot, mut effects: Vec<Box<dyn Effect>>) -> Scenario {
        if let Some(undeclared) = &self.undeclared {
            effects.push(Box::new(undeclared.clone()));
        }
        Scenario {
            controller: self.controller,
            instrument: Some(self.instrument.clone()),
            logger: self.logger,
            effects,
            ..Scenario::new(robot.clone(), slot.trajectory.clone(), slot.seed)
        }
    }

    /// What happens in a slot without any effect but what is undeclared.
    pub fn trace(
        &self,
        robot: &Robot,
        slot: &Slot,
    ) -> Result<aurt_simulation::plant::Traces, SimulationError> {
        aurt_simulation::trace(&self.scenario(robot, slot, Vec::new()))
    }
}
