use std::fmt::Debug;
use std::sync::Arc;

use aurt_traits::RigidBodyRegressor;

use crate::{MdhTable, RbdError, SerialChain};

/// What describes a robot's geometry: a table, a file of another format, a robot known by name. One format a file.
pub trait RobotDescription: Debug + Send + Sync {
    /// Number of joints N that move on their own.
    fn joints(&self) -> usize;

    /// The chain under a gravitational acceleration in the base frame.
    ///
    /// # Errors
    /// What makes the description no chain; [`RbdError::Coupled`] if joints follow others.
    fn chain(&self, gravity_m_s2: [f64; 3]) -> Result<SerialChain, RbdError>;

    /// The rigid bodies under a gravitational acceleration in the base frame: the chain, or a
    /// [`CoupledChain`](crate::CoupledChain) where joints follow others.
    ///
    /// # Errors
    /// What makes the description no chain.
    fn rigid_body(&self, gravity_m_s2: [f64; 3]) -> Result<Arc<dyn RigidBodyRegressor>, RbdError> {
        Ok(Arc::new(self.chain(gravity_m_s2)?))
    }

    /// What a person should know of how the description was read.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
}

impl RobotDescription for MdhTable {
    fn joints(&self) -> usize {
        self.rows.len()
    }

    fn chain(&self, gravity_m_s2: [f64; 3]) -> Result<SerialChain, RbdError> {
        SerialChain::from_mdh(self, gravity_m_s2)
    }

    fn notes(&self) -> Vec<String> {
        Self::notes(self)
    }
}
