use std::sync::Arc;

use aurt_rbd::INERTIAL_PARAMETERS;
use aurt_traits::{Motion, RigidBodyRegressor};

use super::own_model::OwnModel;
use super::smoothed::Smoothed;
use crate::error::SimulationError;

/// A recording as effects see it: its motion, the torque of its rigid bodies, and the robot's own friction.
#[derive(Debug, Clone)]
pub struct Scene {
    pub motion: Smoothed,
    /// Torque of the rigid bodies as fitted, `[joint][sample]`.
    pub load: Vec<Vec<f64>>,
    pub bodies: Arc<dyn RigidBodyRegressor>,
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
        let bodies = Arc::clone(&model.columns.bodies);
        let load = torque(&*bodies, &moving(&motion)?, &model.columns.standard);
        Ok(Self {
            motion,
            load,
            bodies,
            standard: model.columns.standard.clone(),
            coulomb: model.coulomb.clone(),
            viscous: model.viscous.clone(),
        })
    }

    pub fn joints(&self) -> usize {
        self.motion.joints()
    }

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

    pub(super) fn nothing(&self) -> Vec<Vec<f64>> {
        vec![vec![0.0; self.samples()]; self.joints()]
    }

    /// Torque of bodies with other inertial parameters.
    pub(super) fn torque_of(&self, standard: &[f64]) -> Result<Vec<Vec<f64>>, SimulationError> {
        Ok(torque(&*self.bodies, &moving(&self.motion)?, standard))
    }

    /// Torque of the robot's bodies where a joint stands `by_rad` further.
    pub(super) fn torque_at(&self, joint: usize, by_rad: f64) -> Result<Vec<Vec<f64>>, SimulationError> {
        let mut motion = self.motion.clone();
        motion.position_rad[joint].iter_mut().for_each(|q| *q += by_rad);
        Ok(torque(&*self.bodies, &moving(&motion)?, &self.standard))
    }

    /// Torque of the robot's bodies under another gravity.
    pub(super) fn torque_under(&self, gravity_m_s2: [f64; 3]) -> Result<Vec<Vec<f64>>, SimulationError> {
        Ok(torque(&*self.bodies.with_gravity(gravity_m_s2), &moving(&self.motion)?, &self.standard))
    }

    /// −Jᵀ d, the torque that drives have to hold against a force of 1 N in the direction d at the origin of a link's frame,
    /// `[row][sample]`: that of a mass of 1 kg there, under a gravity of d.
    pub(super) fn held_against(
        &self,
        link: usize,
        direction: [f64; 3],
    ) -> Result<Vec<Vec<f64>>, SimulationError> {
        let mut mass = vec![0.0; self.standard.len()];
        mass[link * INERTIAL_PARAMETERS + INERTIAL_PARAMETERS - 1] = 1.0;
        Ok(torque(&*self.bodies.with_gravity(direction), &self.resting(None)?, &mass))
    }

    /// The column of the mass matrix of a joint, `[row][sample]`: the torque of its acceleration of one, at rest and
    /// without gravity.
    pub(super) fn inertia_column(&self, joint: usize) -> Result<Vec<Vec<f64>>, SimulationError> {
        Ok(torque(&*self.bodies.with_gravity([0.0; 3]), &self.resting(Some(joint))?, &self.standard))
    }

    /// The poses of the motion at rest, with an acceleration of one of a joint.
    fn resting(&self, accelerated: Option<usize>) -> Result<Motion, SimulationError> {
        let samples = self.samples();
        let still = vec![0.0; self.joints() * samples];
        let mut acceleration = still.clone();
        if let Some(joint) = accelerated {
            acceleration[joint * samples..(joint + 1) * samples].fill(1.0);
        }
        let position = self.motion.position_rad.concat();
        Ok(Motion::new(self.joints(), self.motion.time_s.clone(), position, still, acceleration)?)
    }
}

pub(super) fn direction(velocity_rad_s: f64) -> f64 {
    (velocity_rad_s / CREEP_RAD_S).clamp(-1.0, 1.0)
}

fn moving(motion: &Smoothed) -> Result<Motion, SimulationError> {
    Ok(Motion::new(
        motion.joints(),
        motion.time_s.clone(),
        motion.position_rad.concat(),
        motion.velocity_rad_s.concat(),
        motion.acceleration_rad_s2.concat(),
    )?)
}

fn torque(bodies: &dyn RigidBodyRegressor, motion: &Motion, standard: &[f64]) -> Vec<Vec<f64>> {
    let (view, samples) = (motion.view(), motion.view().samples());
    let mut torques = vec![0.0; bodies.joints() * samples];
    bodies.torque(view, standard, &mut torques, samples);
    torques.chunks(samples.max(1)).map(<[f64]>::to_vec).collect()
}
