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
pub(crate) mod controller;
mod dynamics;
mod machine;
mod step;
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

use crate::{SimulationError, Trajectory};

/// Distance of the samples of [`Traces`], s.
pub const TRACE_STEP_S: f64 = 2e-3;
/// Angle between a joint and its command beyond which a simulation has failed, rad.
const LARGEST_ERROR_RAD: f64 = 0.5;

/// What happened, every millisecond, without any sensor: series of N values a sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Traces {
    /// Number of joints N.
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
    /// Integration step, s.
    pub step_s: f64,
}

impl Traces {
    /// Time of a sample, s.
    #[must_use]
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
    let step_s = step::step_s(&mut plant, &home, TRACE_STEP_S)?;
    let n = plant.joints;
    let mut integrator = Integrator::new(&mut plant, &start, &vec![0.0; n])?;
    let samples = (trajectory.duration_s() / TRACE_STEP_S) as usize + 1;
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
        check_tracking(&plant, &integrator)?;
        let start_s = sample as f64 * TRACE_STEP_S;
        for piece in 1..=pieces {
            integrator.advance(&mut plant, start_s + piece as f64 * step_s)?;
        }
    }
    traces.evaluations = integrator.evaluations;
    traces.events = integrator.events;
    Ok(traces)
}

fn check_tracking(plant: &Plant, integrator: &Integrator) -> Result<(), SimulationError> {
    let Command::Track(tracking) = &plant.command;
    for joint in 0..plant.joints {
        let error = integrator.state[joint] - tracking.command_rad(integrator.time_s, joint);
        // Written so that a NaN has failed too.
        let follows = error.abs() <= LARGEST_ERROR_RAD;
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
