//! The simulated machine in closed loop.
//!
//! The links are rigid bodies (articulated-body algorithm). Each joint is a motor with rotor inertia B, dry and
//! viscous friction on its shaft, and a gear that is rigid, elastic or has play:
//!
//! B θ̈ = u − f_v(θ̇) − f_c sgn θ̇ − (1 + c sgn(θ̇ τ_J)) τ_J,   M(q) q̈ + h(q, q̇) = τ_J + Jᵀ F,
//!
//! with θ = q for a rigid gear. u is what the drive delivers and what a logger measures, so that
//! u = M q̈ + h + B q̈ + friction holds at every instant up to the sensors' errors.
//!
//! Dry friction is the set-valued law: it holds a resting joint up to its level, and events (reversal,
//! sticking, break-away) are located and resolved. Between events the motion is smooth and is integrated with
//! the classical Runge–Kutta method in steps that resolve the fastest rate of the machine.

mod arm;
pub mod bristles;
mod contacts;
pub(crate) mod controller;
mod dynamics;
mod machine;
mod step;
mod step_size;
mod warmth;

pub use controller::Controller;
pub use machine::{
    Bristle, CoupledRotor, DryTerm, Gear, Instant, JointPhysics, LinearViscous, LinkTorque, Machine,
    ShaftTorque, Stretch, ViscousLaw,
};
pub use warmth::Warmth;

use controller::TrackingLoop;
use dynamics::{Command, Plant};
use step::Integrator;

use crate::error::{Complaints, SimulationError};
use crate::trajectory::Trajectory;

/// Distance of the samples of [`Traces`], s.
pub const TRACE_STEP_S: f64 = 2e-3;
/// Angle between a joint and its command beyond which a simulation has failed, rad.
const LARGEST_ERROR_RAD: f64 = 0.5;

/// What happened, every [`TRACE_STEP_S`], without any sensor: series of N values a sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Traces {
    pub joints: usize,
    /// Number of samples, [`TRACE_STEP_S`] apart.
    pub samples: usize,
    /// What the joints' encoders see: shaft angles, rad. They are the joint angles unless gears give way.
    pub position_rad: Vec<f64>,
    /// Velocities of the same.
    pub velocity_rad_s: Vec<f64>,
    /// Accelerations of the same.
    pub acceleration_rad_s2: Vec<f64>,
    /// Torques of the drives, Nm.
    pub torque_nm: Vec<f64>,
    /// Number of evaluations of the equations of motion.
    pub evaluations: u64,
    /// Number of reversals, stops and break-aways.
    pub events: u64,
    pub step_s: f64,
}

impl Traces {
    pub fn time_s(&self, sample: usize) -> f64 {
        sample as f64 * TRACE_STEP_S
    }
}

/// Lets the machine follow a trajectory.
///
/// # Errors
/// If the machine cannot be integrated ([`SimulationError::TooStiff`]) or loses its command
/// ([`SimulationError::Diverged`]).
pub fn run(
    machine: Machine,
    controller: &Controller,
    trajectory: &Trajectory,
) -> Result<Traces, SimulationError> {
    controller.validate()?;
    let tracking = TrackingLoop::new(controller, &machine.nominal, trajectory, TRACE_STEP_S)?;
    let start = tracking.start_rad();
    let home: Vec<f64> = machine.robot.drives.iter().map(|d| d.home_rad).collect();
    let mut plant = Plant::new(machine, Command::Track(tracking))?;
    let step_s = step_size::step_s(&mut plant, &home, TRACE_STEP_S)?;
    let samples = (trajectory.duration_s() / TRACE_STEP_S) as usize + 1;
    let rest = vec![0.0; plant.joints];
    traced(&mut plant, [&start, &rest], samples, step_s)
}

/// What a machine does under drive torques that stay as they are.
#[derive(Debug, Clone, PartialEq)]
pub struct Release {
    /// Angles at the start, rad, N entries.
    pub start_rad: Vec<f64>,
    /// Velocities at the start, rad/s, N entries.
    pub start_rad_s: Vec<f64>,
    /// Torques of the drives, Nm, N entries; all 0 lets it swing.
    pub torque_nm: Vec<f64>,
    pub duration_s: f64,
    /// Steps of the integration within [`TRACE_STEP_S`]; as many as the fastest rate needs unless set.
    pub steps: Option<usize>,
}

