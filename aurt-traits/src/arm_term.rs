use std::fmt::Debug;

use crate::{
    Columns, CoulombModel, HysteresisModel, Invariants, ModelError, MotionView, Parameter,
    RigidBodyRegressor, ShapeParameter, ViscousBasis,
};

/// What an [`ArmTerm`] receives: the motion of all joints and what loads them.
#[derive(Debug, Clone, Copy)]
pub struct ArmSeries<'a> {
    /// The motion of all joints.
    pub motion: MotionView<'a>,
    /// Load torque τ_J of all joints, joint after joint, `load_stride` apart.
    pub load_torque: &'a [f64],
    /// Distance between the first samples of two joints in `load_torque`.
    pub load_stride: usize,
    /// The robot's rigid bodies, for terms that are rigid bodies themselves (payload, base tilt).
    pub rigid_body: &'a dyn RigidBodyRegressor,
}

impl<'a> ArmSeries<'a> {
    /// The load torque of one joint.
    pub fn load_torque(&self, joint: usize) -> &'a [f64] {
        let start = joint * self.load_stride;
        &self.load_torque[start..start + self.motion.samples()]
    }
}

/// The models of equation (6) that an [`ArmTerm`] is made of, to be filled from its keys `coulomb`, `hysteresis` and
/// `viscous`.
#[derive(Debug)]
pub struct InnerModels<'a> {
    /// f_C.
    pub coulomb: &'a mut Box<dyn CoulombModel>,
    /// H.
    pub hysteresis: &'a mut Box<dyn HysteresisModel>,
    /// f_v.
    pub viscous: &'a mut Box<dyn ViscousBasis>,
}

/// Physics outside equation (6): terms that write the rows of any joints and share coefficients among them
/// (coupling, payload, base tilt, rotor inertia, spring), or friction that lacks the invariants of a slot
/// (asymmetric viscous friction, LuGre with its σ₁ damping).
///
/// The term's torque on joint j is Σ_k coefficient_k · column(j, k); `out` holds column (j, k) for the i-th
/// joint of [`Self::joints`] at `i · columns + k`.
#[typetag::serde(tag = "model")]
pub trait ArmTerm: Debug + Send + Sync {
    /// The registered name, as `model = "…"` in an experiment spells it.
    fn name(&self) -> &str;

    /// A copy, for variants with other shape parameters.
    fn boxed_clone(&self) -> Box<dyn ArmTerm>;

    /// The joints whose rows the term writes, ascending, for a robot of `robot_joints` joints.
    fn joints(&self, robot_joints: usize) -> Vec<usize>;

    /// The linear coefficients, for a robot of `robot_joints` joints.
    fn columns(&self, robot_joints: usize) -> Vec<Parameter>;

    /// Whether coefficient `column` can act on `joint`; false promises a column of zeros.
    fn acts_on(&self, column: usize, joint: usize, robot_joints: usize) -> bool {
        let _ = column;
        self.joints(robot_joints).contains(&joint)
    }

    /// What the term declares of itself.
    fn invariants(&self) -> Invariants;

    /// Whether the term's torque is transmitted by the joints and so belongs to their load τ_J.
    fn is_load(&self) -> bool {
        false
    }

    /// The models of equation (6) that the term is made of, where its keys `coulomb`, `hysteresis` and `viscous` name
    /// such; none for a term of its own equation.
    ///
    /// `typetag` reads the linked models alone. A term that hands out its models here has them built like those of
    /// `[joint_dynamics]`, models of dynamic libraries included; each of the keys has to have a default.
    fn inner_models(&mut self) -> Option<InnerModels<'_>> {
        None
    }

    /// Everything that is wrong with the configuration for a robot of `robot_joints` joints.
    ///
    /// # Errors
    /// Every complaint, not only the first.
    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>>;

    /// The same on rigid bodies of `links` links, which are more than joints where joints follow others.
    ///
    /// # Errors
    /// Every complaint, not only the first.
    fn validate_on(&self, robot_joints: usize, links: usize) -> Result<(), Vec<ModelError>> {
        let _ = links;
        self.validate(robot_joints)
    }

    /// The parameters in which the term is not linear.
    fn shape_parameters(&self) -> Vec<ShapeParameter> {
        Vec::new()
    }

    /// Sets all shape parameters, in the order of [`Self::shape_parameters`].
    ///
    /// # Errors
    /// If the number of values or a value does not fit.
    fn set_shape(&mut self, values: &[f64]) -> Result<(), ModelError> {
        if values.is_empty() {
            return Ok(());
        }
        Err(ModelError::count(format!("shape parameters of `{}`", self.name()), 0, values.len()))
    }

    /// Number of state variables for a robot of `robot_joints` joints.
    fn state_len(&self, robot_joints: usize) -> usize {
        let _ = robot_joints;
        0
    }

    /// The state before the first sample of a series (`first` holds that sample alone).
    fn initial_state(&self, first: &ArmSeries<'_>) -> Vec<f64> {
        vec![0.0; self.state_len(first.motion.joints())]
    }

    /// Writes every column over the whole series and moves `state` to its end; all columns are written,
    /// those for which [`Self::acts_on`] is false with zeros.
    ///
    /// # Errors
    /// [`ModelError::Evaluation`] where the term cannot be evaluated; the output is then unspecified.
    fn evaluate(
        &self,
        series: &ArmSeries<'_>,
        state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), ModelError>;
}

impl Clone for Box<dyn ArmTerm> {
    fn clone(&self) -> Self {
        (**self).boxed_clone()
    }
}
