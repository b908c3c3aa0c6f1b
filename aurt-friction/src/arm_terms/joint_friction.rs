//! `joint_friction`: a further stack of equation (6) beside the joint's own.
//!
//! # Equation
//! τ_j = f_C(τ_J,j) · H(z_j, q̇_j) + f_v(q̇_j), with coefficients of its own.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `joints` | – | joints that have the term; all unless given |
//! | `coulomb` | – | Coulomb model, `{ model = "constant" }` unless given |
//! | `hysteresis` | – | hysteresis model, `{ model = "sign" }` unless given |
//! | `viscous` | – | viscous model, none unless given |
//!
//! The three models may be models of dynamic libraries.
//!
//! # Columns
//! Those of the stack, each with `_<joint>` appended.
//!
//! # Use when
//! Forces of equation (6) add up: a sign-shaped Coulomb level, for instance, with Maxwell-slip elements beside
//! it, which a single product of Coulomb and hysteresis models cannot express.
//!
//! # Source
//! Equation (6) of the AURT paper; the sum of parallel friction elements is Iwan's (1966).

use aurt_traits::{
    ArmSeries, ArmTerm, Columns, CoulombModel, HysteresisModel, InnerModels, Invariants, JointSeries,
    JointStack, ModelError, Parameter, Result, ViscousBasis, register_model,
};
use serde::{Deserialize, Serialize};

use crate::arm_terms::joint_selection::JointSelection;
use crate::coulomb::constant::Constant;
use crate::hysteresis::sign::Sign;
use crate::shape::verdict;
use crate::viscous::polynomial::Polynomial;

/// A second stack on joints.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointFriction {
    /// Joints that have the term.
    #[serde(default, skip_serializing_if = "JointSelection::is_all")]
    pub joints: JointSelection,
    /// Coulomb model.
    #[serde(default = "constant_level")]
    pub coulomb: Box<dyn CoulombModel>,
    /// Hysteresis model.
    #[serde(default = "sign")]
    pub hysteresis: Box<dyn HysteresisModel>,
    /// Viscous model.
    #[serde(default = "no_viscous")]
    pub viscous: Box<dyn ViscousBasis>,
}

fn constant_level() -> Box<dyn CoulombModel> {
    Box::new(Constant {})
}

fn sign() -> Box<dyn HysteresisModel> {
    Box::new(Sign::default())
}

fn no_viscous() -> Box<dyn ViscousBasis> {
    Box::new(Polynomial { powers: Vec::new() })
}

register_model! {
    slot: ArmTerm,
    name: "joint_friction",
    summary: "a further Coulomb × hysteresis + viscous stack on joints",
    equation: "τ_j = f_C(τ_J)·H(z, q̇) + f_v(q̇), beside the joint's own",
    use_when: "forces of equation (6) add up, such as a Coulomb level with presliding elements beside it",
    source: "equation (6) of the AURT paper; Iwan (1966)",
    example: r#"{ model = "joint_friction", joints = [0, 1], hysteresis = { model = "maxwell_slip" } }"#,
}

impl JointFriction {
    fn stack(&self) -> Result<JointStack, Vec<ModelError>> {
        JointStack::new(self.coulomb.clone(), self.hysteresis.clone(), self.viscous.clone())
    }

    /// The stack, where validation has let it pass.
    fn evaluable(&self) -> Result<JointStack, ModelError> {
        self.stack().map_err(|mut errors| {
            errors.pop().unwrap_or(ModelError::evaluation("joint_friction", "the stack is not valid"))
        })
    }

    fn per_joint(&self) -> Vec<Parameter> {
        self.stack().map_or_else(|_| Vec::new(), |stack| stack.columns())
    }
}

fn joint_series<'a>(series: &ArmSeries<'a>, joint: usize) -> JointSeries<'a> {
    JointSeries::of(series.motion, joint, series.load_torque(joint))
}

#[typetag::serde(name = "joint_friction")]
impl ArmTerm for JointFriction {
    declares_term! { "joint_friction" }

    fn joints(&self, robot_joints: usize) -> Vec<usize> {
        self.joints.resolve(robot_joints)
    }

    fn columns(&self, robot_joints: usize) -> Vec<Parameter> {
        let own = self.per_joint();
        self.joints
            .resolve(robot_joints)
            .iter()
            .flat_map(|j| own.iter().map(move |p| Parameter::new(format!("{}_{j}", p.name), p.unit.clone())))
            .collect()
    }

    fn acts_on(&self, column: usize, joint: usize, robot_joints: usize) -> bool {
        self.joints.owns(robot_joints, self.per_joint().len(), column, joint)
    }

    fn invariants(&self) -> Invariants {
        let common = self.coulomb.invariants().bits()
            & self.hysteresis.invariants().bits()
            & self.viscous.invariants().bits();
        Invariants::from_bits(common)
    }

    fn inner_models(&mut self) -> Option<InnerModels<'_>> {
        Some(InnerModels {
            coulomb: &mut self.coulomb,
            hysteresis: &mut self.hysteresis,
            viscous: &mut self.viscous,
        })
    }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        let mut complaints = self.joints.complaints("joint_friction", robot_joints);
        complaints.extend(self.stack().err().into_iter().flatten());
        verdict(complaints)
    }

    fn shape_parameters(&self) -> Vec<aurt_traits::ShapeParameter> {
        self.stack().map_or_else(|_| Vec::new(), |stack| stack.shape_parameters())
    }

    fn set_shape(&mut self, values: &[f64]) -> Result<(), ModelError> {
        let mut stack = self.evaluable()?;
        stack.set_shape(values)?;
        self.coulomb = stack.coulomb().boxed_clone();
        self.hysteresis = stack.hysteresis().boxed_clone();
        self.viscous = stack.viscous().boxed_clone();
        Ok(())
    }

    fn state_len(&self, robot_joints: usize) -> usize {
        let own = self.coulomb.state_len() + self.hysteresis.state_len() + self.viscous.state_len();
        own * self.joints.resolve(robot_joints).len()
    }

    fn initial_state(&self, first: &ArmSeries<'_>) -> Vec<f64> {
        let Ok(stack) = self.stack() else { return Vec::new() };
        self.joints
            .resolve(first.motion.joints())
            .iter()
            .flat_map(|joint| stack.initial_state(&joint_series(first, *joint)))
            .collect()
    }

    fn evaluate(&self, series: &ArmSeries<'_>, state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let stack = self.evaluable()?;
        let joints = self.joints.resolve(series.motion.joints());
        let own_state = state.len() / joints.len().max(1);
        let mut result = Ok(());
        self.joints.write_own_rows(series.motion.joints(), stack.columns().len(), out, |i, joint, own| {
            let state = &mut state[i * own_state..(i + 1) * own_state];
            if let Err(error) = stack.evaluate(&joint_series(series, joint), state, own) {
                result = Err(error);
            }
        });
        result
    }
}
