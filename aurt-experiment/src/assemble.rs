//! From the sections of an experiment to a robot model.

use aurt::data::Pipeline;
use aurt_plugins::model::{BASE_PARAMETER_SEED, Error, RigidBodyDynamics};
use aurt_traits::{KnownBodies, RobotModel};

use crate::experiment::Experiment;

impl Experiment {
    pub fn rigid_body_dynamics(&self) -> Result<RigidBodyDynamics, Error> {
        let rigid_body = self.robot.rigid_body()?;
        RigidBodyDynamics::new(rigid_body, BASE_PARAMETER_SEED)
    }

    /// The way in which its recordings become what models see.
    pub fn pipeline(&self) -> Pipeline<'_> {
        Pipeline {
            joints: self.robot.robot_joints(),
            preprocessing: &self.preprocess,
            instrument: &self.instrument,
        }
    }

    /// The robot model of `[robot]`, `[joint_dynamics]` and `[[arm_terms]]`.
    pub fn robot_model(&self) -> Result<RobotModel, Error> {
        let stacks = self.joint_dynamics.stacks(self.joints()).map_err(Error::Assembly)?;
        let model = self.rigid_body_dynamics()?.with_joint_dynamics(stacks, self.arm_terms.clone())?;
        Ok(match (self.prior_weight, self.robot.geometry.standard_parameters()) {
            (Some(weight), Some(standard)) => {
                model.with_known_bodies(KnownBodies { standard: standard.to_vec(), weight })
            }
            _ => model,
        })
    }
}
