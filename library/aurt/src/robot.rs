//! A robot's geometry, and models on top of it.

use std::path::Path;

use aurt_experiment::{BASE_PARAMETER_SEED, Registry, RigidBodyDynamics, SlotModel};
use aurt_rbd::{MdhRows, MdhTable, RobotDescription};
use aurt_robots::{DescribedRobot, KNOWN_ROBOTS, known_robot, probably_meant};
use aurt_traits::{
    ArmTerm, BaseParameters, CoulombModel, HysteresisModel, JointStack, RigidBodyRegressor, RobotModel,
    ViscousBasis,
};
use serde_json::{Value, json};

use crate::failure::Failure;

/// A robot: its rigid bodies under gravity, without values of their parameters.
///
/// ```
/// use aurt::prelude::*;
///
/// let table = "alpha,a,d\n0,0,0\n0,1,0\n";
/// let robot = Robot::from_mdh(table, [0.0, -9.81, 0.0])?;
/// let model = robot.model().coulomb("absolute").viscous(r#"{ model = "polynomial", powers = [1, 3] }"#).build()?;
/// assert_eq!(model.joints(), 2);
/// # Ok::<(), aurt::Error>(())
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
    pub fn new(description: &dyn RobotDescription, gravity_m_s2: [f64; 3]) -> Result<Self, Failure> {
        let dynamics = RigidBodyDynamics::new(description.rigid_body(gravity_m_s2)?, BASE_PARAMETER_SEED)?;
        Ok(Self { dynamics, notes: description.notes(), described: None })
    }

    /// The robot of a chain of a description file, or of a name; [`Self::described`] has its names and limits.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn of_description(described: DescribedRobot, gravity_m_s2: [f64; 3]) -> Result<Self, Failure> {
        Ok(Self { described: Some(Box::new(described.clone())), ..Self::new(&described, gravity_m_s2)? })
    }

    /// The serial chain between two links of a URDF or MJCF file; without `base` it starts at the file's root, without `tip` it
    /// ends where the only moving chain does.
    ///
    /// # Errors
    /// Everything that is wrong with the file, each with its place.
    pub fn read_urdf(
        path: impl AsRef<Path>,
        base: Option<&str>,
        tip: Option<&str>,
        gravity_m_s2: [f64; 3],
    ) -> Result<Self, Failure> {
        Self::of_description(aurt_robots::read(path, base, tip)?, gravity_m_s2)
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
    ) -> Result<Self, Failure> {
        Self::of_description(aurt_robots::parse(text, "robot.urdf", base, tip)?, gravity_m_s2)
    }

    /// A robot known by name, such as `ur10e`: geometry and limits, without masses, which makers do not publish.
    ///
    /// # Errors
    /// [`Failure::Argument`] for another name.
    pub fn by_name(name: &str, gravity_m_s2: [f64; 3]) -> Result<Self, Failure> {
        let Some(known) = known_robot(name) else {
            let meant =
                probably_meant(name).map(|name| format!("did you mean `{name}`? ")).unwrap_or_default();
            let names: Vec<&str> = KNOWN_ROBOTS.iter().map(|robot| robot.name).collect();
            return Err(Failure::Argument {
                option: "name",
                reason: format!("`{name}` names no known robot"),
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
    pub fn from_mdh(table: &str, gravity_m_s2: [f64; 3]) -> Result<Self, Failure> {
        Self::new(&MdhTable::parse(table, "mdh.csv", MdhRows::default())?, gravity_m_s2)
    }

    /// The same from a file.
    ///
    /// # Errors
    /// A file that cannot be read; every mistake in it, with its place.
    pub fn read_mdh(path: impl AsRef<Path>, gravity_m_s2: [f64; 3]) -> Result<Self, Failure> {
        Self::new(&MdhTable::from_path(path.as_ref(), MdhRows::default())?, gravity_m_s2)
    }

    /// Number of joints N.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.dynamics.rigid_body.joints()
    }

    /// Names, limits and, where the description has masses, standard parameters; none of a table.
    #[must_use]
    pub fn described(&self) -> Option<&DescribedRobot> {
        self.described.as_deref()
    }

    /// The rigid bodies, τ = Y(q, q̇, q̈) π with 10 N standard parameters π.
    #[must_use]
    pub fn rigid_body(&self) -> &dyn RigidBodyRegressor {
        &*self.dynamics.rigid_body
    }

    /// The base inertial parameters.
    #[must_use]
    pub fn base_parameters(&self) -> &BaseParameters {
        &self.dynamics.base
    }

    /// What a person should know of how the geometry was read.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// A model of this robot: constant Coulomb friction and linear viscous friction in every joint unless other models
    /// are named.
    #[must_use]
    pub fn model(&self) -> ModelBuilder {
        ModelBuilder {
            dynamics: self.dynamics.clone(),
            coulomb: Choice::Named("none".into()),
            hysteresis: Choice::Named("sign".into()),
            viscous: Choice::Named(r#"{ model = "polynomial", powers = [1] }"#.into()),
            arm_terms: Vec::new(),
        }
    }
}

/// The models that a robot model is composed of, each by its name (`absolute`) or as an experiment writes it
/// (`{ model = "stribeck", load = "absolute" }`); `aurt models` lists them.
#[derive(Debug, Clone)]
pub struct ModelBuilder {
    dynamics: RigidBodyDynamics,
    coulomb: Choice<dyn CoulombModel>,
    hysteresis: Choice<dyn HysteresisModel>,
    viscous: Choice<dyn ViscousBasis>,
    arm_terms: Vec<String>,
}

/// A model as it is asked for.
enum Choice<M: ?Sized> {
    /// By its name, or as an experiment writes it.
    Named(String),
    /// The model itself.
    Given(Box<M>),
}

impl<M: ?Sized> Clone for Choice<M>
where
    Box<M>: Clone,
{
    fn clone(&self) -> Self {
        match self {
            Self::Named(name) => Self::Named(name.clone()),
            Self::Given(model) => Self::Given(model.clone()),
        }
    }
}

impl<M: ?Sized + std::fmt::Debug> std::fmt::Debug for Choice<M> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Named(name) => f.debug_tuple("Named").field(name).finish(),
            Self::Given(model) => f.debug_tuple("Given").field(model).finish(),
        }
    }
}