impl Release {
    /// Lets the machine go.
    ///
    /// # Errors
    /// [`SimulationError::Count`] for states or torques of another number of joints,
    /// [`SimulationError::Value`] for a duration or a number of steps that is not positive,
    /// [`SimulationError::TooStiff`], and [`SimulationError::Diverged`] if the motion is not finite.
    pub fn run(&self, machine: Machine) -> Result<Traces, SimulationError> {
        let n = machine.robot.joints();
        let mut complaints = Complaints::default();
        for (what, values) in [
            ("angles at the start", &self.start_rad),
            ("velocities at the start", &self.start_rad_s),
            ("drive torques", &self.torque_nm),
        ] {
            if values.len() != n {
                let what = what.to_owned();
                complaints.0.push(SimulationError::Count { what, expected: n, found: values.len() });
            }
            for value in values {
                complaints.within(what, *value, -1e6, 1e6);
            }
        }
        complaints.positive("duration in s", self.duration_s);
        complaints.within("steps of the integration", self.steps.unwrap_or(1) as f64, 1.0, 1e6);
        complaints.finish()?;
        let mut plant = Plant::new(machine, Command::Constant(self.torque_nm.clone()))?;
        let step_s = match self.steps {
            Some(steps) => TRACE_STEP_S / steps as f64,
            None => step_size::step_s(&mut plant, &self.start_rad, TRACE_STEP_S)?,
        };
        let samples = (self.duration_s / TRACE_STEP_S) as usize + 1;
        traced(&mut plant, [&self.start_rad, &self.start_rad_s], samples, step_s)
    }
}

/// Integrates from a state on and notes what happens.
fn traced(
    plant: &mut Plant,
    [start_rad, start_rad_s]: [&[f64]; 2],
    samples: usize,
    step_s: f64,
) -> Result<Traces, SimulationError> {
    let n = plant.joints;
    let mut integrator = Integrator::new(plant, start_rad, start_rad_s)?;
    let mut traces = Traces {
        joints: n,
        samples,
        position_rad: Vec::with_capacity(n * samples),
        velocity_rad_s: Vec::with_capacity(n * samples),
        acceleration_rad_s2: Vec::with_capacity(n * samples),
        torque_nm: Vec::with_capacity(n * samples),
        evaluations: 0,
        events: 0,
        step_s,
    };
    let pieces = (TRACE_STEP_S / step_s).round() as usize;
    for sample in 0..samples {
        let shafts = plant.compliant.len();
        for j in 0..n {
            let velocity = plant.shaft_velocity_index(j);
            let angle = if velocity < 2 * n { j } else { velocity - shafts };
            traces.position_rad.push(integrator.state[angle]);
            traces.velocity_rad_s.push(integrator.state[velocity]);
            traces.acceleration_rad_s2.push(integrator.rates[velocity]);
        }
        traces.torque_nm.extend_from_slice(&plant.drive_nm);
        check_state(plant, &integrator)?;
        if sample + 1 == samples {
            break;
        }
        let start_s = sample as f64 * TRACE_STEP_S;
        for piece in 1..=pieces {
            integrator.advance(plant, start_s + piece as f64 * step_s)?;
        }
    }
    traces.evaluations = integrator.evaluations;
    traces.events = integrator.events;
    Ok(traces)
}

/// Whether joints are where they are to be or, without command, anywhere.
fn check_state(plant: &Plant, integrator: &Integrator) -> Result<(), SimulationError> {
    for joint in 0..plant.joints {
        let at = integrator.state[joint];
        let (error, largest) = match &plant.command {
            Command::Track(tracking) => {
                (at - tracking.command_rad(integrator.time_s, joint), LARGEST_ERROR_RAD)
            }
            Command::Constant(_) => (at, f64::MAX),
        };
        // Written so that a NaN has failed too.
        let follows = error.abs() <= largest;
        if !follows {
            return Err(SimulationError::Diverged {
                joint,
                time_s: integrator.time_s,
                reason: format!("it is {error:.3} rad away"),
            });
        }
    }
    Ok(())
}
