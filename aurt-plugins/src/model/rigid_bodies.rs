//! The rigid bodies of a robot and their base parameters.

use std::sync::Arc;

use aurt_rbd::{MdhTable, SerialChain, base_parameters};
use aurt_traits::{ArmTerm, BaseParameters, JointStack, RigidBodyRegressor, RobotModel};

use crate::model::error::Error;

/// Seed of the random motions by which base parameters are found, unless another is asked for. Any seed finds the
/// same ones; a fixed one makes files reproducible to the last digit.
pub const BASE_PARAMETER_SEED: u64 = 0;

/// A robot's rigid bodies and what of their inertial parameters a recording can determine.
#[derive(Debug, Clone)]
pub struct RigidBodyDynamics {
    /// The regressor in the standard parameters.
    pub rigid_body: Arc<dyn RigidBodyRegressor>,
    /// The base parameters.
    pub base: BaseParameters,
}

impl RigidBodyDynamics {
    /// The rigid bodies of any kind.
    ///
    /// # Errors
    /// [`Error::RigidBody`] if the base parameters cannot be determined.
    pub fn new(rigid_body: Arc<dyn RigidBodyRegressor>, seed: u64) -> Result<Self, Error> {
        let base = base_parameters(&*rigid_body, seed)?;
        Ok(Self { rigid_body, base })
    }

    /// The serial chain of a table of modified Denavit–Hartenberg parameters.
    ///
    /// # Errors
    /// [`Error::RigidBody`] if the table gives no chain, or as [`Self::new`].
    pub fn from_mdh(table: &MdhTable, gravity_m_s2: [f64; 3], seed: u64) -> Result<Self, Error> {
        Self::new(Arc::new(SerialChain::from_mdh(table, gravity_m_s2)?), seed)
    }

    /// The robot model of these bodies, a stack per joint, and arm terms.
    ///
    /// # Errors
    /// [`Error::Assembly`] if stacks or arm terms do not fit the robot.
    pub fn with_joint_dynamics(
        self,
        stacks: Vec<JointStack>,
        arm_terms: Vec<Box<dyn ArmTerm>>,
    ) -> Result<RobotModel, Error> {
        RobotModel::new(self.rigid_body, self.base, stacks, arm_terms).map_err(Error::Assembly)
    }
}
