use std::fmt::Debug;

use serde::{Deserialize, Serialize};

use crate::{Jet, ModelError, Parameter};

/// A number of a drive that may be known or estimated.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveParameter {
    /// Its name, which is also its key in experiments, and its unit.
    pub parameter: Parameter,
    /// The value as configured; the start of its estimate.
    pub value: f64,
    /// Standard deviation of what is known of it before a recording, where it is estimated.
    pub deviation: f64,
    /// The least and the greatest value that a drive can have.
    pub bounds: [f64; 2],
}

/// What a drive sees within a step of the simulation. The entries of prismatic joints are in m and m/s.
pub struct DriveInput<'a> {
    /// Time at the middle of the step, s.
    pub time_s: f64,
    /// Length of the step, s.
    pub step_s: f64,
    /// The mean of the command over a window about a time, both in s, as its [`CommandSignal`] has it, in the unit of
    /// [`DriveModel::command`].
    pub command: &'a dyn Fn(Jet, f64) -> Jet,
    /// Position of the joint at the middle of the step, in rad.
    pub position_rad: Jet,
    /// Velocity at the start of the step, in rad/s.
    pub velocity_rad_s: Jet,
}

/// The torque of a drive about a velocity: τ(q̇ + δ) ≈ `torque` − `damping` · δ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveTorque {
    /// Torque on the joint, Nm, at [`DriveInput::velocity_rad_s`].
    pub torque: Jet,
    /// −∂τ/∂q̇ ≥ 0 in Nm s/rad, which the integrator treats implicitly.
    pub damping: Jet,
}

/// The unit of a drive's command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Command {
    /// Torque, Nm (N of a prismatic joint).
    Torque,
    /// Motor current with its sign, A.
    Current,
    /// Motor voltage, V; a duty cycle times the supply.
    Voltage,
    /// Position, rad (m of a prismatic joint).
    Position,
}

/// The command between two samples of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum CommandSignal {
    /// The last one holds until the next: firmware that receives commands.
    Hold,
    /// On the line between the two: a command that is sent much more often than it is recorded.
    #[default]
    Linear,
}

/// A drive of one joint: from its command to the torque on the joint.
///
/// Written in [`Jet`]s, so that one code gives torques and their derivatives. A drive is registered by
/// `#[typetag::serde(name = "…")]` on its implementation and then found by `model = "…"` in `[drive]` of an experiment.
#[typetag::serde(tag = "model")]
pub trait DriveModel: Debug + Send + Sync {
    /// The registered name.
    fn name(&self) -> &str;

    /// What drives the drive.
    fn command(&self) -> Command;

    /// The command between its samples, unless an experiment states otherwise.
    fn usual_signal(&self) -> CommandSignal {
        CommandSignal::Linear
    }

    /// Every number of the drive, in the order in which [`Self::torque`] takes them.
    fn parameters(&self) -> Vec<DriveParameter>;

    /// Sets all numbers, in the order of [`Self::parameters`].
    fn set_parameters(&mut self, values: &[f64]);

    /// Whether the configuration makes sense.
    ///
    /// # Errors
    /// Every complaint, not only the first.
    fn validate(&self) -> Result<(), Vec<ModelError>> {
        let bad = self.parameters().into_iter().filter(|p| !(p.bounds[0]..=p.bounds[1]).contains(&p.value));
        let complain = |p: DriveParameter| {
            let reason = format!("must lie within {} and {}, is {}", p.bounds[0], p.bounds[1], p.value);
            ModelError::parameter(self.name(), p.parameter.name, reason)
        };
        let errors: Vec<_> = bad.map(complain).collect();
        if errors.is_empty() { Ok(()) } else { Err(errors) }
    }

    /// What the drive remembers from step to step, at rest under `command`.
    fn initial_state(&self, command: f64) -> Vec<Jet> {
        let _ = command;
        Vec::new()
    }

    /// The torque within a step with the values `parameters`; moves `state` on.
    fn torque(&self, parameters: &[Jet], input: &DriveInput<'_>, state: &mut [Jet]) -> DriveTorque;

    /// A copy.
    fn boxed_clone(&self) -> Box<dyn DriveModel>;
}

impl Clone for Box<dyn DriveModel> {
    fn clone(&self) -> Self {
        self.boxed_clone()
    }
}