impl<M: SlotModel + ?Sized> Choice<M> {
    fn build(self, registry: &Registry) -> Result<Box<M>, Failure> {
        match self {
            Self::Named(name) => found(registry, &name),
            Self::Given(model) => Ok(model),
        }
    }
}

impl ModelBuilder {
    /// The Coulomb level f_C(τ_J) of every joint.
    #[must_use]
    pub fn coulomb(self, model: impl Into<String>) -> Self {
        Self { coulomb: Choice::Named(model.into()), ..self }
    }

    /// The same, of a model that no registry knows.
    #[must_use]
    pub fn coulomb_model(self, model: Box<dyn CoulombModel>) -> Self {
        Self { coulomb: Choice::Given(model), ..self }
    }

    /// The hysteresis H(z, q̇) of every joint.
    #[must_use]
    pub fn hysteresis(self, model: impl Into<String>) -> Self {
        Self { hysteresis: Choice::Named(model.into()), ..self }
    }

    /// The same, of a model that no registry knows.
    #[must_use]
    pub fn hysteresis_model(self, model: Box<dyn HysteresisModel>) -> Self {
        Self { hysteresis: Choice::Given(model), ..self }
    }

    /// The viscous friction f_v(q̇) of every joint.
    #[must_use]
    pub fn viscous(self, model: impl Into<String>) -> Self {
        Self { viscous: Choice::Named(model.into()), ..self }
    }

    /// The same, of a model that no registry knows.
    #[must_use]
    pub fn viscous_model(self, model: Box<dyn ViscousBasis>) -> Self {
        Self { viscous: Choice::Given(model), ..self }
    }

    /// Adds an arm term: rotor inertia, a payload, a spring.
    #[must_use]
    pub fn arm_term(mut self, model: impl Into<String>) -> Self {
        self.arm_terms.push(model.into());
        self
    }

    /// The model, of linked models.
    ///
    /// # Errors
    /// As [`Self::build_with`].
    pub fn build(self) -> Result<RobotModel, Failure> {
        self.build_with(&Registry::linked()?)
    }

    /// The model, of the models of a registry.
    ///
    /// # Errors
    /// Unknown models, wrong keys, and models that do not fit their slot or the robot.
    pub fn build_with(self, registry: &Registry) -> Result<RobotModel, Failure> {
        let stack = JointStack::new(
            self.coulomb.build(registry)?,
            self.hysteresis.build(registry)?,
            self.viscous.build(registry)?,
        )
        .map_err(Failure::Models)?;
        let terms = self.arm_terms.iter().map(|term| found::<dyn ArmTerm>(registry, term));
        let arm_terms = terms.collect::<Result<Vec<_>, Failure>>()?;
        let stacks = vec![stack; self.dynamics.rigid_body.joints()];
        Ok(self.dynamics.with_joint_dynamics(stacks, arm_terms)?)
    }
}

/// The model of a name or an inline table.
fn found<M: SlotModel + ?Sized>(registry: &Registry, written: &str) -> Result<Box<M>, Failure> {
    let table = if written.trim_start().starts_with('{') {
        let document: toml::Table =
            toml::from_str(&format!("model = {written}")).map_err(|error| Failure::Argument {
                option: M::SLOT.name(),
                reason: format!("`{written}` is no table: {}", error.message()),
                remedy: "write { model = \"name\", key = value }, or the name alone".into(),
            })?;
        document.get("model").map_or(Value::Null, |table| json!(table))
    } else {
        json!({ "model": written })
    };
    registry.build_from_json(&table).map_err(Failure::Build)
}
