//! What the structure of an experiment has beyond rigid bodies.

use serde::{Deserialize, Serialize};

use crate::robots::Robot;

/// Which terms beyond the base parameters a joint's row has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointStructure {
    /// Coulomb friction.
    pub coulomb: bool,
    /// Viscous friction.
    pub viscous: bool,
    /// Rotor inertia.
    pub rotor: bool,
    /// Dry friction in proportion to the load.
    pub load: bool,
}

/// The terms of all joints.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Structure {
    /// One per joint.
    pub joints: Vec<JointStructure>,
}

impl Structure {
    /// What the robot has by itself.
    #[must_use]
    pub fn of(robot: &Robot) -> Self {
        let joints = robot
            .drives
            .iter()
            .map(|drive| JointStructure {
                coulomb: drive.coulomb_nm > 0.0,
                viscous: drive.viscous_nm_s > 0.0,
                rotor: drive.rotor_inertia_kg_m2 > 0.0,
                load: drive.load_coefficient > 0.0,
            })
            .collect();
        Self { joints }
    }
}
