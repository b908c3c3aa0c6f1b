use aurt_rbd::{ChainDynamics, SerialChain};
use aurt_traits::{Motion, RigidBodyRegressor};

use super::own_model::OwnModel;
use super::smoothed::Smoothed;
use crate::error::SimulationError;

/// A recording as effects see it: its motion, the torque of its rigid bodies, and the robot's own friction.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The smoothed motion.
    pub motion: Smoothed,
    /// Torque of the rigid bodies as fitted, `[joint][sample]`.
    pub load: Vec<Vec<f64>>,
    /// Geometry under gravity.
    pub chain: SerialChain,
    /// Standard inertial parameters that give the fitted torques.
    pub standard: Vec<f64>,
    /// Fitted Coulomb friction of each joint.
    pub coulomb: Vec<f64>,
    /// Fitted viscous friction of each joint.
    pub viscous: Vec<f64>,
}

/// Below this speed friction has not its full size, rad/s: a joint that stands has no direction, and the sign of its
/// smoothed velocity is the encoder's noise. Quantisation of 1e-4 rad at 94 Hz leaves 4e-4 rad/s after smoothing.
pub(super) const CREEP_RAD_S: f64 = 5e-3;

impl Scene {
    pub(super) fn new(motion: Smoothed, model: &OwnModel) -> Result<Self, SimulationError> {
        let chain = model.chain().clone();
        let load = torque(&chain, &motion, model.standard())?;
        Ok(Self {
            motion,
            load,
            chain,
            standard: model.standard().to_vec(),
            coulomb: model.coulomb().to_vec(),
            viscous: model.viscous().to_vec(),
        })
    }

    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.motion.joints()
    }

    /// Number of samples.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.motion.samples()
    }

    /// Time since the first stamp, s.
    pub(super) fn since_start_s(&self, sample: usize) -> f64 {
        self.motion.time_s[sample] - self.motion.time_s[0]
    }

    /// Direction of motion, −1 to 1: the sign of the velocity, less than one where the joint creeps.
    pub(super) fn direction(&self, joint: usize, sample: usize) -> f64 {
        direction(self.motion.velocity_rad_s[joint][sample])
    }

    /// No torque on any joint.
    pub(super) fn nothing(&self) -> Vec<Vec<f64>> {
        vec![vec![0.0; self.samples()]; self.joints()]
    }

    /// Torque of bodies with other inertial parameters.
    pub(super) fn torque_of(&self, standard: &[f64]) -> Result<Vec<Vec<f64>>, SimulationError> {
        torque(&self.chain, &self.motion, standard)
    }

    /// Torque of the robot's bodies under another gravity.
    pub(super) fn torque_under(&self, gravity_m_s2: [f64; 3]) -> Result<Vec<Vec<f64>>, SimulationError> {
        torque(&self.chain.under_gravity(gravity_m_s2), &self.motion, &self.standard)
    }

    /// The column of the mass matrix of a joint, `[row][sample]`.
    pub(super) fn inertia_column(&self, joint: usize) -> Result<Vec<Vec<f64>>, SimulationError> {
        let joints = self.joints();
        let mut dynamics = ChainDynamics::new(self.chain.clone(), &self.standard)?;
        let mut column = self.nothing();
        let mut matrix = vec![0.0; joints * joints];
        let mut q = vec![0.0; joints];
        for k in 0..self.samples() {
            for (angle, series) in q.iter_mut().zip(&self.motion.position_rad) {
                *angle = series[k];
            }
            dynamics.mass_matrix(&q, &mut matrix);
            for (row, series) in column.iter_mut().enumerate() {
                series[k] = matrix[row * joints + joint];
            }
        }
        Ok(column)
    }
}

pub(super) fn direction(velocity_rad_s: f64) -> f64 {
    (velocity_rad_s / CREEP_RAD_S).clamp(-1.0, 1.0)
}

fn torque(
    chain: &SerialChain,
    motion: &Smoothed,
    standard: &[f64],
) -> Result<Vec<Vec<f64>>, SimulationError> {
    let (joints, samples) = (motion.joints(), motion.samples());
    let all = Motion::new(
        joints,
        motion.time_s.clone(),
        motion.position_rad.concat(),
        motion.velocity_rad_s.concat(),
        motion.acceleration_rad_s2.concat(),
    )?;
    let mut torques = vec![0.0; joints * samples];
    chain.torque(all.view(), standard, &mut torques, samples);
    Ok(torques.chunks(samples.max(1)).map(<[f64]>::to_vec).collect())
}
