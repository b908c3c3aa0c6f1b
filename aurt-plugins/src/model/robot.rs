//! A robot's geometry, and models on top of it.

use std::path::Path;
use std::sync::Arc;

use aurt_rbd::robots::{DescribedRobot, KNOWN_ROBOTS, known_robot, probably_meant};
use aurt_rbd::{MdhRows, MdhTable, RobotDescription};
use aurt_traits::{BaseParameters, RigidBodyRegressor};

use crate::model::builder::ModelBuilder;
use crate::model::error::Error;
use crate::model::rigid_bodies::{BASE_PARAMETER_SEED, RigidBodyDynamics};

/// A robot: its rigid bodies under gravity, without values of their parameters.
///
/// ```
/// use aurt_plugins::model::{Friction, Robot};
///
/// let table = "alpha,a,d\n0,0,0\n0,1,0\n";
/// let robot = Robot::from_mdh(table, [0.0, -9.81, 0.0])?;
/// let model = robot.model().friction(Friction::load_dependent().viscous(3)).build()?;
/// assert_eq!(model.joints(), 2);
/// # Ok::<(), aurt_plugins::model::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Robot {
    dynamics: RigidBodyDynamics,
    notes: Vec<String>,
    described: Option<Box<DescribedRobot>>,
}

impl Robot {
    /// The robot of a description, under a gravitational acceleration in the base frame.
    ///
    /// # Errors
    /// What makes the description no robot.
    pub fn new(description: &dyn RobotDescription, gravity_m_s2: [f64; 3]) -> Result<Self, Error> {
        let robot = Self::of_bodies(description.rigid_body(gravity_m_s2)?)?;
        Ok(Self { notes: description.notes(), ..robot })
    }

    /// The robot of rigid bodies of any kind: whatever gives τ = Y(q, q̇, q̈) π.
    ///
    /// # Errors
    /// If the base parameters cannot be determined.
    pub fn of_bodies(bodies: Arc<dyn RigidBodyRegressor>) -> Result<Self, Error> {
        let dynamics = RigidBodyDynamics::new(bodies, BASE_PARAMETER_SEED)?;
        Ok(Self { dynamics, notes: Vec::new(), described: None })
    }

    /// The robot of a chain or tree of a description file, or of a name; [`Self::described`] has its names and limits.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of_description(described: DescribedRobot, gravity_m_s2: [f64; 3]) -> Result<Self, Error> {
        Ok(Self { described: Some(Box::new(described.clone())), ..Self::new(&described, gravity_m_s2)? })
    }

    /// The serial chain between two links of a URDF or MJCF file; without `base` it starts at the file's root, without `tip` it
    /// is the tree of all joints. [`aurt_rbd::robots::read`] takes other parts, for [`Self::of_description`].
    ///
    /// # Errors
    /// Everything that is wrong with the file, each with its place.
    pub fn read_urdf(
        path: impl AsRef<Path>,
        base: Option<&str>,
        tip: Option<&str>,
        gravity_m_s2: [f64; 3],
    ) -> Result<Self, Error> {
        Self::of_description(aurt_rbd::robots::read(path, base, &tip.into(), None)?, gravity_m_s2)
    }

    /// The same from the text of such a file.
    ///
    /// # Errors
    /// As [`Self::read_urdf`].
    pub fn from_urdf(
        text: &str,
        base: Option<&str>,
        tip: Option<&str>,
        gravity_m_s2: [f64; 3],
    ) -> Result<Self, Error> {
        Self::of_description(
            aurt_rbd::robots::parse(text, "robot.urdf", base, &tip.into(), None)?,
            gravity_m_s2,
        )
    }

    /// A robot known by name, such as `ur10e`: geometry and limits, without masses, which makers do not publish.
    ///
    /// # Errors
    /// [`Error::UnknownRobot`] for another name.
    pub fn by_name(name: &str, gravity_m_s2: [f64; 3]) -> Result<Self, Error> {
        let Some(known) = known_robot(name) else {
            let meant =
                probably_meant(name).map(|name| format!("did you mean `{name}`? ")).unwrap_or_default();
            let names: Vec<&str> = KNOWN_ROBOTS.iter().map(|robot| &*robot.name).collect();
            return Err(Error::UnknownRobot {
                name: name.to_owned(),
                remedy: format!(
                    "{meant}known are {}; others need a URDF file or an MDH table",
                    names.join(", ")
                ),
            });
        };
        Self::of_description(known.description(), gravity_m_s2)
    }

    /// The robot of a table of modified Denavit–Hartenberg parameters (text with the columns `alpha`, `a`, `d`).
    ///
    /// # Errors
    /// Every mistake in the table, with its place.
    pub fn from_mdh(table: &str, gravity_m_s2: [f64; 3]) -> Result<Self, Error> {
        Self::new(&MdhTable::parse(table, "mdh.csv", MdhRows::default())?, gravity_m_s2)
    }

    /// The same from a file.
    ///
    /// # Errors
    /// A file that cannot be read; every mistake in it, with its place.
    pub fn read_mdh(path: impl AsRef<Path>, gravity_m_s2: [f64; 3]) -> Result<Self, Error> {
        Self::new(&MdhTable::from_path(path.as_ref(), MdhRows::default())?, gravity_m_s2)
    }

    /// Number of joints N.
    pub fn joints(&self) -> usize {
        self.dynamics.rigid_body.joints()
    }

    /// Names, limits and, where the description has masses, standard parameters; none of a table.
    pub fn described(&self) -> Option<&DescribedRobot> {
        self.described.as_deref()
    }

    /// The rigid bodies, τ = Y(q, q̇, q̈) π with 10 N standard parameters π.
    pub fn rigid_body(&self) -> &dyn RigidBodyRegressor {
        &*self.dynamics.rigid_body
    }

    /// The base inertial parameters.
    pub fn base_parameters(&self) -> &BaseParameters {
        &self.dynamics.base
    }

    /// What a person should know of how the geometry was read.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The same robot with these notes.
    #[must_use]
    pub fn with_notes(self, notes: Vec<String>) -> Self {
        Self { notes, ..self }
    }

    /// A model of this robot, with the friction F_C0 sgn q̇ + F_v1 q̇ in every joint unless another is chosen.
    pub fn model(&self) -> ModelBuilder {
        ModelBuilder::new(self.dynamics.clone())
    }
}
