use std::sync::Arc;

use crate::{CoupledChain, Coupling, Joint, JointKind, RbdError, RobotDescription, SerialChain};
use aurt_traits::{Branch, RigidBodyRegressor};
use serde::{Deserialize, Serialize};

/// How far, how fast and how hard a joint can go; in m, m/s and N for a prismatic joint.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct JointLimits {
    /// Lowest and highest position in rad, as they are stated: plans of motions refuse a lowest that is not below the
    /// highest. `None` for a joint that turns without end, and where nothing is said.
    pub position_rad: Option<[f64; 2]>,
    /// Highest speed in rad/s.
    pub velocity_rad_s: Option<f64>,
    /// Highest torque in Nm.
    pub torque_nm: Option<f64>,
}

/// Friction that a description states; in N s/m and N for a prismatic joint.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct JointFriction {
    /// Viscous friction in Nm s/rad.
    pub viscous_nm_s_rad: f64,
    /// Coulomb friction in Nm.
    pub coulomb_nm: f64,
}

/// A chain or tree of a robot description: geometry, limits, and inertial parameters where the description has them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DescribedRobot {
    /// The robot's name.
    pub name: String,
    /// The link that it starts from.
    pub base: String,
    /// The link that a chain ends at; empty for a tree.
    pub tip: String,
    /// What of the description it is.
    pub part: Part,
    /// The names of the N joints that move on their own, each after those that carry it.
    pub joint_names: Vec<String>,
    /// The names of the M links, each of the link that its joint moves; empty where they have none.
    pub link_names: Vec<String>,
    /// The M joints, each after those that carry it: the N and those that follow one of them.
    pub joints: Vec<Joint>,
    /// How each of the M joints moves; empty where none follows another.
    pub couplings: Vec<Coupling>,
    /// The limits of the N joints, narrowed to those of the joints that follow them.
    pub limits: Vec<JointLimits>,
    /// The friction of the N joints with that of those that follow.
    pub friction: Vec<JointFriction>,
    /// Of each of the N joints the inertia of its rotor as the joint feels it, in kg m² (kg of a prismatic joint): MuJoCo's
    /// `armature`.
    pub armature_kg_m2: Vec<f64>,
    /// 10 M standard parameters, link after link {XX XY XZ YY YZ ZZ mX mY mZ m} in the frames of the chain, with those
    /// of the bodies that a link carries; `None` if the description has no masses.
    pub standard_parameters: Option<Vec<f64>>,
    /// Of each of the M joints the frame of its link in the description's own frame of that joint, row after row: the chain's
    /// frames have their z axes along the joints.
    pub frames: Vec<[[f64; 3]; 3]>,
    /// The joints beside the chain, carried as fixed at zero.
    pub branches: Vec<Branch>,
    /// What a person should know of how the description was read.
    pub notes: Vec<String>,
}

impl RobotDescription for DescribedRobot {
    fn joints(&self) -> usize {
        self.joint_names.len()
    }

    fn chain(&self, gravity_m_s2: [f64; 3]) -> Result<SerialChain, RbdError> {
        if !self.couplings.is_empty() {
            let (joints, own) = (self.joints.len(), self.joint_names.len());
            return Err(RbdError::Coupled { joints, followers: joints - own });
        }
        SerialChain::new(self.joints.clone(), gravity_m_s2)?
            .with_joint_names(self.joint_names.clone())?
            .with_link_names(self.link_names.clone())?
            .with_branches(self.branches.clone())
    }

    fn rigid_body(&self, gravity_m_s2: [f64; 3]) -> Result<Arc<dyn RigidBodyRegressor>, RbdError> {
        if self.couplings.is_empty() {
            return Ok(Arc::new(self.chain(gravity_m_s2)?));
        }
        let chain =
            SerialChain::new(self.joints.clone(), gravity_m_s2)?.with_link_names(self.link_names.clone())?;
        let coupled = CoupledChain::new(chain, self.couplings.clone())?;
        let named = coupled.with_joint_names(self.joint_names.clone())?;
        Ok(Arc::new(named.with_branches(self.branches.clone())?))
    }

    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }
}

impl DescribedRobot {
    /// Whether each of the N joints slides: its positions are in m.
    pub fn sliding(&self) -> Vec<bool> {
        (0..self.joint_names.len()).map(|j| Coupling::slides(j, &self.joints, &self.couplings)).collect()
    }

    /// What each of the M joints does.
    pub fn kinds(&self) -> Vec<JointKind> {
        self.joints.iter().map(|joint| joint.kind).collect()
    }
}

/// Which joints of a description move on its base; all others are fixed at zero.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Part {
    /// All.
    #[default]
    All,
    /// Those between the base and these links: one link gives a serial chain.
    Tips(Vec<String>),
    /// These, and those that follow them.
    Joints(Vec<String>),
}

impl From<Option<&str>> for Part {
    /// The chain to a tip; without one, all.
    fn from(tip: Option<&str>) -> Self {
        tip.map_or(Self::All, |tip| Self::Tips(vec![tip.to_owned()]))
    }
}
