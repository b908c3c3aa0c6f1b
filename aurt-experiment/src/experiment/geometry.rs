use std::path::{Path, PathBuf};
use std::sync::Arc;

use aurt_rbd::robots::DescribedRobot;
use aurt_rbd::{JointKind, MdhTable, RbdError, RobotDescription, SerialChain};
use aurt_traits::{Branch, RigidBodyRegressor};

#[derive(Debug, Clone, PartialEq)]
pub enum Geometry {
    /// `mdh`: a table of modified Denavit–Hartenberg parameters.
    Mdh {
        path: PathBuf,
        /// What that file holds, read as `mdh_rows` says (`"next"`, the default, or `"previous"`).
        table: MdhTable,
    },
    /// `urdf` or `mjcf`, with `base` and one of `tip`, `tips` and `joints`: a chain or tree of a robot description file.
    Urdf { path: PathBuf, robot: Box<DescribedRobot> },
    /// `name`: a robot known by name.
    Known(Box<DescribedRobot>),
}

impl Geometry {
    /// The file that holds the geometry, if it is in one.
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::Mdh { path, .. } | Self::Urdf { path, .. } => Some(path),
            Self::Known(_) => None,
        }
    }

    fn described(&self) -> Option<&DescribedRobot> {
        match self {
            Self::Mdh { .. } => None,
            Self::Urdf { robot, .. } | Self::Known(robot) => Some(robot),
        }
    }

    /// Values of all standard parameters, where a description states masses.
    pub fn standard_parameters(&self) -> Option<&[f64]> {
        self.described()?.standard_parameters.as_deref()
    }

    pub fn joint_names(&self) -> &[String] {
        self.described().map_or(&[], |robot| &robot.joint_names)
    }

    /// Whether each joint slides: its positions are in m.
    pub fn sliding(&self) -> Vec<bool> {
        match self {
            Self::Mdh { table, .. } => {
                table.rows.iter().map(|row| row.kind == JointKind::Prismatic).collect()
            }
            Self::Urdf { robot, .. } | Self::Known(robot) => robot.sliding(),
        }
    }

    /// The joints beside the chain, where a description has some.
    pub fn branches(&self) -> &[Branch] {
        self.described().map_or(&[], |robot| &robot.branches)
    }

    /// Number of links: one of each joint, those that follow others too.
    pub fn links(&self) -> usize {
        match self {
            Self::Mdh { table, .. } => table.rows.len(),
            Self::Urdf { robot, .. } | Self::Known(robot) => robot.joints.len(),
        }
    }

    fn description(&self) -> &dyn RobotDescription {
        match self {
            Self::Mdh { table, .. } => table,
            Self::Urdf { robot, .. } | Self::Known(robot) => &**robot,
        }
    }
}

impl RobotDescription for Geometry {
    fn joints(&self) -> usize {
        self.description().joints()
    }

    fn chain(&self, gravity_m_s2: [f64; 3]) -> Result<SerialChain, RbdError> {
        self.description().chain(gravity_m_s2)
    }

    fn rigid_body(&self, gravity_m_s2: [f64; 3]) -> Result<Arc<dyn RigidBodyRegressor>, RbdError> {
        self.description().rigid_body(gravity_m_s2)
    }

    fn notes(&self) -> Vec<String> {
        self.description().notes()
    }
}
