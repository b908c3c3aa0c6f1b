//! A robot model from its parts.

use aurt_traits::{ArmTerm, ModelError, RobotModel};

use crate::model::error::Error;
use crate::model::friction::Friction;
use crate::model::rigid_bodies::RigidBodyDynamics;

/// The parts of a robot model: rigid bodies, the friction of each joint, arm terms.
///
/// ```
/// use aurt_friction::arm_terms::{coupling::Coupling, payload::Payload, rotor_inertia::RotorInertia};
/// use aurt_plugins::model::{Friction, Robot};
///
/// let robot = Robot::by_name("ur10e", [0.0, 0.0, -9.81])?;
/// let model = robot
///     .model()
///     .friction(Friction::coulomb().viscous(1))
///     .joint_friction(1, Friction::load_dependent().viscous(2))
///     .arm_term(RotorInertia::default())
///     .arm_term(Payload::default())
///     .build()?;
/// assert_eq!(model.arm_terms().len(), 2);
/// # Ok::<(), aurt_plugins::model::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ModelBuilder {
    bodies: RigidBodyDynamics,
    friction: Friction,
    of_joints: Vec<(usize, Friction)>,
    arm_terms: Vec<Box<dyn ArmTerm>>,
}

impl ModelBuilder {
    pub(crate) fn new(bodies: RigidBodyDynamics) -> Self {
        Self { bodies, friction: Friction::default(), of_joints: Vec::new(), arm_terms: Vec::new() }
    }

    /// The friction of every joint that has none of its own.
    #[must_use]
    pub fn friction(self, friction: Friction) -> Self {
        Self { friction, ..self }
    }

    /// The friction of one joint, counted from 0; the last choice for a joint counts.
    #[must_use]
    pub fn joint_friction(mut self, joint: usize, friction: Friction) -> Self {
        self.of_joints.push((joint, friction));
        self
    }

    /// Adds physics beyond rigid bodies and joint friction: rotor inertia, a payload, a coupling, a spring.
    #[must_use]
    pub fn arm_term(self, term: impl ArmTerm + 'static) -> Self {
        self.boxed_arm_term(Box::new(term))
    }

    /// The same, of a term that a [`Registry`](crate::Registry) built by its name.
    #[must_use]
    pub fn boxed_arm_term(mut self, term: Box<dyn ArmTerm>) -> Self {
        self.arm_terms.push(term);
        self
    }

    /// The model.
    ///
    /// # Errors
    /// [`Error::Assembly`] for parts that do not fit the robot or one another.
    pub fn build(self) -> Result<RobotModel, Error> {
        let joints = self.bodies.rigid_body.joints();
        let mut friction = vec![self.friction; joints];
        for (joint, own) in self.of_joints {
            let place = friction.get_mut(joint).ok_or_else(|| {
                let what = format!("joints, counted from 0, for the friction of joint {joint}");
                Error::Assembly(vec![ModelError::Count { what, expected: joint + 1, found: joints }])
            })?;
            *place = own;
        }
        let stacks = friction.into_iter().map(Friction::stack).collect::<Result<_, _>>()?;
        self.bodies.with_joint_dynamics(stacks, self.arm_terms)
    }
}
