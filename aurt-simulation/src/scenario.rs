use crate::effects::{Effect, Setup};
use crate::error::SimulationError;
use crate::plant::{self, Controller, Machine, Traces};
use crate::robots::Robot;
use crate::sensors::{Instrument, Logger, SimulatedRecording};
use crate::trajectory::Trajectory;

/// One recording to be made.
///
/// ```
/// use aurt_simulation::{Motion, Scenario, robots, simulate};
///
/// let robot = robots::ur10e();
/// let motion = Motion::MultiSine { duration_s: 3.0, harmonics: 5, top_hz: 1.0, share: 0.5 };
/// let recording = simulate(&Scenario::new(robot.clone(), motion.plan(&robot, 7)?, 7))?;
/// assert_eq!(recording.header()[1], "actual_q_0");
/// assert_eq!(recording.rows(), 1501);
/// # Ok::<(), aurt_simulation::SimulationError>(())
/// ```
#[derive(Debug)]
pub struct Scenario {
    /// The robot, before effects change it.
    pub robot: Robot,
    /// The motion that it is asked for.
    pub trajectory: Trajectory,
    /// How it is driven.
    pub controller: Controller,
    /// The physics beyond the robot's own.
    pub effects: Vec<Box<dyn Effect>>,
    /// Sensors; the robot's own unless set.
    pub instrument: Option<Instrument>,
    /// The recording's rate, clock and columns.
    pub logger: Logger,
    pub seed: u64,
}

impl Scenario {
    /// A scenario without effects, with the default controller and logger and the robot's own sensors.
    pub fn new(robot: Robot, trajectory: Trajectory, seed: u64) -> Self {
        Self {
            robot,
            trajectory,
            controller: Controller::default(),
            effects: Vec::new(),
            instrument: None,
            logger: Logger::default(),
            seed,
        }
    }

    /// Checks robot and effects and puts them together.
    fn set_up(&self) -> Result<Setup, SimulationError> {
        self.robot.validate()?;
        self.trajectory.check(&self.robot)?;
        let mut errors = Vec::new();
        for effect in &self.effects {
            if let Err(error) = effect.validate(&self.robot) {
                errors.push(error);
            }
        }
        SimulationError::all(errors)?;
        let mut setup = Setup {
            machine: Machine::new(&self.robot),
            instrument: self.instrument.clone().unwrap_or_else(|| Instrument::of(&self.robot)),
            faults: self.logger.faults,
        };
        for effect in &self.effects {
            effect.install(&mut setup)?;
        }
        setup.machine.robot.validate()?;
        Ok(setup)
    }
}

/// What happens in a scenario, without sensors.
///
/// # Errors
/// If robot, trajectory or effects are refused, and as [`plant::run`].
pub fn trace(scenario: &Scenario) -> Result<Traces, SimulationError> {
    plant::run(scenario.set_up()?.machine, &scenario.controller, &scenario.trajectory)
}

/// The same with the sensors that belong to it.
pub fn trace_with_instrument(scenario: &Scenario) -> Result<(Traces, Instrument), SimulationError> {
    let setup = scenario.set_up()?;
    let traces = plant::run(setup.machine, &scenario.controller, &scenario.trajectory)?;
    Ok((traces, setup.instrument))
}

/// What the logger writes of a scenario.
///
/// # Errors
/// As [`trace`], and if sensors or logger are refused.
pub fn simulate(scenario: &Scenario) -> Result<SimulatedRecording, SimulationError> {
    simulate_with_traces(scenario).map(|(recording, _)| recording)
}

/// What the logger writes of a scenario, and what really happened.
pub fn simulate_with_traces(scenario: &Scenario) -> Result<(SimulatedRecording, Traces), SimulationError> {
    let setup = scenario.set_up()?;
    let logger = Logger { faults: setup.faults, ..scenario.logger };
    logger.validate()?;
    setup.instrument.validate()?;
    let traces = plant::run(setup.machine, &scenario.controller, &scenario.trajectory)?;
    let recording = logger.record(&traces, &setup.instrument, scenario.robot.unit, scenario.seed)?;
    Ok((recording, traces))
}
