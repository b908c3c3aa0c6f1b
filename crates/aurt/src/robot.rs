//! A robot's geometry, and models on top of it.

use std::path::Path;

use aurt_experiment::{BASE_PARAMETER_SEED, Registry, RigidBodyDynamics, SlotModel};
use aurt_rbd::{MdhRows, MdhTable, RobotDescription};
use aurt_traits::{ArmTerm, CoulombModel, HysteresisModel, JointStack, RobotModel, ViscousBasis};
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
}

impl Robot {
    /// The robot of a description, under a gravitational acceleration in the base frame.
    ///
    /// # Errors
    /// What makes the description no robot.
    pub fn new(description: &dyn RobotDescription, gravity_m_s2: [f64; 3]) -> Result<Self, Failure> {
        let chain = description.chain(gravity_m_s2)?;
        let dynamics = RigidBodyDynamics::new(std::sync::Arc::new(chain), BASE_PARAMETER_SEED)?;
        Ok(Self { dynamics, notes: description.notes() })
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
            coulomb: "none".into(),
            hysteresis: "sign".into(),
            viscous: r#"{ model = "polynomial", powers = [1] }"#.into(),
            arm_terms: Vec::new(),
        }
    }
}

/// The models that a robot model is composed of, each by its name (`absolute`) or as an experiment writes it
/// (`{ model = "stribeck", load = "absolute" }`); `aurt models` lists them.
#[derive(Debug, Clone)]
pub struct ModelBuilder {
    dynamics: RigidBodyDynamics,
    coulomb: String,
    hysteresis: String,
    viscous: String,
    arm_terms: Vec<String>,
}

impl ModelBuilder {
    /// The Coulomb level f_C(τ_J) of every joint.
    #[must_use]
    pub fn coulomb(self, model: impl Into<String>) -> Self {
        Self { coulomb: model.into(), ..self }
    }

    /// The hysteresis H(z, q̇) of every joint.
    #[must_use]
    pub fn hysteresis(self, model: impl Into<String>) -> Self {
        Self { hysteresis: model.into(), ..self }
    }

    /// The viscous friction f_v(q̇) of every joint.
    #[must_use]
    pub fn viscous(self, model: impl Into<String>) -> Self {
        Self { viscous: model.into(), ..self }
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
            found::<dyn CoulombModel>(registry, &self.coulomb)?,
            found::<dyn HysteresisModel>(registry, &self.hysteresis)?,
            found::<dyn ViscousBasis>(registry, &self.viscous)?,
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
